#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""An objective spelled in the job plans as the built-in one does, for any number of threads, and has checkpoints of its
own. Usage: expression_test.py MILLPOSE TOP"""
import json
import unittest

from cli_fixture import JOB, InFolder, run

SMALL = ("toolpath.stepover_mm=40", "toolpath.spacing_mm=40", "programs=[krl]")
BUILT_IN = "pose.objective={name: normal_deflection}"
SPELLED = "pose.objective={expression: '1*normal_deflection_mm_N + 0'}"
OTHER = "pose.objective={expression: 'max(lambda_t1_mm_N, 2*lambda_n_mm_N)'}"


class Expressions(InFolder):
    def plan(self, out, *changes, threads=1):
        return run("plan", JOB, "-o", self.folder / out, "-q", "--threads", threads,
                   *[word for change in (*SMALL, *changes) for word in ("--set", change)])

    def test_spelled_is_built_in(self):
        built_in = self.plan("a", BUILT_IN)
        self.assertLess(built_in.returncode, 2, built_in.stderr)
        self.assertEqual(self.plan("b", SPELLED, threads=2).returncode, built_in.returncode)
        self.assertEqual((self.folder / "a/points.csv").read_bytes(), (self.folder / "b/points.csv").read_bytes())
        summary = json.loads((self.folder / "b/summary.json").read_text())
        self.assertEqual(summary["objective"], "1*normal_deflection_mm_N + 0")
        self.assertEqual(run("verify", self.folder / "b").returncode, 0)
        # Another expression is planned anew in the same folder, and as in a folder of its own.
        self.assertLess(self.plan("b", OTHER).returncode, 2)
        self.assertLess(self.plan("c", OTHER, threads=2).returncode, 2)
        self.assertEqual((self.folder / "b/points.csv").read_bytes(), (self.folder / "c/points.csv").read_bytes())
        self.assertNotEqual((self.folder / "b/points.csv").read_bytes(), (self.folder / "a/points.csv").read_bytes())

    def test_errors_leave_nothing(self):
        done = self.plan("d", "pose.objective={expression: 'pow(mu, 2) + lambda_n'}")
        self.assertEqual(done.returncode, 2)
        for text in ('at character 1: no index or function "pow"', 'at character 14: no index or function "lambda_n"',
                     "normal_deflection_mm_N"):
            self.assertIn(text, done.stderr)
        self.assertFalse((self.folder / "d").exists())


if __name__ == "__main__":
    unittest.main(argv=["expression_test"])
