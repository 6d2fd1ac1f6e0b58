# SPDX-License-Identifier: GPL-3.0-or-later
"""How deep and wide a job may cut for a stated error: what `check` advises is planned again. Arguments: MILLPOSE TOP"""
import csv
import json
import os
import re
import unittest

from cli_fixture import JOB, TOP, InFolder, run

SLOW = os.environ.get("MILLPOSE_SLOW") == "1"
COARSE = ("pose.exhaustive_step_deg=1", "path.rotation_step_deg=5", "interference.swept_resolution_mm=5", "pose.genetic.generations=1", "programs=[]")
FEW = ("toolpath.stepover_mm=18", "toolpath.spacing_mm=80", *COARSE)


class Advise(InFolder):
    def sets(self, changes):
        return [word for change in changes for word in ("--set", change)]

    def advice(self, job, changes, *limits):
        result = run("check", job, *self.sets(changes), *limits, "--json")
        self.assertIn(result.returncode, (0, 1), result.stderr)
        return json.loads(result.stdout)["advice"]

    def worst(self, job, changes):
        """The largest displacement of the tip that a plan predicts, µm."""
        result = run("plan", job, *self.sets(changes), "-o", self.folder / "out", "-q")
        self.assertIn(result.returncode, (0, 1), result.stdout + result.stderr)
        with open(self.folder / "out" / "deflection.csv", encoding="utf-8") as table:
            return max(float(row["length_um"]) for row in csv.DictReader(table))

    def check_law(self, job, changes, setting, error_um):
        """Planned with the advised value the error stays; with 5 % more it does not, if it is the error that forbids more."""
        self.assertIsNotNone(setting["largest"], setting)
        at = lambda value: [*changes, *(f"{key}={value:.9g}" for key in setting["keys"])]
        reached = self.worst(job, at(setting["largest"]))
        self.assertLessEqual(reached, error_um)
        self.assertAlmostEqual(reached, setting["load"]["error_um"], 9)
        if setting["limited_by"] == "error":
            self.assertGreater(self.worst(job, at(1.05 * setting["largest"])), error_um)

    def test_the_advised_depth_keeps_the_error(self):
        advice = self.advice(JOB, FEW, "--advise-um", "3")
        self.assertAlmostEqual(advice["as_given"]["error_um"], self.worst(JOB, FEW), 9)
        depth, step = advice["settings"]
        self.assertEqual((depth["setting"], depth["keys"], depth["limited_by"]), ("depth", ["process.cutting.depth_mm"], "error"))
        self.check_law(JOB, FEW, depth, 3)
        self.assertEqual((step["setting"], step["keys"]), ("step-over", ["toolpath.stepover_mm"]))

    @unittest.skipUnless(SLOW, "its quick twin is that of the depth")
    def test_the_advised_step_keeps_the_error(self):
        for error in (0.4, 0.8, 1.6):
            for setting in self.advice(JOB, FEW, "--advise-um", error)["settings"]:
                with self.subTest(error=error, setting=setting["setting"]):
                    if setting["limited_by"] == "none":
                        self.assertIsNone(setting["largest"])
                    else:
                        self.check_law(JOB, FEW, setting, error)

    @unittest.skipUnless(SLOW, "its quick twin is that of a face")
    def test_a_roughed_layer_keeps_the_error(self):
        text = (TOP / "toolpaths" / "support_rough" / "job.yaml").read_text().replace("../../cells", str(TOP / "cells")).replace("../support_pad", str(TOP / "toolpaths" / "support_pad"))
        text = text.replace("  spindle_rpm: 7000\n", "  spindle_rpm: 7000\n  stock: mesh\n  cutting: {material: 5A06, teeth: 2, depth_mm: 7.5}\n")
        job = self.folder / "job.yaml"
        job.write_text(text)
        changes = ("toolpath.rough.max_engagement_deg=60", "workpiece.stock.box.upper_mm=[40, 0, 8]", "pose.objective.name=surface_error", *COARSE)
        depth, engagement = self.advice(job, changes, "--advise-um", "60")["settings"]
        self.assertEqual((depth["setting"], engagement["setting"]), ("depth", "engagement"))
        self.assertEqual(depth["keys"], ["toolpath.rough.per_layer_mm", "process.cutting.depth_mm"])
        self.check_law(job, changes, depth, 60)
        if engagement["limited_by"] == "none":
            self.assertEqual(engagement["too_much"], 20, "the least that strategy rough takes")
        else:
            self.check_law(job, changes, engagement, 60)

    @unittest.skipUnless(SLOW, "its quick twins are those of the search and of the power")
    def test_the_spindle_keeps_its_power(self):
        limit = 2.5 * self.advice(JOB, FEW, "--advise-um", "1000")["as_given"]["power_kW"]
        depth = self.advice(JOB, FEW, "--advise-um", "1000", "--spindle-kW", limit)["settings"][0]
        self.assertEqual(depth["limited_by"], "power")
        self.assertLessEqual(depth["load"]["power_kW"], limit)
        self.assertGreater(depth["load_too_much"]["power_kW"], limit)
        self.assertLessEqual(depth["too_much"], 1.05 * depth["largest"] + 0.0011)

    def test_what_cannot_be_advised_is_told(self):
        without = re.sub(r"(?m)^ *(cutting|objective): .*\n", "", JOB.read_text()).replace("../../cells", str(TOP / "cells")).replace("support_pad.stl", str(JOB.parent / "support_pad.stl"))
        (self.folder / "job.yaml").write_text(without)
        result = run("check", self.folder / "job.yaml", *self.sets(FEW), "--advise-um", "5")
        self.assertIn("advice              none: process.cutting is missing", result.stdout)
        for words, told in ((("check", JOB, "--spindle-kW", "3"), "--advise-um"), (("check", JOB, "--advise-um", "-1"), "--advise-um"),
                            (("check", TOP / "cells" / "kr500_r2830.yaml", "--advise-um", "5"), "--advise-um: has no effect here; allowed: with a job")):
            result = run(*words)
            self.assertEqual(result.returncode, 2, words)
            self.assertIn(told, result.stderr)


if __name__ == "__main__":
    unittest.main(argv=["advise_test"])
