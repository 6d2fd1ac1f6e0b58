#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""`millpose batch --slurm` on a real Slurm that the test sets up and tears down. Usage: slurm_test.py MILLPOSE TOP"""
import json
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest

from plan_fixture import contents, differences
from slurm_cluster import Cluster

MILLPOSE, TOP = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
JOB = TOP / "toolpaths" / "support_pad" / "job.yaml"
PARTS = 8


def results(folder):
    """What may not differ between a run here and one on the cluster."""
    return {name: data for name, data in contents(folder).items() if not name.startswith("checkpoints/")}


class Killer(threading.Thread):
    """Kills the first process that plans into a folder of this name, once."""

    def __init__(self, name):
        super().__init__(daemon=True)
        self.name, self.killed, self.ended = name, False, threading.Event()

    def run(self):
        while not self.killed and not self.ended.is_set():
            for entry in pathlib.Path("/proc").iterdir():
                if entry.name.isdigit() and self.is_victim(entry):
                    os.kill(int(entry.name), signal.SIGKILL)
                    self.killed = True
            time.sleep(0.01)

    def is_victim(self, process):
        try:
            words = (process / "cmdline").read_bytes().decode(errors="replace").split("\0")
            return words[0] == str(MILLPOSE) and any(word.endswith(self.name) for word in words)
        except OSError:
            return False


class Slurm(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.cluster = Cluster(cpus=4)
        cls.addClassCleanup(cls.cluster.close)
        folder = tempfile.TemporaryDirectory(prefix="millpose-slurm-test.")
        cls.addClassCleanup(folder.cleanup)
        cls.folder = pathlib.Path(folder.name)
        cls.folder.chmod(0o755)
        (cls.folder / "batch.yaml").write_text("millpose_batch: 1\njobs:\n" + "".join(
            f"  - {{job: {JOB}, name: part{i}, set: {{seed: {i + 1}, toolpath.spacing_mm: 8}}}}\n" for i in range(PARTS)))
        here = cls.batch("-o", "here")
        assert here.returncode == 0, here.stdout + here.stderr

    @classmethod
    def batch(cls, *arguments):
        return subprocess.run([MILLPOSE, "batch", "batch.yaml", *map(str, arguments)], cwd=cls.folder, text=True,
                              capture_output=True, env=cls.cluster.environment, timeout=1200, check=False)

    def assert_same_as_here(self, out):
        report = json.loads((self.folder / out / "batch.json").read_text())
        self.assertEqual((report["total"], report["done"]), (PARTS, PARTS))
        for i in range(PARTS):
            here, there = (results(self.folder / name / f"part{i}") for name in ("here", out))
            self.assertGreater(len(here), 8)
            self.assertEqual(differences(here, there), [])

    def test_a_failed_task_of_eight_runs_once_more(self):
        killer = Killer("/array/part5")
        killer.start()
        result = self.batch("-o", "array", "--slurm")
        killer.ended.set()
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        self.assertTrue(killer.killed)
        self.assert_same_as_here("array")
        self.assertEqual(len((self.folder / "array/slurm/jobs/submitted").read_text().split()), 2)
        self.assertEqual(self.batch("-o", "array", "--slurm").stdout.count("up to date"), PARTS)

    def test_passes_are_spread_over_tasks(self):
        result = self.batch("-o", "shares", "--slurm", "--shares", 3)
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        self.assert_same_as_here("shares")
        statuses = list((self.folder / "shares/slurm/shares").glob("*.status"))
        self.assertEqual({path.read_text() for path in statuses}, {"0\n"})
        self.assertEqual(len(statuses), 3 * PARTS)
        run = json.loads((self.folder / "shares/part0/run.json").read_text())
        passes = json.loads((self.folder / "shares/part0/summary.json").read_text())["passes"]
        self.assertEqual(run["resumed_passes"], passes)

    def test_detached_it_ends_at_once_and_gathers_later(self):
        killer = Killer("/detached/part2")
        killer.start()
        first = self.batch("-o", "detached", "--slurm", "--detach", "--shares", 2)
        self.assertEqual(first.returncode, 0, first.stderr)
        self.assertFalse((self.folder / "detached/batch.json").exists())
        self.assertIn("still run", self.batch("-o", "detached", "--slurm", "--detach").stdout)
        result = self.batch("-o", "detached", "--slurm")
        killer.ended.set()
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        self.assertTrue(killer.killed)
        self.assert_same_as_here("detached")
        self.assertEqual(result.stdout.count("up to date"), PARTS, "nothing was left to submit")

    def test_interrupted_it_leaves_the_tasks_and_takes_them_up_again(self):
        command = [MILLPOSE, "batch", "batch.yaml", "-o", "stopped", "--slurm"]
        with subprocess.Popen(command, cwd=self.folder, env=self.cluster.environment, text=True, stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE) as process:
            submitted = self.folder / "stopped/slurm/jobs/submitted"
            while not submitted.exists():
                self.assertIsNone(process.poll())
                time.sleep(0.05)
            process.send_signal(signal.SIGINT)
            _, errors = process.communicate(timeout=30)
        self.assertEqual(process.returncode, 130, errors)
        self.assertNotEqual(self.cluster.run("squeue", "--noheader"), "")
        self.assertEqual(self.batch("-o", "stopped", "--slurm").returncode, 0)
        self.assert_same_as_here("stopped")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
