# SPDX-License-Identifier: GPL-3.0-or-later
"""usage: own_objective_test.py PROGRAM TOP: a program with an objective of its own (consumer/) plans a job and reads joints."""
import math
import subprocess
import sys
import unittest

PROGRAM, TOP = sys.argv[1:3]


class OwnObjective(unittest.TestCase):
    def test_plans_and_reads_joints(self):
        done = subprocess.run([PROGRAM, f"{TOP}/toolpaths/support_pad/job.yaml", "toolpath.stepover_mm=40",
                               "toolpath.spacing_mm=40", "programs=[]"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        rows = [[float(number) for number in line.split()] for line in done.stdout.splitlines()]
        self.assertGreaterEqual(len(rows), 6)
        for value, *joints in rows:
            self.assertTrue(1e-6 < value < 1e-2, value)
            self.assertEqual(len(joints), 6)
            self.assertTrue(all(abs(joint) < math.radians(350) for joint in joints), joints)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
