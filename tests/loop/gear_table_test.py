#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Gear tables from the outside: programs run by arms whose joints err under a controller that knows nothing of it.
Usage: as loop_test.py, whose bench it shares."""
import json
import os
import re
import subprocess
import sys
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import loop_test as loop  # noqa: E402
from arms import ARMS, cell_with, small_job  # noqa: E402

GEARS = """    gears:
      - {joint: 1, harmonic: 1, amplitude_arcsec: 25, phase_deg: 40}
      - {joint: 1, harmonic: 40, amplitude_arcsec: 10, phase_deg: -70}
      - {joint: 2, harmonic: 2, amplitude_arcsec: 30, phase_deg: 15}
      - {joint: 2, harmonic: 30, amplitude_arcsec: 8, phase_deg: 100}
      - {joint: 3, harmonic: 1, amplitude_arcsec: 35, phase_deg: 160}
      - {joint: 4, harmonic: 2, amplitude_arcsec: 40, phase_deg: -20}
      - {joint: 5, harmonic: 3, amplitude_arcsec: 40, phase_deg: 75}
      - {joint: 6, harmonic: 1, amplitude_arcsec: 60, phase_deg: -140}
    couplings: [{joint: 3, follows: 2, factor: 0.00045}]
"""


class GearTables(unittest.TestCase):
    """Joints that err, under a controller that knows nothing of it: programs with and without the arm's tables."""

    def planned(self, cell, place, size, controllers, what, deviations, judged, most="2"):
        """(job, cell, folder, finished process)."""
        arm = cell_with(loop.BENCH.top / "cells" / f"{cell}.yaml", f"{cell}_{what}", deviations)
        # A coupling asks for more than waves do.
        job = small_job(loop.BENCH, arm.stem, place, size, controllers, arm.stem, f"{{deviations: true, max_gear_mm: {most}}}")
        result, folder = loop.BENCH.plan(job, arm.stem, *(["--audit"] if judged and loop.SLOW else []))
        return job, arm, folder, result

    def run_by(self, folder, job, controller, arm):
        result = subprocess.run([loop.LOOP, folder, "--inputs", job.parent, "--controller", controller, "--own-arm", "--true-arm", arm],
                                capture_output=True, text=True, timeout=600)
        self.assertEqual(result.returncode, 0, result.stderr)
        return json.loads(result.stdout)

    def check(self, cell, place, size, controllers, judged):
        """Programs for the arm with its tables take it where the plan has the tool."""
        job, arm, folder, result = self.planned(cell, place, size, controllers, "whole", loop.DEVIATIONS + GEARS, judged)
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
        self.assertGreater(summary["compensation"]["largest_gear_mm"], 0.05)
        row = next(row for row in summary["budget"]["rows"] if row["source"] == "gear_error")
        self.assertIn("take out the tables of arm 882134", row["basis"])
        self.assertEqual({program["controller"] for program in summary["programs"]}, set(controllers))
        found = {}
        for program in summary["programs"]:
            controller = program["controller"]
            self.assertTrue(program["verified"])
            found[controller] = self.run_by(folder, job, controller, arm)
            told = f"{cell} {controller}: {found[controller]}, between {row['um']}"
            if loop.SLOW or os.environ.get("MILLPOSE_TELL"):
                print(told, flush=True)
            self.assertLess(found[controller]["own_normal_um"], 3, told)  # read back to 2 µm
            self.assertLess(found[controller]["own_tip_um"], 20, told)  # of path_tolerance_mm
            self.assertLess(found[controller]["own_axis_deg"], 0.02, told)
            # Between the points the report's figure holds, and what the program leaves out.
            self.assertLess(found[controller]["own_between_um"], row["um"] + 20, told)
            text = "".join(f.read_text(encoding="utf-8") for f in (folder / "programs" / controller).iterdir() if f.is_file())
            text = re.sub(r" ;\n *\d+:  !:", "", text)  # FANUC's remarks are short
            self.assertIn("corrected_for_gears: waves of A1 (2), A2 (2), A3 (1), A4 (1), A5 (1), A6 (1), A3 with A2", text)
        return arm, folder, job, found

    def test_programs_of_all_controllers_take_the_tables_out(self):
        for cell, place, size, controllers in ARMS:
            size = size if loop.SLOW else 1
            judged = loop.SLOW or cell == "kr500_r2830"
            arm, folder, job, found = self.check(cell, place, size, controllers, judged)
            if not judged:
                continue
            status, verdict = loop.BENCH.audit(folder, job, *loop.TRAVEL)
            self.assertEqual((status, verdict["broken"]), (0, {}))
            # Without the tables the same arm errs.
            job, _, folder, result = self.planned(cell, place, size, controllers, "frames", loop.DEVIATIONS, False)
            self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
            self.assertNotIn("largest_gear_mm", json.loads((folder / "summary.json").read_text(encoding="utf-8"))["compensation"])
            for controller in controllers if loop.SLOW else controllers[:1]:
                without = self.run_by(folder, job, controller, arm)
                self.assertGreater(without["own_normal_um"], 40, f"{cell} {controller}")
                self.assertLess(found[controller]["own_normal_um"], 0.05 * without["own_normal_um"], f"{cell} {controller}")

    def test_more_than_a_gear_can_err_by_is_an_error(self):
        _, _, folder, result = self.planned(*ARMS[0], "wrong", loop.DEVIATIONS + GEARS, False, "0.01")
        self.assertEqual(result.returncode, 2, result.stdout)
        self.assertIn("gears and couplings of cell kr500_r2830 move the tip by up to", result.stderr)
        self.assertFalse((folder / "plan.cbor.gz").exists())


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[5:], verbosity=2)
