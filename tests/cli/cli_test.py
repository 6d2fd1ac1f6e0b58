#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs the real millpose and looks at status, stdout and stderr. Usage: cli_test.py MILLPOSE TOP"""
import json
import subprocess
import sys
import unittest

MILLPOSE, TOP = sys.argv[1:3]


def run(*arguments):
    return subprocess.run([MILLPOSE, *map(str, arguments)], capture_output=True, text=True, timeout=120)


class Frame(unittest.TestCase):
    def test_version_and_help_go_to_stdout_with_status_0(self):
        self.assertRegex(run("--version").stdout, r"^millpose \d+\.\d+\.\d+\n$")
        result = run("--help")
        self.assertEqual(result.returncode, 0)
        self.assertIn("Exit status: 0 done", result.stdout)
        self.assertEqual(result.stderr, "")

    def test_usage_errors_go_to_stderr_with_status_2(self):
        for arguments in ((), ("paln",), ("schema",), ("schema", "robot"), ("--no-such-option",)):
            result = run(*arguments)
            self.assertEqual(result.returncode, 2, arguments)
            self.assertEqual(result.stdout, "", arguments)
            self.assertNotEqual(result.stderr, "", arguments)

    def test_mistyped_command_is_answered_with_the_nearest(self):
        self.assertIn("what is required", run("schema").stderr)
        self.assertIn("unknown command shema; nearest: schema", run("shema", "job").stderr)


class Schema(unittest.TestCase):
    def test_schemas_are_the_committed_ones(self):
        for what in ("job", "cell"):
            result = run("schema", what)
            self.assertEqual(result.returncode, 0)
            with open(f"{TOP}/docs/schema/{what}.schema.json", encoding="utf-8") as file:
                self.assertEqual(json.loads(result.stdout), json.load(file))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
