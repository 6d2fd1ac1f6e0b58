#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""No value is used before it is set: valgrind over the optimised program. Arguments: MILLPOSE TOP"""
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

MILLPOSE, TOP = Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve()
JOB = TOP / "toolpaths" / "support_pad" / "job.yaml"
REPORTS = 9


def reports(*arguments):
    """How many reports valgrind has of a run, with what it says."""
    result = subprocess.run(["valgrind", f"--error-exitcode={REPORTS}", "--max-threads=64", MILLPOSE, *map(str, arguments)],
                            capture_output=True, text=True, timeout=3000)
    count = re.search(r"ERROR SUMMARY: (\d+) errors", result.stderr)
    assert count and result.returncode in (0, 1, REPORTS), result.stderr[-3000:]
    return int(count[1]), "\n".join(line for line in result.stderr.splitlines() if line.startswith("=="))[:5000]


class Valgrind(unittest.TestCase):
    def no_reports(self, *arguments):
        count, text = reports(*arguments)
        self.assertEqual(count, 0, text)

    def test_schema_has_only_defaults_that_are_set(self):
        self.no_reports("schema", "job")

    def test_check(self):
        self.no_reports("check", JOB)

    def test_plan(self):
        with tempfile.TemporaryDirectory() as folder:
            self.no_reports("plan", JOB, "-o", Path(folder) / "out", "--threads", "2", "--set", "toolpath.stepover_mm=50", "--set",
                            "toolpath.spacing_mm=60", "--set", "path.rotation_step_deg=10", "--set", "pose.genetic.generations=2")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
