#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""`verify` beside `plan` in one folder: the plan is never refused, and what verify says is of one plan. Two pairs, or as many as
MILLPOSE_PAIRS says. Usage: verify_pairs_test.py MILLPOSE TOP"""
import os
import subprocess
import unittest

from cli_fixture import FEW, JOB, MILLPOSE, InFolder, plan, run

PAIRS = int(os.environ.get("MILLPOSE_PAIRS", "2"))


class Pairs(InFolder):
    def test_no_false_verdict_and_no_refused_plan(self):
        out = self.folder / "out"
        self.assertEqual(plan(out, "--threads", 1).returncode, 0)
        confirmed = run("verify", out).stdout.count("  confirmed  ")
        seen = []
        for pair in range(PAIRS):
            speed = (9000, 7000)[pair % 2]  # of the spindle: the programs of two plans differ in it
            planning = subprocess.Popen([MILLPOSE, "plan", JOB, "-o", out, "-q", "--threads", "1", "--set", f"process.spindle_rpm={speed}",
                                         *(word for change in FEW for word in ("--set", change))], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
            while planning.poll() is None:
                seen.append(run("verify", out, "-q"))
            self.assertEqual(planning.returncode, 0, planning.stderr.read())
            planning.stderr.close()
        for verdict in seen:
            if verdict.returncode == 2:
                self.assertIn("is being replaced", verdict.stderr)
            else:
                self.assertEqual(verdict.returncode, 0, verdict.stdout + verdict.stderr)
                self.assertEqual(verdict.stdout.count("  confirmed  "), confirmed)
        self.assertIn(0, [verdict.returncode for verdict in seen])
        self.assertEqual(run("verify", out).returncode, 0)


if __name__ == "__main__":
    unittest.main(argv=["verify_pairs_test"])
