#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""millpose diff on pairs with one known change each: what differs is found, and nothing else. Usage: diff_test.py MILLPOSE TOP"""
import html
import json
import re
import shutil
import unittest

from cli_fixture import JOB, TOP, InFolder, run

SMALL = ("toolpath.stepover_mm=40", "toolpath.spacing_mm=40", "programs=[krl]")
# A change, the settings that differ, and the sections that do; "figures" may but need not, where it stands in brackets.
PAIRS = [
    ("seed=2", [], "figures? programs? poses?"),
    ("process.feed_mm_min=8", ["process.feed_mm_min"], "settings points figures programs findings?"),
    ("gaps.retract_mm=5", ["process.approach_feed_mm_min", "gaps.retract_mm"], "settings figures programs findings?"),
    ("gaps.speed_share=0.25", ["gaps.speed_share"], "settings figures programs"),
    ("process.spindle_rpm=6000", ["process.spindle_rpm"], "settings figures programs"),
    ("toolpath.stepover_mm=39", ["toolpath.stepover_mm"], "settings points poses? figures programs"),
    ("toolpath.spacing_mm=20", ["toolpath.spacing_mm"], "settings points poses? figures programs"),
    ("toolpath.direction=one_way", ["toolpath.direction"], "settings points? poses? figures? programs? findings?"),
    ("workpiece.pose.xyz_mm=[2070, 0, 1006]", ["workpiece.pose.xyz_mm"], "settings points poses figures programs"),
    ("limits.margin_deg=4", ["limits.margin_deg"], "settings poses? figures? programs?"),
    ("limits.joints_deg=[[-45, 45], [-140, -30], [38, 120], [-350, 350], [-100, 10], [-350, 350]]", ["limits.joints_deg"],
     "settings points? poses figures programs findings?"),
    ("path.motion_share=4", ["path.motion_share"], "settings poses? figures? programs?"),
    ("pose.objective={name: isotropy}", None, "settings poses figures programs findings?"),
    ("process.cutting.teeth=2", ["process.cutting.teeth"], "settings poses? figures programs?"),
    ("process.cutting.depth_mm=2", ["process.cutting.depth_mm"], "settings poses? figures programs?"),
    ("program_options.dry_run_offset_mm=20", ["program_options.dry_run_offset_mm"], "settings programs figures? findings?"),
    ("program_options.path_tolerance_mm=0.05", ["program_options.path_tolerance_mm"], "settings programs? figures? findings?"),
    ("workpiece.allowance_mm=1", ["workpiece.allowance_mm"], "settings figures? programs?"),
    ("interference.swept_resolution_mm=0.25", ["interference.swept_resolution_mm"], "settings figures? programs? poses?"),
    ("programs=[krl, linuxcnc]", ["programs"], "settings programs figures findings?"),
]


