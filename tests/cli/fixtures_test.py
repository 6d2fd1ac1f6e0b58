#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Fixtures of a job, and of one of its setups alone. Usage: fixtures_test.py MILLPOSE TOP AUDIT"""
import csv
import json
import subprocess
import sys
import unittest

import yaml
from cli_fixture import JOB, TOP, InFolder, run

FEW = {"stepover_mm": 40, "spacing_mm": 10}
# Over the pad's edge at x = -40 mm, not as high as the holder: the cutter comes no nearer than 10 mm.
CLAMP = {"name": "clamp", "shape": {"box": {"size_mm": [20, 200, 50]}}, "pose": {"xyz_mm": [-40, 0, 26], "abc_deg": [0, 0, 0]}}


class Fixtures(InFolder):
    def base(self):
        job = yaml.safe_load(JOB.read_text())
        job["cell"] = str(TOP / "cells" / "kr500_r2830.yaml")
        job["workpiece"]["mesh"] = str(JOB.parent / "support_pad.stl")
        job["toolpath"].update(FEW)
        job["programs"] = ["krl"]
        return job

    def two_setups(self):
        """The pad milled twice, in setups that stand alike."""
        job = self.base()
        place = {key: job["workpiece"].pop(key) for key in ("frame", "pose")}
        job["setups"] = [{"name": name, **place} for name in ("first", "second")]
        toolpath = job.pop("toolpath")
        job["operations"] = [{"name": f"pad_{name}", "setup": name, "toolpath": toolpath} for name in ("first", "second")]
        return job

    def plan(self, job, out="out"):
        (self.folder / "job.yaml").write_text(yaml.safe_dump(json.loads(json.dumps(job)), sort_keys=False))
        return run("plan", self.folder / "job.yaml", "-o", self.folder / out, "-q", "-v")

    def statuses(self, folder):
        with (folder / "points.csv").open() as file:
            return [(row["status"], row["reason"]) for row in csv.DictReader(file)]

    def test_a_clamp_of_the_second_setup_is_in_the_way_there_alone(self):
        job = self.two_setups()
        job["setups"][1]["fixtures"] = [CLAMP]
        planned = self.plan(job)
        self.assertEqual(planned.returncode, 1, planned.stdout + planned.stderr)
        first, second = (self.statuses(self.folder / "out" / "operations" / name) for name in ("01_pad_first", "02_pad_second"))
        self.assertEqual({status for status, _ in first}, {"planned"})
        left_out = [reason for status, reason in second if status == "skipped"]
        self.assertTrue(left_out)
        self.assertLess(len(left_out), len(second), "the rest is milled beside it")
        self.assertIn("interference", left_out)
        # What is left is confirmed with the clamp, and stands on the sheet of its setup.
        verified = run("verify", self.folder / "out")
        self.assertEqual(verified.returncode, 0, verified.stdout)
        sheet = run("report", self.folder / "out", "--html", self.folder / "setup.html")
        self.assertEqual(sheet.returncode, 0, sheet.stderr)
        page = (self.folder / "setup.html").read_text()
        before, after = page.split("Setup second. Bodies")
        self.assertIn("Setup first. Bodies", before)
        self.assertNotIn("<td>clamp</td>", before)
        self.assertIn("clamp", after)

    def test_a_fixture_of_the_world_stays_where_the_part_is_moved(self):
        job = self.base()
        # The same place in the world: the part's x is the world's z, its z the world's -x.
        x, y, z = job["workpiece"]["pose"]["xyz_mm"]
        world = {**CLAMP, "mount": "world", "shape": {"box": {"size_mm": [50, 200, 20]}}, "pose": {"xyz_mm": [x - 26, y, z - 40], "abc_deg": [0, 0, 0]}}
        for fixture, moved in ((CLAMP, 0), (world, 0), (world, 300)):
            own = self.base()
            own["workpiece"]["pose"]["xyz_mm"][1] += moved
            own["workpiece"]["fixtures"] = [fixture]
            planned = self.plan(own)
            skipped = [s for s, _ in self.statuses(self.folder / "out")].count("skipped")
            self.assertEqual(skipped > 0, moved == 0, planned.stdout)

    def test_a_fixture_may_be_a_mesh_beside_the_job(self):
        job = self.base()
        lower, upper = (-50, -100, 1), (-30, 100, 51)
        corners = [[(lower, upper)[i >> k & 1][k] for k in range(3)] for i in range(8)]
        faces = ((0, 2, 3), (0, 3, 1), (4, 5, 7), (4, 7, 6), (0, 1, 5), (0, 5, 4), (2, 6, 7), (2, 7, 3), (0, 4, 6), (0, 6, 2), (1, 3, 7), (1, 7, 5))
        (self.folder / "clamp.obj").write_text("".join(f"v {a} {b} {c}\n" for a, b, c in corners) + "".join(f"f {a + 1} {b + 1} {c + 1}\n" for a, b, c in faces))
        place = {"xyz_mm": [0, 0, 0], "abc_deg": [0, 0, 0]}
        job["workpiece"]["fixtures"] = [{"name": "clamp", "shape": {"mesh": {"file": "clamp.obj", "unit": "mm"}}, "pose": place}]
        self.plan(job)
        by_mesh = self.statuses(self.folder / "out")
        job["workpiece"]["fixtures"] = [CLAMP]
        self.plan(job, "box")
        self.assertEqual(by_mesh, self.statuses(self.folder / "box"))
        self.assertIn("skipped", {status for status, _ in by_mesh})

    def test_the_outside_judge_knows_them(self):
        job = self.base()
        job["workpiece"]["fixtures"] = [CLAMP]
        self.plan(job)
        written = self.folder / "out" / "job.yaml"

        def touching():
            judged = subprocess.run([sys.argv[3], self.folder / "out", "--inputs", self.folder, "--travel-mm", "5"], capture_output=True, text=True, timeout=300)
            self.assertIn(judged.returncode, (0, 1), judged.stderr)
            return json.loads(judged.stdout)["interferences"]

        self.assertEqual(touching(), 0)
        large = yaml.safe_load(written.read_text())
        large["workpiece"]["fixtures"][0]["shape"]["box"]["size_mm"] = [120, 200, 50]  # over most of the pad
        written.write_text(yaml.safe_dump(large, sort_keys=False))
        self.assertGreater(touching(), 0)

    def test_its_name_is_its_own(self):
        job = self.base()
        for name, told in (("spindle", "given spindle; allowed: a name that no other body"), ("workpiece", "given workpiece"), ("platform", "given platform")):
            job["workpiece"]["fixtures"] = [{**CLAMP, "name": name}]
            refused = self.plan(job)
            self.assertEqual(refused.returncode, 2)
            self.assertRegex(refused.stderr, rf"job\.yaml:\d+:\d+: workpiece\.fixtures\[0\]\.name: {told}")
        job["workpiece"]["fixtures"] = [CLAMP, CLAMP]
        self.assertIn("workpiece.fixtures[1].name: given clamp", self.plan(job).stderr)


if __name__ == "__main__":
    unittest.main(argv=["fixtures_test"])
