#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""`millpose plan` over an earlier plan, killed or failing at its N-th file operation: 20 places, or all with
MILLPOSE_FAULT_PLACES=all. Usage: replan_test.py MILLPOSE TOP FAULTS DRIVER"""
import json
import os
import shutil
import socket
import subprocess
import sys

sys.path.insert(0, os.path.join(sys.argv[2], "tests", "cli"))
from operations_sample import CELL, small  # noqa: E402
from fault_fixture import ALL, DRIVER, FAULTS, MILLPOSE, TOP, Faults, is_clean, main, places, programs, results, run

SETS = ("toolpath.stepover_mm=60", "toolpath.spacing_mm=60", "programs=[krl, linuxcnc]")


class Replan(Faults):
    def write(self, folder, letter):
        sets = SETS + (("process.spindle_rpm=100",) if letter == "B" else ())
        return (MILLPOSE, "plan", TOP / "toolpaths" / "support_pad" / "job.yaml", "-o", folder, "-q",
                "--threads", "1",  # of two that want one folder at once both may try to make it: the count would vary
                *(word for change in sets for word in ("--set", change)))

    def read_open(self, where):
        """Readers repair nothing and take no half for a whole."""
        read = subprocess.run([MILLPOSE, "verify", self.out], capture_output=True, text=True, timeout=600)
        self.assertIn(read.returncode, (0, 2), (where, read.stdout))
        if read.returncode == 2:
            self.assertIn("is being replaced by another run, or was when that was ended", read.stderr, where)

    def test_killed(self):
        count = self.prepare()
        self.assertGreater(count, 60)
        self.kill_at(places(count, 10), again=lambda at: ALL or at % 40 == 0)

    def test_a_first_plan_killed(self):
        done = run(self.write(self.a, "A"), self.a, count=self.top / "count")
        self.assertEqual(done.returncode, 0, done.stderr)
        whole = results(self.a)
        for at in places(int((self.top / "count").read_text()), 4):
            with self.subTest(killed_at=at):
                shutil.rmtree(self.out, ignore_errors=True)
                self.assertEqual(run(self.write(self.out, "A"), self.out, at).returncode, -9)
                left = programs(results(self.out)) if self.out.exists() else {}
                self.assertIn(left, ({}, programs(whole)))
                done = run(self.write(self.out, "A"), self.top)
                self.assertEqual(done.returncode, 0, done.stderr)
                self.assertEqual(results(self.out), whole)
                self.assertTrue(is_clean(self.out))

    def test_failing(self):
        count = self.prepare()
        self.fail_at(places(count, 3), "ENOSPC", stays=False)
        self.fail_at(places(count, 3), "EACCES", stays=True)

    def test_without_locks_owner_files_keep_runs_apart(self):
        env = dict(os.environ, LD_PRELOAD=str(FAULTS), MILLPOSE_FAULT_NO_LOCKS="1")

        def plan():
            return subprocess.run(self.write(self.a, "A"), capture_output=True, text=True, env=env)

        first = plan()
        self.assertEqual(first.returncode, 0, first.stderr)
        self.assertIn("the file system has no locks", first.stdout)
        owner = {"host": socket.gethostname(), "process": 2**22 + 1, "since": "2026-01-02T03:04:05Z", "alone": True}
        (self.a / ".owner.dead").write_text(json.dumps(owner))  # larger than any process number
        self.assertEqual(plan().returncode, 0)
        self.assertFalse((self.a / ".owner.dead").exists())
        (self.a / ".owner.other").write_text(json.dumps({**owner, "host": "other"}))
        refused = plan()
        self.assertEqual(refused.returncode, 2)
        self.assertRegex(refused.stderr, r"on other since 2026-01-02T03:04:05Z \(if it has ended, remove .*\.owner\.other\)")
        (self.a / ".owner.other").write_text(json.dumps({**owner, "host": "other", "alone": False}))
        self.assertEqual(plan().returncode, 2, "a share plans there")

    def test_an_edited_program_that_is_in_the_manifest_is_compared_with_the_plan(self):
        self.assertEqual(subprocess.run(self.write(self.a, "A"), capture_output=True).returncode, 0)
        source = self.a / "programs" / "krl" / "support_pad.src"
        text = source.read_text()
        line = next(line for line in text.splitlines() if line.startswith("LIN "))
        self.assertIn("Z ", line)
        source.write_text(text.replace(line, line.replace("Z ", "Z 1"), 1))
        verify = [MILLPOSE, "verify", self.a]
        self.assertEqual(subprocess.run(verify, capture_output=True).returncode, 1)
        subprocess.run([DRIVER, self.a, "sign"], check=True)
        found = subprocess.run(verify, capture_output=True, text=True)
        self.assertEqual(found.returncode, 1, found.stderr)
        self.assertRegex(found.stdout, r"support_pad\.src:\d+: ")


class ReplanOfSeveral(Faults):
    """A job of two operations, planned again with another speed of the spindle."""

    read_open = Replan.read_open

    def setUp(self):
        super().setUp()
        text, begin = small(), "  - name: trim_window\n"
        text = text[:text.index(begin)] + text[text.index("  - name: drill_holes\n"):]
        (self.top / "job.yaml").write_text(text)
        (self.top / "cell.yaml").write_text(CELL)

    def write(self, folder, letter):
        return (MILLPOSE, "plan", self.top / "job.yaml", "-o", folder, "-q", "--threads", "1", "--set", "programs=[krl]",
                "--set", f"process.spindle_rpm={dict(A=7000, B=6500)[letter]}")

    def test_killed_or_failing(self):
        count = self.prepare()
        self.assertGreater(count, 60)
        self.kill_at(places(count, 8), again=lambda at: ALL or at > 0.9 * count)
        self.fail_at(places(count, 2), "EACCES", stays=False)


if __name__ == "__main__":
    main()