class Diff(InFolder):
    def plan(self, out, *changes):
        done = run("plan", JOB, "-o", self.folder / out, "-q", *[word for change in (*SMALL, *changes) for word in ("--set", change)])
        self.assertLess(done.returncode, 2, done.stderr)
        return self.folder / out

    def changes(self, one, other, *more):
        done = run("diff", one, other, "--json", *more)
        self.assertIn(done.returncode, (0, 1), done.stderr)
        return json.loads(done.stdout)["changes"], done.returncode

    def test_every_change_is_found_and_nothing_else(self):
        base = self.plan("base")
        self.assertEqual(self.changes(base, base), ([], 0))
        for change, settings, sections in PAIRS:
            with self.subTest(change):
                found, status = self.changes(base, self.plan("other", change))
                self.assertEqual(status, 0)
                if settings is not None:
                    self.assertEqual([entry["what"] for entry in found if entry["section"] == "settings"], settings)
                seen = {entry["section"] for entry in found}
                self.assertLessEqual({word for word in sections.split() if not word.endswith("?")}, seen, found)
                self.assertLessEqual(seen, {word.rstrip("?") for word in sections.split()}, found)

    def batch(self, name, jobs):
        """A batch's folder of plans that stand elsewhere."""
        folder = self.folder / name
        folder.mkdir()
        for job, plan in jobs.items():
            shutil.copytree(plan, folder / job)
        shutil.copy(next(iter(jobs.values())) / ".millpose", folder)
        (folder / "batch.json").write_text(json.dumps({"jobs": [{"folder": job} for job in (*jobs, "never_planned", "../" + next(iter(jobs)))]}))
        return folder

    def test_two_batches_are_compared_job_by_job(self):
        base, slow = self.plan("base"), self.plan("slow", "process.feed_mm_min=8")
        before = self.batch("before", {"pad": base, "old": base, "same": base})
        after = self.batch("after", {"pad": slow, "new": base, "same": base})
        found, status = self.changes(before, after, "--fail-on", "findings")
        self.assertEqual(status, 1)
        whole = [(one["operation"], one["what"]) for one in found if one["operation"] != "pad"]
        self.assertEqual(whole, [("new", "its plan is new"), ("old", "its plan is gone")])
        self.assertEqual([{**one, "fails": None} for one in found if one["operation"] == "pad"],
                         [{**one, "operation": "pad", "fails": None} for one in self.changes(base, slow)[0]])
        self.assertEqual(self.changes(before, before), ([], 0))
        refused = run("diff", before, base)
        self.assertEqual(refused.returncode, 2)
        self.assertIn("allowed: two plans, or two batches", refused.stderr)

    def test_rules_decide_the_status(self):
        base, slow = self.plan("base"), self.plan("slow", "process.feed_mm_min=8")
        for rule, status in (("settings", 1), ("any", 1), ("poses", 0), ("cycle_times.krl.total_s:50", 1), ("cycle_times.krl.total_s:99", 0),
                             ("clearance_min_mm:0", 0)):
            self.assertEqual(self.changes(base, slow, "--fail-on", rule)[1], status, rule)
        refused = run("diff", base, slow, "--fail-on", "setings")
        self.assertEqual(refused.returncode, 2)
        self.assertIn("allowed: any, settings, points", refused.stderr)
        mistyped = run("diff", base, base, "--fail-on", "cycle_times.krl.totl_s:2")  # a rule that could never hold
        self.assertEqual(mistyped.returncode, 2)
        self.assertIn('--fail-on: no figure "cycle_times.krl.totl_s"; known: ', mistyped.stderr)
        self.assertIn('did you mean "cycle_times.krl.total_s"?', mistyped.stderr)
        told = run("diff", base, slow, "--fail-on", "cycle_times.krl.total_s:50", "--fail-on", "clearance_min_mm:0", "--fail-on", "settings").stdout
        self.assertRegex(told, r"(?m)^fails      --fail-on cycle_times\.krl\.total_s:50 \([5-9]\d(\.\d)? %\)\nfails      --fail-on settings \(1 line\)$")
        self.assertNotIn("--fail-on clearance_min_mm", told)
        self.assertIn("settings   process.feed_mm_min: 80 -> 8\n", run("diff", base, slow).stdout)

    def test_the_page_has_every_line_and_loads_nothing(self):
        base, other = self.plan("base"), self.plan("other", "process.feed_mm_min=8", "gaps.retract_mm=5")
        page = self.folder / "diff.html"
        found, status = self.changes(base, other, "--html", page, "--fail-on", "settings")
        self.assertEqual(status, 1)
        text = page.read_text(encoding="utf-8")
        rows = re.findall(r"<tr( class=\"bad\")?><td", text)
        self.assertEqual(len(rows), len(found))
        self.changes(base, other, "--html", page, "--lang", "zh")
        chinese = page.read_text(encoding="utf-8")
        self.assertIn('<html lang="zh">', chinese)
        self.assertEqual(len(re.findall("<tr><td", chinese)), len(found))
        self.assertEqual(re.findall(r"\b(?:before|after|change|settings|figures|points|motions|with|another)\b", re.sub(r"(?s)<style>.*?</style>|<td>[\w.]+</td>|<[^>]*>", " ", chinese)), [])
        self.assertEqual(sum(map(bool, rows)), sum(entry["fails"] for entry in found))
        for entry in found:
            for key in ("what", "before", "after"):
                self.assertIn(html.escape(entry[key], quote=False), html.unescape(text).replace("&", "&amp;") if "&" in entry[key] else text)
        self.assertEqual(re.findall(r'href="([^"]*)"', text), ["base/report.html", "other/report.html"])
        self.assertNotRegex(text, r"<script|src=|https?:")
        run("diff", base, base, "--html", page)
        self.assertIn("No difference.", page.read_text(encoding="utf-8"))

    def test_texts_alone_are_no_difference_and_other_folders_are_refused(self):
        base = self.plan("base")
        other = self.folder / "moved"
        shutil.copytree(base, other)
        self.assertEqual(self.changes(base, other), ([], 0))
        refused = run("diff", base, self.folder)
        self.assertEqual(refused.returncode, 2)
        self.assertIn("is no output folder of millpose", refused.stderr)


if __name__ == "__main__":
    unittest.main(argv=["diff_test.py"])
