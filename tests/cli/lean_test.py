#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Lead and tilt as ranges, from the outside: planned, written, read back, judged; and what is refused.
Usage: lean_test.py MILLPOSE MILLPOSE_AUDIT TOP; with MILLPOSE_SLOW=1 plans are audited by the program itself as well, some 10 s each."""
import csv
import json
import math
import os
import subprocess
import sys
import unittest
from pathlib import Path

AUDIT = Path(sys.argv.pop(2)).resolve()
import vtp  # noqa: E402
from cli_fixture import TOP, InFolder, run, tree  # noqa: E402, takes MILLPOSE TOP

AUDITED = ["--audit"] if os.environ.get("MILLPOSE_SLOW") == "1" else []
RANGE = "{from: -10, to: 10, step: 5}"


class Lean(InFolder):
    def job(self, name="job.yaml", cutter="shape: ball, diameter_mm: 20", lean=f"lead_deg: {RANGE}\n  tilt_deg: {RANGE}", changes=()):
        """The sample's job with another cutter and leans, few points of it."""
        cell = (TOP / "cells" / "kr500_r2830.yaml").read_text().replace("shape: flat, diameter_mm: 20", cutter)
        (self.folder / "cell.yaml").write_text(cell)
        text = (TOP / "toolpaths" / "support_pad" / "job.yaml").read_text()
        for old, new in (("../../cells/kr500_r2830.yaml", "cell.yaml"), ("mesh: support_pad.stl", f"mesh: {TOP}/toolpaths/support_pad/support_pad.stl"),
                         ("lead_deg: 0\n  tilt_deg: 0", lean), ("name: support_pad", "name: lean"), *changes):
            self.assertIn(old, text)
            text = text.replace(old, new)
        (self.folder / name).write_text(text)
        return self.folder / name

    def plan(self, job, out="out", *arguments):
        return run("plan", job, "-o", self.folder / out, "-q", "--set", "toolpath.stepover_mm=40", "--set", "toolpath.spacing_mm=20",
                   "--set", "path.rotation_step_deg=10", "--set", "pose.exhaustive_step_deg=1", *arguments)

    def points(self, out="out"):
        with (self.folder / out / "points.csv").open(encoding="utf-8") as file:
            return list(csv.DictReader(file))

    def test_a_plan_with_free_leans_is_confirmed_and_judged(self):
        planned = self.plan(self.job(), "out", *AUDITED, "--threads", "2")
        self.assertEqual(planned.returncode, 0, planned.stdout + planned.stderr)
        summary = json.loads((self.folder / "out" / "summary.json").read_text())
        self.assertEqual({program["controller"] for program in summary["programs"] if program["verified"]}, {"krl", "sinumerik", "linuxcnc"})
        self.assertEqual(run("verify", self.folder / "out").returncode, 0)
        judged = subprocess.run([AUDIT, self.folder / "out", "--inputs", self.folder, "--travel-mm", "2"], capture_output=True, text=True, check=False)
        self.assertEqual(judged.returncode, 0, judged.stdout + judged.stderr)
        rows = self.points()
        spindle = 7000
        for row in rows:
            n, t, f = ([float(row[key + axis]) for axis in "xyz"] for key in ("n", "t", "f"))
            lead = math.degrees(math.asin(sum(a * b for a, b in zip(t, f))))
            self.assertAlmostEqual(float(row["lead_deg"]), lead, places=9)
            sine = math.sqrt(max(0, 1 - sum(a * b for a, b in zip(n, t)) ** 2))
            self.assertAlmostEqual(float(row["cutting_speed_m_min"]), math.pi * 20 * sine * spindle / 1000, places=4)
        self.assertGreater(max(abs(float(row["lead_deg"])) + abs(float(row["tilt_deg"])) for row in rows), 1)
        # The same in the other outputs.
        arrays = vtp.arrays((self.folder / "out" / "path.vtp").read_bytes())[1]["PointData"]
        for key in ("lead_deg", "tilt_deg"):
            for shown, row in zip(arrays[key], rows, strict=True):
                self.assertAlmostEqual(shown, float(row[key]), places=4)
        report = (self.folder / "out" / "report.html").read_text(encoding="utf-8")
        self.assertIn("Lead of the tool axis towards the feed", report)
        # Never worse than at the nominal lean, and the same for any number of threads.
        upright = self.plan(self.job("upright.yaml", lean="lead_deg: 0\n  tilt_deg: 0"), "upright")
        self.assertEqual(upright.returncode, 0, upright.stderr)
        value = lambda of: [float(row["objective"]) for row in of]  # noqa: E731
        self.assertLessEqual(max(value(rows)), max(value(self.points("upright"))))
        self.assertLessEqual(sum(value(rows)), sum(value(self.points("upright"))))
        self.assertNotIn("lead_deg", self.points("upright")[0])
        self.assertNotIn("lead_deg", vtp.arrays((self.folder / "upright" / "path.vtp").read_bytes())[1]["PointData"])
        self.assertEqual(self.plan(self.job(), "one", *AUDITED, "--threads", "1").returncode, 0)
        self.assertEqual(tree(self.folder / "one"), tree(self.folder / "out"))
        # What was resolved plans again.
        resolved = (self.folder / "out" / "job.yaml").read_text()
        self.assertIn("max_lean_change_deg_per_mm: 0.5", resolved)
        self.assertIn("unchanged", run("plan", self.folder / "out" / "job.yaml", *AUDITED).stdout)
        inspected = run("inspect", self.folder / "out", "--point", "3")
        self.assertEqual(inspected.returncode, 0, inspected.stderr)
        self.assertRegex(inspected.stdout, r"lead -?\d+\.\d and tilt -?\d+\.\d deg")
        self.assertEqual(run("check", self.folder / "job.yaml").returncode, 0)

    def test_the_contact_lies_on_the_surface_where_the_tool_leans_by_what_the_job_says(self):
        for cutter, lean in (("shape: ball, diameter_mm: 20", "lead_deg: 15\n  tilt_deg: 0"), ("shape: flat, diameter_mm: 20", "lead_deg: 4\n  tilt_deg: 2")):
            planned = self.plan(self.job(cutter=cutter, lean=lean), "out", *AUDITED, "--fresh")
            self.assertIn(planned.returncode, (0, 1), planned.stderr)
            summary = json.loads((self.folder / "out" / "summary.json").read_text())
            if AUDITED:
                self.assertLess(summary["audit"]["max_slice_distance_mm"], 1e-6)
            judged = subprocess.run([AUDIT, self.folder / "out", "--inputs", self.folder, "--travel-mm", "5"], capture_output=True, text=True, check=False)
            verdict = json.loads(judged.stdout)
            self.assertNotIn("max_slice_distance_mm", verdict["broken"], judged.stdout)
            self.assertLess(verdict["max_slice_distance_mm"], 1e-6)

    def refused(self, *sentences, **job):
        told = run("check", self.job(**job))
        self.assertEqual(told.returncode, 2, told.stdout)
        for sentence in sentences:
            self.assertRegex(told.stderr, sentence)

    def test_ranges_that_cannot_be_followed_are_refused_in_their_place(self):
        flat = {"cutter": "shape: flat, diameter_mm: 20"}
        self.refused(r"job\.yaml:\d+:\d+: toolpath\.lead_deg: the range holds the upright axis", r"toolpath\.lead_deg: .* give toolpath\.scallop_mm", **flat)
        self.refused(r"job\.yaml:\d+:\d+: toolpath\.lead_deg\.to: given 1; allowed: above from, 3", lean="lead_deg: {from: 3, to: 1, step: 1}\n  tilt_deg: 0")
        self.refused(r"toolpath\.lead_deg\.step: given 0\.1; allowed: 0\.8 to 20", lean="lead_deg: {from: -10, to: 10, step: 0.1}\n  tilt_deg: 0")
        self.refused(r"toolpath\.tilt_deg\.nominal: given 9; allowed: 1 to 2", lean="lead_deg: 0\n  tilt_deg: {from: 1, to: 2, step: 1, nominal: 9}")
        self.refused(r"toolpath\.tilt_deg\.stop: unknown key", r"toolpath\.tilt_deg\.step: missing", lean="lead_deg: 0\n  tilt_deg: {from: 1, to: 2, stop: 1}")
        self.refused(r"toolpath\.tilt_deg: a range leans the tool from the surface's normal",
                     lean=f"lead_deg: 0\n  tilt_deg: {RANGE}\n  tool_axis: {{rule: fixed, direction: [0, 0, 1]}}")
        self.refused(r"min_cutting_speed_share: has no effect here: at the nominal lean", lean=f"lead_deg: {RANGE}\n  min_cutting_speed_share: 0.2\n  tilt_deg: 0")
        self.refused(r"min_cutting_speed_share: has no effect here: needs a range", lean="lead_deg: 5\n  min_cutting_speed_share: 0.2\n  tilt_deg: 0")
        slower = ("\npath:\n", "\npath:\n  max_lean_change_deg_per_mm: 2\n")
        self.refused(r"job\.yaml:\d+:3: path\.max_lean_change_deg_per_mm: has no effect here", lean="lead_deg: 0\n  tilt_deg: 0", changes=(slower,))


if __name__ == "__main__":
    unittest.main(argv=["lean_test.py"])
