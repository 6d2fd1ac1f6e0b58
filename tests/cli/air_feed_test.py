#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""A cell's air_feed in the programs of every controller. Usage: air_feed_test.py MILLPOSE TOP"""
import json
import unittest

import yaml
from cli_fixture import TOP, InFolder, run

# Each with the controllers of its cell; of the raw part 1 mm stands, on one half of the pad alone.
SAMPLES = {"support_pad": ["krl", "sinumerik", "linuxcnc"], "irb6640_pad": ["rapid"], "r2000ic_contours": ["fanuc"], "ur10e_pad": ["urscript"]}
HALF = {"box": {"lower_mm": [-60, -60, -20], "upper_mm": [0, 60, 1]}}
AIR = "air_feed: {feed_mm_min: 6000, margin_mm: 5, longer_than_mm: 20}\n"
QUICK = {"pose": {"exhaustive_step_deg": 5, "genetic": {"table": 24, "population": 8, "generations": 1}}, "path": {"rotation_step_deg": 10}}


class AirFeed(InFolder):
    def plan(self, sample, air):
        source = TOP / "toolpaths" / sample / "job.yaml"
        job = {**yaml.safe_load(source.read_text()), **QUICK, "programs": SAMPLES[sample]}
        cell = (source.parent / job["cell"]).resolve().read_text()
        (self.folder / "cell.yaml").write_text(cell + (AIR if air else ""))
        job["cell"] = "cell.yaml"
        job["workpiece"].update(mesh=str(TOP / "toolpaths" / "support_pad" / "support_pad.stl"), stock=HALF)
        job["process"].pop("cutting", None)
        job["toolpath"]["spacing_mm"] = 10
        (self.folder / "job.yaml").write_text(yaml.safe_dump(job, sort_keys=False, width=10**6))
        planned = run("plan", self.folder / "job.yaml", "-o", self.folder / "out", "-q")
        self.assertEqual(planned.returncode, 0, planned.stdout + planned.stderr)
        summary = json.loads((self.folder / "out" / "summary.json").read_text())
        self.assertTrue(all(program["verified"] for program in summary["programs"]))
        verified = run("verify", self.folder / "out")
        self.assertEqual(verified.returncode, 0, verified.stdout)
        for controller in SAMPLES[sample]:
            self.assertRegex(verified.stdout, rf"{controller} +\d+ motions  confirmed")
        return {times["controller"]: times["total_s"] for times in summary["cycle_times"]}, summary["stock"]["air"]

    def test_every_controller_runs_it_and_takes_less_time(self):
        registered = set()
        for sample, controllers in SAMPLES.items():
            (plain, before), (fast, after) = self.plan(sample, False), self.plan(sample, True)
            registered |= set(controllers)
            saved = before["cuts_s"] - after["cuts_s"]
            self.assertGreater(saved, 0.1 * before["cuts_s"], sample)
            self.assertGreater(after["air_feed_s"], 0)
            for controller in controllers:
                # What ramps up and down at the ends of such ways is less than half a second here.
                self.assertAlmostEqual(plain[controller] - fast[controller], saved, delta=0.5, msg=f"{sample} {controller}")
        schema = json.loads((TOP / "docs" / "schema" / "job.schema.json").read_text())
        self.assertEqual(registered, set(schema["properties"]["programs"]["items"]["enum"]))


if __name__ == "__main__":
    unittest.main(argv=["air_feed_test"])
