#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The samples in full, each judged without mercy (slow). Usage: samples_test.py MILLPOSE MILLPOSE_AUDIT TOP"""
import json
import random
import signal
import subprocess
import sys
import time
import unittest

from plan_fixture import Bench, contents, differences, kill_after, started

BENCH = None


class Samples(unittest.TestCase):
    def check(self, name, least_points, off_the_part=()):
        """off_the_part: operations whose points do not lie on it, as roughing does not."""
        job = BENCH.job(name)
        result, folder = BENCH.plan(job, name, "--threads", "1", timeout=1800)
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        points = json.loads((folder / "summary.json").read_text(encoding="utf-8"))["points"]
        self.assertGreaterEqual(points["total"], least_points)
        self.assertEqual(points["skipped"], 0)
        operations = folder / "operations"
        for plan in sorted(operations.iterdir()) if operations.exists() else [folder]:
            status, verdict = BENCH.audit(plan, job, "--travel-mm", "0.2")
            allowed = {"max_slice_distance_mm"} if plan.name in off_the_part else set()
            self.assertEqual((status, set(verdict["broken"])), (1 if allowed else 0, allowed), plan.name)
        reference = contents(folder)
        for threads in ("2", "4"):
            _, other = BENCH.plan(job, f"{name}{threads}", "--threads", threads, timeout=1800)
            self.assertEqual(differences(reference, contents(other)), [])

    def test_support_pad(self):
        self.check("support_pad", 200)

    def test_cabin_panel(self):
        self.check("cabin_panel", 2000)

    def test_cabin_ring(self):
        self.check("cabin_ring", 1000)

    def test_cabin_holes(self):
        self.check("cabin_holes", 100)

    def test_cabin_trim(self):
        self.check("cabin_trim", 400)

    def test_cabin_pocket(self):
        self.check("cabin_pocket", 800, ("01_rough_pocket", "02_rest_corners", "04_rough_back"))


class Kills(unittest.TestCase):
    def test_killed_at_fifty_moments_it_leaves_the_same_bytes(self):
        job = BENCH.job("support_pad")
        began = time.monotonic()
        _, folder = BENCH.plan(job, "undisturbed")
        seconds = time.monotonic() - began
        reference = contents(folder)
        programs = {name: text for name, text in reference.items() if name.startswith("programs/")}
        for _ in range(50):
            killed = BENCH.top / "killed"
            with started(BENCH.millpose, "plan", job, "-o", killed) as process:
                kill_after(process, random.uniform(0, seconds), signal.SIGKILL)
            if (killed / "programs").exists():
                left = contents(killed)
                self.assertEqual(programs, {name: left[name] for name in left if name.startswith("programs/")})
            result, _ = BENCH.plan(job, "killed")
            self.assertEqual(result.returncode, 0, result.stderr)
            self.assertEqual(differences(reference, contents(killed)), [])
            BENCH.remove(killed)


if __name__ == "__main__":
    BENCH = Bench(*sys.argv[1:4])
    unittest.main(argv=sys.argv[:1])
