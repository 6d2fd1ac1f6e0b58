# SPDX-License-Identifier: GPL-3.0-or-later
"""usage: compare_stiffness_test.py SCRIPT: the example script that compares two summaries."""
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

SCRIPT = sys.argv[1]


def summary(worst=4e-4, planned=210):
    return {"points": {"total": 210, "planned": planned, "skipped": 210 - planned},
            "stiffness": {"lambda_t1": {"best": 2e-4, "median": 3e-4, "worst": worst},
                          "objective": None if planned == 0 else {"best": 1e-4, "median": 2e-4, "worst": 3e-4},
                          "units": {"lambda_t1": "mm/N", "objective": "mm/N"}}}


class CompareStiffness(unittest.TestCase):
    def compare(self, expected, actual, *options):
        with tempfile.TemporaryDirectory() as folder:
            names = [pathlib.Path(folder) / name for name in ("expected.json", "actual.json")]
            for name, content in zip(names, (expected, actual)):
                name.write_text(content if isinstance(content, str) else json.dumps(content))
            return subprocess.run([sys.executable, SCRIPT, *map(str, names), *options], capture_output=True, text=True,
                                  timeout=60)

    def test_equal_summaries_pass(self):
        result = self.compare(summary(), summary())
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        self.assertEqual(result.stdout, "0 of 7 figures changed by more than 0.1 %\n")

    def test_change_in_either_direction_is_named(self):
        for worst in (4.1e-4, 3.9e-4):
            result = self.compare(summary(), summary(worst))
            self.assertEqual(result.returncode, 1)
            self.assertIn(f"lambda_t1.worst: expected 0.0004, got {worst}\n", result.stdout)

    def test_bound_is_taken_from_the_command_line(self):
        self.assertEqual(self.compare(summary(), summary(4.1e-4), "--percent", "3").returncode, 0)
        self.assertEqual(self.compare(summary(), summary(4.1e-4), "--percent", "2").returncode, 1)

    def test_fewer_points_and_missing_figures_fail(self):
        self.assertEqual(self.compare(summary(), summary(planned=209)).returncode, 1)
        self.assertIn("objective.worst: expected 0.0003, got None",
                      self.compare(summary(), summary(planned=0)).stdout)

    def test_unreadable_file_is_status_2(self):
        for bad in ("{", "[]", "{}"):
            result = self.compare(summary(), bad)
            self.assertEqual((result.returncode, result.stdout), (2, ""), bad)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
