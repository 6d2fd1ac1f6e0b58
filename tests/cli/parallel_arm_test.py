#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""A lab with a UR10e: the sample is planned, judged and verified; what such an arm cannot have is refused in words.
Usage: parallel_arm_test.py MILLPOSE MILLPOSE_AUDIT TOP"""
import csv
import json
import math
import re
import sys
import unittest

from plan_fixture import Bench, contents, differences

BENCH = None

# Universal Robots' Denavit-Hartenberg table of the UR10e: a, alpha, d; mm, rad.
QUARTER = math.pi / 2
UR10E = ((0, QUARTER, 180.7), (-612.7, 0, 0), (-571.55, 0, 0), (0, QUARTER, 174.15), (0, -QUARTER, 119.85), (0, 0, 116.55))


def multiply(a, b):
    return [[sum(a[i][k] * b[k][j] for k in range(4)) for j in range(4)] for i in range(4)]


def flange(degrees):
    pose = [[float(i == j) for j in range(4)] for i in range(4)]
    for (a, alpha, d), angle in zip(UR10E, degrees):
        s, c, sa, ca = math.sin(math.radians(angle)), math.cos(math.radians(angle)), math.sin(alpha), math.cos(alpha)
        pose = multiply(pose, [[c, -s * ca, s * sa, a * c], [s, c * ca, -c * sa, a * s], [0, sa, ca, d], [0, 0, 0, 1]])
    return pose


def tip(degrees):
    """Of the sample cell's tool, in the robot's base, and the tool's axis."""
    pose = flange(degrees)
    place = [sum(pose[i][k] * value for k, value in enumerate((-150, 0, 70, 1))) for i in range(3)]
    return place, [pose[i][0] for i in range(3)]


def urdf():
    """The same arm in frames as its maker's URDF has them, metres; the base is turned by half a turn."""
    joints = (("0 0 0.1807", "0 0 3.141592653589793"), ("0 0 0", "1.570796326794897 0 0"), ("-0.6127 0 0", "0 0 0"),
              ("-0.57155 0 0.17415", "0 0 0"), ("0 -0.11985 0", "1.570796326794897 0 0"),
              ("0 0.11655 0", "1.570796326794897 3.141592653589793 3.141592653589793"))
    text = '<robot name="ur10e">' + "".join(f'<link name="l{i}"/>' for i in range(7))
    for i, (xyz, rpy) in enumerate(joints):
        text += (f'<joint name="j{i + 1}" type="revolute"><parent link="l{i}"/><child link="l{i + 1}"/><origin xyz="{xyz}" rpy="{rpy}"/>'
                 '<axis xyz="0 0 1"/><limit lower="-6.28" upper="6.28" velocity="2"/></joint>')
    return text + "</robot>"


