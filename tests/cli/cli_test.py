#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs the real millpose and looks at status, stdout and stderr. Usage: cli_test.py MILLPOSE TOP"""
import json
import re
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


class Documents(unittest.TestCase):
    def test_manual_names_every_command_and_option(self):
        page = run("man").stdout
        self.assertTrue(page.startswith(".TH MILLPOSE 1\n"))
        names = re.findall(r"^  (\w+)  ", run("--help").stdout.split("Subcommands:")[1], re.M)
        self.assertIn("schema", names)
        for name in names:
            self.assertIn(f".SS {name}\n", page)
            for option in re.findall(r"--[a-z][a-z-]+", run(name, "--help").stdout):
                self.assertIn(option.replace("-", "\\-"), page, name)
        self.assertEqual([line for line in page.splitlines() if re.match(r"[.'](?!TH|SH|SS|TP|br)", line)], [])

    def test_completion_offers_commands_options_and_files(self):
        def complete(*words):
            script = run("completion").stdout + f"COMP_WORDS=(millpose {' '.join(words)}); COMP_CWORD={len(words)}; " \
                "_millpose; printf '%s\\n' ${COMPREPLY[@]}"
            result = subprocess.run(["bash", "-c", script], capture_output=True, text=True, cwd=TOP, timeout=60)
            self.assertEqual(result.stderr, "")
            return result.stdout.split()

        self.assertEqual(complete("sch"), ["schema"])
        self.assertIn("flatness", complete("''"))
        self.assertIn("--quiet", complete("--qu"))
        self.assertIn("--help", complete("schema", "--"))
        self.assertEqual(complete("flatness", "READ"), ["README.md"])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
