#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""What surrounds the work: a system without threads, files that are none, text that commands a terminal.
Usage: guards_test.py MILLPOSE TOP NO_THREADS (a library for LD_PRELOAD)"""
import fcntl
import json
import os
import shutil
import sys
import unittest
from pathlib import Path

NO_THREADS = Path(sys.argv.pop()).resolve()

from cli_fixture import JOB, TOP, InFolder, plan, run, tree  # noqa: E402: takes the other arguments

ESC, CSI, OVERRIDE = "\x1b[2J", "\u009b31m", "\u202e"


class Threads(InFolder):
    def test_fewer_threads_or_status_2(self):
        whole = plan(self.folder / "whole", "--threads", 8, "--quiet")
        self.assertEqual(whole.returncode, 0, whole.stderr)
        for threads, status in ((0, 2), (1, 0), (3, 0)):  # the first one waits for signals
            with self.subTest(threads):
                out = self.folder / f"{threads}"
                env = {**os.environ, "LD_PRELOAD": str(NO_THREADS), "MILLPOSE_THREADS": str(threads)}
                sets = [word for key in ("stepover_mm=40", "spacing_mm=40") for word in ("--set", f"toolpath.{key}")]
                result = run("plan", JOB, "-o", out, *sets, "--threads", 8, env=env)
                self.assertEqual(result.returncode, status, result.stderr)
                if status == 0:
                    self.assertEqual(tree(out), tree(self.folder / "whole"))
                else:
                    self.assertEqual(result.stderr, "millpose: no thread to be had: the system, or a limit set on it "
                                                    "(ulimit -u, pids.max), gives none\n")

    def test_a_batch_without_threads(self):
        env = {**os.environ, "LD_PRELOAD": str(NO_THREADS), "MILLPOSE_THREADS": "1"}
        (self.folder / "batch.yaml").write_text(
            "millpose_batch: 1\njobs:\n" + "".join(
                f"  - {{job: '{JOB}', name: part{i}, set: {{toolpath.stepover_mm: 70, toolpath.spacing_mm: 80}}}}\n"
                for i in range(2)))
        result = run("batch", self.folder / "batch.yaml", "-o", self.folder / "out", "--parallel", 2, "--threads", 2, env=env)
        self.assertEqual(result.returncode, 0, result.stderr + result.stdout)


class NoFiles(InFolder):
    def test_a_fifo_is_refused_before_it_is_opened(self):
        """Whatever names it: a reader would wait for a writer that never comes."""
        shutil.copytree(JOB.parent, self.folder / "job")
        job, text = self.folder / "job/job.yaml", JOB.read_text().replace("../../cells", str(TOP / "cells"))
        os.mkfifo(self.folder / "job/fifo")
        for old, new in (("support_pad.stl", "fifo"), (str(TOP / "cells/kr500_r2830.yaml"), "fifo")):
            self.assertEqual(text.count(old), 1)
            job.write_text(text.replace(old, new))
            for command in (("check", job), ("plan", job, "-o", self.folder / "out")):
                with self.subTest(new=new, command=command[0]):
                    result = run(*command, timeout=20)
                    self.assertEqual(result.returncode, 2, result.stderr)
                    self.assertIn("fifo: not a regular file but a FIFO", result.stderr)
        cell = (TOP / "cells/kr500_r2830.yaml").read_text()
        cell = cell.replace("shape: {box: {size_mm: [502, 574, 686]}}", "shape: {mesh: {file: fifo, unit: mm}}")
        (self.folder / "job/cell.yaml").write_text(cell)
        for command in (("check", "fifo"), ("plan", "fifo"), ("check", "cell.yaml"), ("stiffness", "fifo"), ("verify", "fifo"),
                        ("batch", "fifo"), ("flatness", "fifo"), ("identify", "fifo"), ("init", "fifo", "--arm", "fifo")):
            with self.subTest(command=command):
                result = run(*command, cwd=self.folder / "job", timeout=20)
                self.assertNotEqual(result.returncode, 0)
        self.assertIn("not a regular file but a device", run("check", "/dev/zero", timeout=20).stderr)


class Terminal(InFolder):
    def assert_clean(self, result):
        for text in (result.stdout, result.stderr):
            self.assertNotRegex(text, "[\x00-\x08\x0b-\x1f\x7f-\x9f\u200e\u200f\u061c\u202a-\u202e\u2066-\u2069]")

    def test_foreign_text_commands_no_terminal(self):
        name = f"part{ESC}{CSI}{OVERRIDE}\n\rü€😀.stl"
        missing = run("check", self.folder / name)
        self.assertEqual(missing.returncode, 2)
        self.assert_clean(missing)
        self.assertIn("part?[2J?31m???ü€😀.stl", missing.stderr)
        shutil.copy(JOB.parent / "support_pad.stl", self.folder / name)
        found = run("check", self.folder / name)
        self.assert_clean(found)
        self.assertIn("ü€😀.stl", found.stdout)
        for command in (("plan", ESC), ("--" + ESC,), (ESC,), ("plan", JOB, "--set", f"name={ESC}"), ("check", "--json", self.folder / name)):
            with self.subTest(command=command):
                self.assert_clean(run(*command))

    def test_texts_of_yaml_cannot_hold_commands(self):
        text = JOB.read_text().replace("../../cells", str(TOP / "cells"))
        for old, new in (("material: 5A06", 'material: "5A06\\e[2J"'), ("name: support_pad", 'name: "pad\\x9b"'),
                         ("name: support_pad", 'name: "pad\\u202E"')):
            self.assertEqual(text.count(old), 1)
            (self.folder / "job.yaml").write_text(text.replace(old, new))
            with self.subTest(new):
                self.assert_clean(run("check", self.folder / "job.yaml"))
                self.assert_clean(run("plan", self.folder / "job.yaml", "-o", self.folder / "out"))

    def test_the_host_of_an_owner_file(self):
        out = self.folder / "out"
        self.assertEqual(plan(out).returncode, 0)
        (out / ".owner.x.1.1").write_text(json.dumps({"host": f"host{ESC}{CSI}", "process": 1, "since": ESC, "alone": True}))
        with open(out / ".lock", "w") as lock:
            fcntl.lockf(lock, fcntl.LOCK_EX)
            busy = plan(out, "--fresh")
        self.assertEqual(busy.returncode, 2)
        self.assertIn("on host?[2J?31m since ?[2J", busy.stderr)
        self.assert_clean(busy)

    def test_characters_are_whole_across_what_is_written_at_a_time(self):
        """Longer than any buffer, every length of character at every place."""
        folder = self.folder
        for i in range(30):
            folder = folder / ("€ü😀" * 20 + "x" * (i % 4))
        result = run("check", folder / "missing.stl")
        self.assertIn("€ü😀" * 20, result.stderr)
        self.assertNotIn("?", result.stderr)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
