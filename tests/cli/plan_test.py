#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""`millpose plan` from the outside: a cut-down support_pad. Usage: plan_test.py MILLPOSE MILLPOSE_AUDIT TOP"""
import collections
import csv
import json
import random
import re
import signal
import sys
import time
import unittest

import vtp
from plan_fixture import CUT_DOWN, POINT_COLUMNS, Bench, contents, differences, kill_after, started

BENCH = None


def keys(value, prefix=""):
    """All key paths of nested objects; entries of lists count once."""
    if isinstance(value, dict):
        for key, entry in value.items():
            yield f"{prefix}{key}"
            yield from keys(entry, f"{prefix}{key}.")
    elif isinstance(value, list):
        for entry in value:
            yield from keys(entry, prefix)


class Plan(unittest.TestCase):
    """One plan, looked at from all sides."""

    @classmethod
    def setUpClass(cls):
        cls.job = BENCH.job("support_pad", CUT_DOWN, "small")
        began = time.monotonic()
        cls.result, cls.folder = BENCH.plan(cls.job, "reference", "--threads", "1")
        cls.seconds = time.monotonic() - began
        if cls.result.returncode != 0:
            raise AssertionError(f"plan ends with {cls.result.returncode}:\n{cls.result.stdout}{cls.result.stderr}")
        cls.contents = contents(cls.folder)
        cls.summary = json.loads(cls.contents["summary.json"])

    def test_leaves_every_file_and_nothing_else(self):
        names = {name for name in self.contents if not name.startswith(("checkpoints/", "."))}
        self.assertEqual(
            {name for name in names if name not in ("report.html", "path.vtp", "starts.cbor") and "/starts/" not in name},
            {"cell.yaml", "job.yaml", "manifest.json", "plan.cbor.gz", "points.csv", "deflection.csv", "summary.json", "programs/krl/support_pad.src",
             "programs/krl/support_pad.dat", "programs/sinumerik/support_pad.mpf", "programs/linuxcnc/support_pad.ngc"})
        starts = {name.split("/")[1] for name in names if "/starts/" in name}
        self.assertEqual(starts, {"krl", "sinumerik", "linuxcnc"} if self.summary["pieces"] > 1 else set())
        self.assertTrue((self.folder / "run.json").is_file())

    def test_summary_has_every_field(self):
        wanted = {"schema_version", "points.total", "points.planned", "points.skipped", "skipped", "passes",
                  "gaps.total", "gaps.planned", "stiffness.units", "price_of_continuity", "ga_nodes_share",
                  "clearance_min_mm", "cell.robot", "cell.X_WB", "cell.X_FT", "seed", "programs", "programs.path",
                  "programs.controller", "programs.motions_per_pass", "programs.verified", "audit"}
        wanted |= {f"stiffness.{index}.{which}" for index in ("lambda_t1", "lambda_t2", "lambda_n", "objective")
                   for which in ("best", "median", "worst")}
        self.assertEqual(wanted - set(keys(self.summary)), set())
        self.assertEqual(self.summary["schema_version"], 2)
        price = self.summary["price_of_continuity"]
        if price["ratio"]:
            self.assertGreaterEqual(price["ratio"]["interference"], 1)
            self.assertGreaterEqual(price["ratio"]["continuity"], 1)
            self.assertGreaterEqual(price["ratio"]["total"], 1)
        else:
            for parts in (price["mean_um"], price["worst_um"]):
                self.assertGreaterEqual(parts["interference"], 0)
                self.assertGreaterEqual(parts["continuity"], 0)
                self.assertAlmostEqual(parts["total"], parts["interference"] + parts["continuity"] + parts["smoothing"])
        self.assertGreaterEqual(price["gap_percent"]["sum"], 0)
        self.assertLess(price["gap_percent"]["sum"], 2)
        self.assertTrue(all(program["verified"] for program in self.summary["programs"]))
        self.assertEqual(self.summary["points"]["skipped"], 0)
        self.assertEqual(self.summary["gaps"]["planned"], self.summary["gaps"]["total"])
        self.assertIsNone(self.summary["audit"])

    def test_audit_adds_its_figures_and_optima_and_changes_nothing_else(self):
        result, folder = BENCH.plan(self.job, "audited", "--audit")
        self.assertEqual(result.returncode, 0, result.stderr)
        found = contents(folder)
        audit = json.loads(found["summary.json"])["audit"]
        self.assertGreaterEqual(audit.pop("ga_share_within_0p1_percent"), 99)
        self.assertLessEqual(audit.pop("ga_worst_gap_percent"), 1)
        self.assertLessEqual(audit.pop("max_slice_distance_mm"), 1e-6)
        self.assertGreaterEqual(audit.pop("ga_share_without_table_percent"), 75)
        self.assertEqual(audit, {"limit_violations": 0, "interferences": 0, "clearance_violations": 0, "pairs": []})
        self.assertLessEqual({name for name in differences(self.contents, found)
                              if not name.startswith("checkpoints/nearest-pairs-")},  # kept by the poses
                             {"summary.json", "report.html", "manifest.json", "points.csv", "plan.cbor.gz",
                              "checkpoints/choices.stage"})  # kept by the plan
        plain, audited = (list(csv.DictReader(text.decode("ascii").splitlines()))
                          for text in (self.contents["points.csv"], found["points.csv"]))
        self.assertEqual({row.pop("exhaustive_optimum") for row in plain}, {""})
        for row in audited:  # in air nothing is to be judged
            self.assertEqual(row.pop("exhaustive_optimum") == "", row["own_optimum"] == "")
        self.assertGreater(sum(row["own_optimum"] != "" for row in audited), len(audited) / 2)
        self.assertEqual(plain, audited)

    def test_run_json_holds_what_may_vary(self):
        run = json.loads((self.folder / "run.json").read_text(encoding="utf-8"))
        for key in ("wall_s", "stages", "peak_memory_MB", "threads", "host", "version"):
            self.assertIn(key, run)
        self.assertTrue(all("wall_s" in stage for stage in run["stages"].values()))

    def test_points_have_the_documented_columns_and_one_row_each(self):
        rows = list(csv.reader(self.contents["points.csv"].decode("ascii").splitlines()))
        self.assertEqual(rows[0][:len(POINT_COLUMNS)], POINT_COLUMNS)
        self.assertEqual(len(rows) - 1, self.summary["points"]["total"])
        self.assertEqual({len(row) for row in rows}, {len(rows[0])})
        self.assertNotIn(b"nan", self.contents["points.csv"].lower())
        self.assertNotIn(b"\r", self.contents["points.csv"])

    def test_path_vtp_says_what_points_csv_says(self):
        piece, parts = vtp.arrays(self.contents["path.vtp"])
        arrays, lines = parts["PointData"], parts["Lines"]
        rows = list(csv.DictReader(self.contents["points.csv"].decode("ascii").splitlines()))
        self.assertEqual(int(piece["NumberOfPoints"]), len(rows))
        names = [name for name in POINT_COLUMNS if name in arrays]
        self.assertLessEqual({"objective", "lambda_t1_mm_N", "mu", "dexterity", "clearance_mm", "a6_deg", "rotation_deg"},
                             set(names))
        for name in names:
            self.assertEqual([float(row[name]) for row in rows], arrays[name], name)
        self.assertEqual(parts["Points"]["position_mm"], [float(row[name]) for row in rows for name in ("x_mm", "y_mm", "z_mm")])
        self.assertEqual(lines["connectivity"], list(range(len(rows))))
        self.assertEqual(len(lines["offsets"]), int(piece["NumberOfLines"]))

    def test_tells_each_stage_on_stderr_and_the_figures_on_stdout(self):
        for stage in ("read", "surface", "toolpath", "passes", "gaps", "programs"):
            self.assertRegex(self.result.stderr, rf"(?m)^{stage} ")
        for word in ("points", "passes", "gaps", "stiffness", "price", "clearance", "time"):
            self.assertRegex(self.result.stdout, rf"(?m)^{word}")

    def test_the_judge_finds_nothing(self):
        status, verdict = BENCH.audit(self.folder, self.job, "--travel-mm", "5")
        self.assertEqual(verdict["broken"], {})
        self.assertEqual(status, 0)
        self.assertGreater(verdict["poses_checked"], 1000)

    def test_the_papers_formulation_is_judged_and_milled_only_on_exact_poses(self):
        """With springs beside the joints and a cutting force: the deflection's figures are recomputed, too."""
        cell = BENCH.top / "cells/kr500_r2830.yaml"
        text = cell.read_text(encoding="utf-8")
        springs = ("compliances: [{name: platform, mount: base, translational_mm_N: [1.0e-4, 2.0e-4, 5.0e-5], "
                   "rotational_rad_Nm: [1.0e-8, 2.0e-8, 3.0e-8]}, {name: hand, mount: link5, "
                   "pose: {xyz_mm: [10, 20, 30], abc_deg: [20, 30, 40]}, translational_mm_N: [1.0e-5, 2.0e-5, 3.0e-5]}], ")
        self.assertIn("stiffness: {at: tool_tip, ", text)
        cell.with_name("springs.yaml").write_text(text.replace("stiffness: {", "stiffness: {" + springs), encoding="utf-8")
        job = BENCH.job("support_pad", CUT_DOWN + [
            ("kr500_r2830", "springs"),
            (r"teeth: 4", "teeth: 2"), (r"name: surface_error", "name: chen2021"),
            (r"pose:\n  objective", "pose:\n  formulation: paper\n  paper: {generations: 120}\n  objective")], "paper")
        result, folder = BENCH.plan(job, "paper")
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        self.assertIn("paper's formulation:", result.stdout)
        summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
        paper = summary["paper_formulation"]
        self.assertEqual(paper["points"], summary["points"]["total"])
        self.assertLessEqual(paper["on_path"], paper["admissible_on_exact_pose"])
        self.assertLessEqual(paper["admissible_on_exact_pose"], paper["within_tolerance"])
        self.assertLess(paper["within_tolerance"], paper["points"])  # so short a search misses some
        self.assertGreater(paper["position_error_mm"]["worst"], 0.1)
        with open(folder / "points.csv", encoding="ascii") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual(sum(row["genetic_optimum"] != "" for row in rows), paper["admissible_on_exact_pose"])
        for row in rows:
            if row["genetic_optimum"]:
                self.assertGreaterEqual(float(row["genetic_optimum"]) / float(row["own_optimum"]), 1 - 1e-9)
        status, verdict = BENCH.audit(folder, job, "--travel-mm", "5")
        self.assertEqual(verdict["broken"], {})
        self.assertEqual(status, 0)
        with open(folder / "deflection.csv", encoding="ascii") as file:
            moved = list(csv.DictReader(file))
        self.assertEqual(len(moved), sum(row["status"] == "planned" and row["kind"] == "cut" for row in rows))
        self.assertEqual(collections.Counter(row["side"] for row in moved),
                         {side: count for side, count in summary["deflection"]["points"].items() if count})
        cut = [row for row in moved if row["side"] != "air"]
        self.assertGreater(len(cut), len(moved) / 2)
        level = sum(float(row["normal_um"]) for row in cut) / len(cut) / 1000
        self.assertAlmostEqual(level, summary["deflection"]["level_mm"], 12)
        self.assertIn("no chatter", summary["deflection"]["model"])
        for row in cut:
            squares = [sum(float(row[key]) ** 2 for key in keys) for keys in (("x_um", "y_um", "z_um"), ("normal_um", "feed_um", "across_um"))]
            self.assertAlmostEqual(squares[0] / squares[1], 1, 9)

    def test_the_judge_reads_split_programs_and_finds_a_wrong_line_in_a_part(self):
        cell = BENCH.top / "cells/kr500_r2830.yaml"
        text = cell.read_text(encoding="utf-8")
        small = text.replace("    tool_axis: -x", "    max_motions: 10\n    tool_axis: -x").replace(
            "tool_axis: z", "max_motions: 10, tool_axis: z")
        cell.with_name("split.yaml").write_text(small, encoding="utf-8")
        every_point = (r"(?m)^programs: ", "program_options: {point_economy: {chord_mm: 0}}\nprograms: ")
        job = BENCH.job("support_pad", CUT_DOWN + [("kr500_r2830", "split"), every_point], "split")
        result, folder = BENCH.plan(job, "split")
        self.assertEqual(result.returncode, 0, result.stderr)
        # Across the pass: along it a point stays on the planned line. KRL's lines have the words alone that change.
        for controller, ending, line, aside in (("krl", "src", r"(?m)^(LIN \{X [-\d.]+)(,)", r"\g<1>,Y 1\g<2>"),
                                                ("sinumerik", "spf", r"(?m)^(?:G9 )?(G1 X\S+ Y)(-?)(\d)", r"\g<1>\g<2>1\g<3>")):
            parts = sorted((folder / "programs" / controller).glob(f"*_002.{ending}"))
            self.assertEqual(len(parts), 1, controller)
            self.assertEqual(BENCH.audit(folder, job, "--travel-mm", "20")[1]["broken"], {})
            good = parts[0].read_text(encoding="ascii")
            wrong = list(re.finditer(line, good))[1]  # the first may be the approach, which no row states
            parts[0].write_text(good[:wrong.start()] + wrong.expand(aside) + good[wrong.end():],
                                encoding="ascii")
            _, verdict = BENCH.audit(folder, job, "--travel-mm", "20")
            self.assertIn(f"program_deviation_mm_{controller}", verdict["broken"])
            self.assertTrue(all(controller in name for name in verdict["broken"]), verdict["broken"])
            parts[0].write_text(good, encoding="ascii")

    def test_same_bytes_for_any_number_of_threads(self):
        for threads in ("2", "4"):
            result, folder = BENCH.plan(self.job, f"threads{threads}", "--threads", threads)
            self.assertEqual(result.returncode, 0, result.stderr)
            self.assertEqual(differences(self.contents, contents(folder)), [])

    def test_same_bytes_on_a_second_run_resumed_or_fresh(self):
        _, folder = BENCH.plan(self.job, "again")
        for arguments in ((), ("--fresh",), ()):
            if not arguments:
                (folder / "manifest.json").unlink()  # else nothing would be planned again
            result, _ = BENCH.plan(self.job, "again", *arguments)
            self.assertEqual(result.returncode, 0, result.stderr)
            self.assertEqual(differences(self.contents, contents(folder)), [])

    def test_killed_at_any_moment_it_goes_on_and_leaves_the_same_bytes(self):
        folder = BENCH.top / "killed"
        with started(BENCH.millpose, "plan", self.job, "-o", folder, "--threads", "1") as process:
            status = kill_after(process, random.uniform(0, self.seconds), signal.SIGKILL)
        if status != 0 and (folder / "programs").exists():
            left = {name: text for name, text in contents(folder).items() if name.startswith("programs/")}
            self.assertEqual(left, {n: t for n, t in self.contents.items() if n.startswith("programs/")})
        result, _ = BENCH.plan(self.job, folder.name)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(differences(self.contents, contents(folder)), [])

    def test_interrupted_it_says_so_and_goes_on(self):
        folder = BENCH.top / "interrupted"
        with started(BENCH.millpose, "plan", self.job, "-o", folder, "--threads", "1") as process:
            while not process.stderr.readline().startswith("toolpath"):  # a stage that has ended
                self.assertIsNone(process.poll(), "it ended before it could be interrupted")
            process.send_signal(signal.SIGINT)
            _, stderr = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 130, stderr)
        self.assertIn("interrupted", stderr)
        self.assertIn("the same command goes on from there", stderr)
        self.assertFalse((folder / "programs").exists())
        result, _ = BENCH.plan(self.job, "interrupted")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(differences(self.contents, contents(folder)), [])

    def test_another_seed_may_find_other_poses_but_never_another_surface(self):
        _, folder = BENCH.plan(self.job, "seed", "--seed", "7")
        rows = [row.split(",") for row in (folder / "points.csv").read_text(encoding="ascii").splitlines()]
        mine = [row.split(",") for row in self.contents["points.csv"].decode("ascii").splitlines()]
        self.assertEqual([row[6:15] for row in rows], [row[6:15] for row in mine])
        self.assertEqual(json.loads((folder / "summary.json").read_text(encoding="utf-8"))["seed"], 7)

    def test_quiet_is_quiet(self):
        result, _ = BENCH.plan(self.job, "quiet", "--quiet")
        self.assertEqual((result.returncode, result.stderr), (0, ""))


if __name__ == "__main__":
    BENCH = Bench(*sys.argv[1:4])
    unittest.main(argv=sys.argv[:1])
