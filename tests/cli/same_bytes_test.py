#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The same bytes on another machine: as a processor without FMA and AVX would run it.

glibc chooses its code by the processor; GLIBC_TUNABLES takes features away from it. MILLPOSE_INSTRUCTION_SET does the same
for the loops over lanes. Usage: same_bytes_test.py MILLPOSE STEP_PART TOP [TEST…]; STEP_PART prints a STEP file, none: "".
With MILLPOSE_SLOW in the environment all samples as they are.
"""
import os
import subprocess
import sys
import unittest

from plan_fixture import Bench, contents, differences

BENCH = None
STEP_PART = ""
TUNABLES = {"GLIBC_TUNABLES": "glibc.cpu.hwcaps=-FMA,-AVX2,-AVX512F,-FMA4"}
OLD = {**TUNABLES, "MILLPOSE_INSTRUCTION_SET": "baseline"}
COARSE = [(r"rotation_step_deg: 1\n", "rotation_step_deg: 4\n"), (r"exhaustive_step_deg: 0.05", "exhaustive_step_deg: 2"),
          (r"generations: 6", "generations: 5"), (r"swept_resolution_mm: 0.5", "swept_resolution_mm: 5")]
RING = [*COARSE, (r"stepover_mm: 10", "stepover_mm: 60"), (r"spacing_mm: 10", "spacing_mm: 40"),
        (r"chord_tolerance_mm: 0.02", "chord_tolerance_mm: 0.05")]
# Rings about the hole of the drilled block, whose wall and rim STEP gives as curves.
BLOCK = [*COARSE, (r"mesh: support_pad.stl", "mesh: block.step\n  chord_tolerance_mm: 0.05"),
         (r"xyz_mm: \[2076, 0, 1006\]", "xyz_mm: [2076, 0, 986]"),
         (r"strategy: parallel_planes", "strategy: rings"), (r"planes: .*", "rings: {point_mm: [50, 30, 20], axis: [0, 0, 1]}"),
         (r"stepover_mm: 8", "stepover_mm: 10"), (r"spacing_mm: 4\n", "spacing_mm: 30\n"), (r"rotation_reference: .*", "rotation_reference: [0, 0, 1]")]
SINES = "import math; print(sum(hash(math.sin(i * 1e-4)) + hash(math.exp(-i * 1e-4)) for i in range(20000)))"


def output(command, **more):
    return subprocess.run(command, capture_output=True, check=True, env={**os.environ, **more}).stdout


class SameBytes(unittest.TestCase):
    def setUp(self):
        if output([sys.executable, "-c", SINES]) == output([sys.executable, "-c", SINES], **TUNABLES):
            self.skipTest("this processor's own code is that without FMA: nothing to compare")

    def planned(self, job, name, **more):
        result = subprocess.run([BENCH.millpose, "plan", job, "-o", BENCH.top / name, "-q"], capture_output=True, text=True,
                                env={**os.environ, **more}, check=False)
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        return contents(BENCH.top / name)

    def expect_same(self, job, name, ways):
        here = self.planned(job, name)
        self.assertGreater(here["points.csv"].count(b"\n"), 20)
        for number, way in enumerate(ways):
            self.assertEqual(differences(here, self.planned(job, f"{name}{number}", **way)), [], way)


@unittest.skipIf("MILLPOSE_SLOW" in os.environ, "as a whole in this tier")
class Quick(SameBytes):
    def test_a_ring(self):
        self.expect_same(BENCH.job("cabin_ring", RING, "cut_down"), "ring", [OLD])

    def test_a_part_from_step(self):
        if not STEP_PART:
            self.skipTest("built without STEP")
        (BENCH.top / "toolpaths/support_pad/block.step").write_bytes(output([STEP_PART]))
        self.expect_same(BENCH.job("support_pad", BLOCK, "from_step"), "step", [OLD])


@unittest.skipUnless("MILLPOSE_SLOW" in os.environ, "in the slow tier")
class Whole(SameBytes):
    def test_support_pad(self):
        self.expect_same(BENCH.job("support_pad"), "pad", [OLD, {**TUNABLES, "MILLPOSE_INSTRUCTION_SET": "avx2"}])

    def test_cabin_ring(self):
        self.expect_same(BENCH.job("cabin_ring"), "ring", [OLD])

    def test_cabin_panel(self):
        self.expect_same(BENCH.job("cabin_panel"), "panel", [OLD])


if __name__ == "__main__":
    STEP_PART = sys.argv[2]
    BENCH = Bench(sys.argv[1], None, sys.argv[3])
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]])