class ParallelArm(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.job = BENCH.job("ur10e_pad")
        cls.result, cls.folder = BENCH.plan(cls.job, "ur10e")

    def test_the_sample_is_planned_and_the_judge_agrees(self):
        self.assertEqual(self.result.returncode, 0, self.result.stdout + self.result.stderr)
        summary = json.loads((self.folder / "summary.json").read_text(encoding="utf-8"))
        self.assertEqual((summary["points"]["skipped"], summary["gaps"]["total"]), (0, summary["gaps"]["planned"]))
        self.assertEqual([(p["controller"], p["verified"]) for p in summary["programs"]], [("linuxcnc", True), ("urscript", True)])
        status, verdict = BENCH.audit(self.folder, self.job)
        self.assertEqual((status, verdict["broken"]), (0, {}))
        verified = BENCH.run("verify", self.folder)
        self.assertEqual(verified.returncode, 0, verified.stdout + verified.stderr)

    def test_every_point_is_met_by_the_makers_table(self):
        with open(self.folder / "points.csv", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        self.assertGreaterEqual(len(rows), 20)
        for row in rows:
            place, axis = tip([float(row[f"a{i}_deg"]) for i in range(1, 7)])
            wanted = [float(row[key]) for key in ("x_mm", "y_mm", "z_mm")]
            self.assertLess(math.dist(place, wanted), 1e-6)
            self.assertLess(math.dist(axis, [float(row[key]) for key in ("tx", "ty", "tz")]), 1e-9)

    def test_a_urdf_of_the_family_is_the_same_arm(self):
        (BENCH.top / "cells/ur10e.urdf").write_text(urdf(), encoding="utf-8")
        cell = (BENCH.top / "cells/ur10e.yaml").read_text(encoding="utf-8")
        cell, count = re.subn(r"  family: .*\n(  #.*\n)?  lengths_mm: .*\n  axis_signs: .*\n  zero_offsets_deg: .*\n",
                              "  urdf: {file: ur10e.urdf, base_link: l0, flange_link: l6}\n", cell)
        self.assertEqual(count, 1)
        cell = re.sub(r"  # The maker.*\n  urscript: .*\n", "", cell)
        cell = cell.replace("linuxcnc: {}", "linuxcnc: {axis_signs: [1, 1, 1, 1, 1, 1], axis_offsets_deg: [0, 0, 0, 0, 0, 0]}")
        (BENCH.top / "cells/own.yaml").write_text(cell, encoding="utf-8")
        job = BENCH.job("ur10e_pad", [("ur10e.yaml", "own.yaml"), (r"programs: .*", "programs: [linuxcnc]"), (r"\[-800, 0, 500\], abc_deg: \[0, 90, 0\]",
                                                                   "[800, 0, 500], abc_deg: [0, -90, 0]")], "own")
        result, folder = BENCH.plan(job, "own")
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        self.assertIn("family: parallel_axes", (folder / "cell.yaml").read_text(encoding="utf-8"))
        with open(folder / "points.csv", encoding="utf-8") as file:
            for row in csv.DictReader(file):
                x, y, z = tip([float(row[f"a{i}_deg"]) for i in range(1, 7)])[0]
                self.assertLess(math.dist((-x, -y, z), [float(row[key]) for key in ("x_mm", "y_mm", "z_mm")]), 1e-6)

    def test_threads_and_another_run_give_the_same_bytes(self):
        _, other = BENCH.plan(self.job, "threads", "--threads", "3")
        self.assertEqual(differences(contents(self.folder), contents(other)), [])

    def test_urscript_is_confirmed_but_for_its_corners(self):
        stated = "confirmed but for a stated gap: the corner's path, bounded by "
        program = next((self.folder / "programs" / "urscript").iterdir())
        text = program.read_text(encoding="utf-8")
        self.assertIn("# verdict: " + stated, text)
        self.assertIn(stated, self.result.stdout)
        summary = json.loads((self.folder / "summary.json").read_text(encoding="utf-8"))
        of = {p["controller"]: p["but_for"] for p in summary["programs"]}
        self.assertIsNone(of["linuxcnc"])
        self.assertEqual(of["urscript"]["what"], "corner")
        self.assertTrue(0 <= of["urscript"]["bound_mm"] <= 0.05)
        self.assertIn("triangle", of["urscript"]["assumption"])
        for target in ((self.folder,), (program, "--cell", BENCH.top / "cells/ur10e.yaml"), (program, "--plan", self.folder)):
            verified = BENCH.run("verify", *target)
            self.assertEqual(verified.returncode, 0, verified.stdout + verified.stderr)
            self.assertIn("confirmed but for a stated gap", verified.stdout)
            self.assertRegex(verified.stdout, r"not known: the corner's path, bounded by 0\.\d+ mm")
        told = json.loads(BENCH.run("verify", program, "--plan", self.folder, "--json").stdout)["programs"][0]
        self.assertTrue(told["confirmed"])
        self.assertAlmostEqual(told["but_for"]["bound_mm"], of["urscript"]["bound_mm"], 4)

    def test_urscript_is_withheld_beyond_the_bound_that_the_cell_allows(self):
        cell = (BENCH.top / "cells/ur10e.yaml").read_text(encoding="utf-8")
        for name, section in (("silent", "{}"), ("wide", "{max_corner_mm: 0.6}")):
            changed = cell.replace("urscript: {max_corner_mm: 0.05}", "urscript: " + section)
            self.assertNotEqual(changed, cell)
            (BENCH.top / f"cells/{name}.yaml").write_text(changed, encoding="utf-8")
            result, folder = BENCH.plan(BENCH.job("ur10e_pad", [("ur10e.yaml", name + ".yaml")], name), name)
            if name == "wide":
                self.assertEqual(result.returncode, 2)
                self.assertIn("at most interference.swept_resolution_mm, 0.5 mm", result.stderr)
                continue
            self.assertEqual(result.returncode, 1, result.stdout + result.stderr)
            self.assertIn("max_corner_mm", result.stdout)
            self.assertEqual([p.name for p in (folder / "programs").iterdir()], ["linuxcnc"])
            summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
            self.assertEqual([(p["verified"], p["but_for"]) for p in summary["programs"]], [(True, None), (False, None)])

    def test_a_batch_tells_what_is_not_known_and_is_no_failure(self):
        out = BENCH.top / "batch.out"
        result = BENCH.run("batch", self.job, "--out", out)
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        stated = "urscript: confirmed but for a stated gap"
        self.assertIn(stated, result.stdout)
        self.assertIn("<system-out>" + stated, (out / "junit.xml").read_text(encoding="utf-8"))
        self.assertIn(stated, json.loads((out / "batch.json").read_text(encoding="utf-8"))["jobs"][0]["remarks"][0])

    def test_krl_and_sinumerik_are_refused_in_words(self):
        why = "tell the configurations of a spherical wrist apart"
        krl = BENCH.job("ur10e_pad", [(r"programs: .*", "programs: [krl, linuxcnc]")], "krl")
        result, folder = BENCH.plan(krl, "krl")
        self.assertEqual(result.returncode, 2)
        self.assertRegex(result.stderr, r"krl\.yaml:\d+.*programs: krl cannot program Universal Robots UR10e: .*" + why)
        self.assertFalse(folder.exists())
        cell = BENCH.top / "cells/ur10e.yaml"
        text = cell.read_text(encoding="utf-8")
        (BENCH.top / "cells/both.yaml").write_text(text + "  sinumerik: {settable_frame: 505, orientation_words: {names: [A2, B2, C2], group: orirpy}, stat_a5_positive: false}\n", encoding="utf-8")
        both = BENCH.job("ur10e_pad", [("ur10e.yaml", "both.yaml")], "both")
        result = BENCH.run("check", both)
        self.assertEqual(result.returncode, 2)
        self.assertRegex(result.stderr, r"both\.yaml:\d+.*controllers: sinumerik cannot program .*allowed: linuxcnc, urscript")

    def test_lengths_belong_to_their_family(self):
        for old, new, message in ((r", d5: 119.85", "", "arm.lengths_mm.d5: missing; required where arm.family is parallel_axes"),
                                  (r"  family: .*\n", "", "arm.lengths_mm.d5: has no effect with a spherical wrist")):
            text = (BENCH.top / "cells/ur10e.yaml").read_text(encoding="utf-8")
            changed, count = re.subn(old, new, text)
            self.assertEqual(count, 1)
            (BENCH.top / "cells/changed.yaml").write_text(changed, encoding="utf-8")
            result = BENCH.run("check", BENCH.job("ur10e_pad", [("ur10e.yaml", "changed.yaml")], "changed"))
            self.assertEqual(result.returncode, 2)
            self.assertIn(message, result.stderr)


if __name__ == "__main__":
    BENCH = Bench(*sys.argv[1:4])
    unittest.main(argv=sys.argv[:1])
