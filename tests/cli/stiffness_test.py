#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs the real millpose's stiffness, identify and flatness. Usage: stiffness_test.py MILLPOSE TOP"""
import json
import math
import os
import random
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

MILLPOSE, TOP = sys.argv[1:3]


def run(*arguments):
    return subprocess.run([MILLPOSE, *map(str, arguments)], capture_output=True, text=True, timeout=120)


def read(path):
    with open(path, encoding="utf-8") as file:
        return file.read()


def write(path, text):
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)


class Answers(unittest.TestCase):
    def assert_refused(self, words, *arguments):
        result = run(*arguments)
        self.assertEqual((result.returncode, result.stdout), (2, ""), arguments)
        self.assertIn(words, result.stderr)


HOME = ("--joints-deg", 0, -90, 90, 0, 0, 0)
POSE1 = ("--joints-deg", -4.512, -63.932, 103.263, 18.839, 53.130, 16.206)


class Stiffness(Answers):
    def test_one_pose_as_text_and_json_names_origin_and_units(self):
        text = run("stiffness", f"{TOP}/cells/chen2021_table6.yaml", *POSE1, "--axis", "tool")
        self.assertEqual(text.returncode, 0, text.stderr)
        self.assertIn("tool tip", text.stdout)
        self.assertIn("mm/N", text.stdout)
        found = json.loads(run("stiffness", f"{TOP}/cells/chen2021_table6.yaml", *POSE1, "--axis", "tool", "--json").stdout)
        self.assertEqual(found["stiffness_at"], "tool_tip")
        self.assertAlmostEqual(found["f"] * 1e4, 2.5833, 3)
        self.assertEqual((len(found["C"]), len(found["K"][0])), (6, 6))

    def test_singular_pose_is_told_without_a_stiffness_matrix(self):
        result = run("stiffness", f"{TOP}/cells/kr500_r2830.yaml", *HOME, "--normal", 1, 0, 0, "--json")
        self.assertEqual(result.returncode, 1)
        self.assertIsNone(json.loads(result.stdout)["K"])
        self.assertNotIn("NaN", result.stdout)

    def test_poses_and_map_come_as_csv(self):
        with tempfile.TemporaryDirectory() as folder:
            poses = os.path.join(folder, "poses.csv")
            write(poses, "a1_deg,a2_deg,a3_deg,a4_deg,a5_deg,a6_deg,nx,ny,nz\n0,-80,100,0,40,0,1,0,0\n5,-80,100,0,40,0,0,0,1\n")
            result = run("stiffness", f"{TOP}/cells/kr500_r2830.yaml", "--poses", poses)
            self.assertEqual(result.returncode, 0, result.stderr)
            lines = result.stdout.splitlines()
            self.assertEqual(len(lines), 3)
            self.assertEqual(len({line.count(",") for line in lines}), 1)
            out = os.path.join(folder, "map")
            result = run("stiffness", f"{TOP}/cells/kr500_r2830.yaml", "--map", "dexterity", "--plane", 1500, -500, 800, 2200,
                         -500, 800, 1500, 500, 800, "--steps", 4, 4, "--tool-axis", -1, 0, 0, "-o", out)
            self.assertEqual(result.returncode, 0, result.stderr)
            with open(out + ".csv", encoding="utf-8") as file:
                self.assertEqual(len(file.readlines()), 26)
            self.assertTrue(os.path.exists(out + ".vtk"))

    PLANE = ("--plane", 1500, -500, 800, 2200, -500, 800, 1500, 500, 800, "--steps", 3, 3, "--tool-axis", -1, 0, 0)

    def test_json_of_poses_and_maps(self):
        cell = f"{TOP}/cells/kr500_r2830.yaml"
        with tempfile.TemporaryDirectory() as folder:
            poses = os.path.join(folder, "poses.csv")
            write(poses, "a1_deg,a2_deg,a3_deg,a4_deg,a5_deg,a6_deg,nx,ny,nz\n0,-80,100,0,40,0,1,0,0\n5,-80,100,0,40,0,0,0,1\n")
            found = json.loads(run("stiffness", cell, "--poses", poses, "--json").stdout)
            one = json.loads(run("stiffness", cell, "--joints-deg", 5, -80, 100, 0, 40, 0, "--normal", 0, 0, 1, "--json").stdout)
            self.assertEqual(one.pop("schema_version"), 1)
            self.assertEqual(found["poses"][1], one)
            self.assertLess(one["singularity"]["wrist"], 1)
        drawn = json.loads(run("stiffness", cell, "--map", "lambda_n", *self.PLANE, "--json").stdout)
        self.assertEqual((drawn["unit"], len(drawn["points"])), ("mm/N", 16))
        self.assertTrue(any(point["value"] for point in drawn["points"]))

    def test_maps_know_compliances_beside_the_joints(self):
        with tempfile.TemporaryDirectory() as folder:
            with open(f"{TOP}/cells/kr500_r2830.yaml", encoding="utf-8") as file:
                text = file.read()
            self.assertIn("stiffness: {at: tool_tip, ", text)
            soft = os.path.join(folder, "soft.yaml")
            with open(soft, "w", encoding="utf-8") as file:
                file.write(text.replace("stiffness: {at: tool_tip, ", "stiffness: {at: tool_tip, compliances: [{name: platform, mount: base, "
                                        "translational_mm_N: [1.0e-4, 1.0e-4, 1.0e-4]}], ", 1))
            plain = json.loads(run("stiffness", f"{TOP}/cells/kr500_r2830.yaml", "--map", "normal_deflection", *self.PLANE, "--json").stdout)
            result = run("stiffness", soft, "--map", "normal_deflection", *self.PLANE, "--json")
            self.assertEqual(result.returncode, 0, result.stderr)
            for a, b in zip(plain["points"], json.loads(result.stdout)["points"]):
                if a["value"]:
                    self.assertAlmostEqual(b["value"] - a["value"], 1e-4, 10)

    def test_help_names_units(self):
        for command, words in (("stiffness", ("mm/N", "deg", "mm")), ("identify", ("mm", "N·m/rad")), ("flatness", ("mm",))):
            result = run(command, "--help")
            self.assertEqual(result.returncode, 0)
            for word in words:
                self.assertIn(word, result.stdout, command)

    def test_bad_poses_are_answered_by_line(self):
        cell = f"{TOP}/cells/kr500_r2830.yaml"
        head = "a1_deg,a2_deg,a3_deg,a4_deg,a5_deg,a6_deg"
        with tempfile.TemporaryDirectory() as folder:
            poses = os.path.join(folder, "poses.csv")
            for text, words in ((f"{head},nx,ny,nz\n0,-80,100,0,40,0,1,0,0\n0,-80,100,0,40,0,0,0,0\n", "poses.csv:3: nx,ny,nz: given 0 0 0"),
                                (f"{head},nx\n0,-80,100,0,40,0,1\n", "poses.csv:1: only part of nx,ny,nz"),
                                (f"{head}\n0,-80,100,0,40,9000\n", "poses.csv:2: a1_deg..a6_deg: A6 is 9000"),
                                (f"{head}\n0,-80,100,0,40,inf\n", "poses.csv:2:"),
                                (f"{head}\n", "no poses"),
                                ("a1_rad,a2_deg,a3_deg,a4_deg,a5_deg,a6_deg\n", "a1_deg")):
                write(poses, text)
                self.assert_refused(words, "stiffness", cell, "--poses", poses, "--axis", "tool")

    def test_bad_input_names_place_and_cause(self):
        cell = f"{TOP}/cells/kr500_r2830.yaml"
        for arguments, words in (
            (("stiffness", cell, *HOME), "--normal"),
            (("stiffness", cell, *HOME, "--normal", 0, 0, 0), "not all 0"),
            (("stiffness", cell, "--joints-deg", 0, -90, 90, 0, 0, "nan", "--axis", "tool"), "A6 is nan"),
            (("stiffness", cell, "--joints-deg", 0, -90, 90), "6"),
            (("stiffness", cell, "--map", "dexterity"), "--plane"),
            (("stiffness", cell, "--map", "dexterity", "--plane", 0, 0, 0, 1, 0, 0, 2, 0, 0, "--steps", 2, 2), "on a line"),
            (("stiffness", cell, "--map", "dexterity", "--plane", 0, 0, "nan", 1, 0, 0, 2, 1, 0, "--steps", 2, 2), "--plane: given nan"),
            (("stiffness", cell, "--map", "dexterity", *self.PLANE[:11], 0, 3), "--steps: given 0 3"),
            (("stiffness", cell, "--map", "dexterity", *self.PLANE[:11], 2.5, 3), "--steps"),
            (("stiffness", cell, "--map", "dexterity", *self.PLANE, "--rotation-step-deg", "nan"), "--rotation-step-deg"),
            (("stiffness", cell, "--map", "stiffnes", *self.PLANE), "lambda_n"),
            (("stiffness", cell, *HOME, "--normal", 1, 0), "3"),
            (("stiffness", cell, *HOME, "--axis", "tool", "--at", "elbow"), "tool_tip"),
            (("stiffness", cell), "one of --joints-deg"),
            (("stiffness", "missing.yaml", *HOME, "--axis", "tool"), "missing.yaml"),
        ):
            result = run(*arguments)
            self.assertEqual(result.returncode, 2, arguments)
            self.assertIn(words, result.stderr)
            self.assertEqual(result.stdout, "")


MEASUREMENTS = """millpose_measurements: 1
load_point_mm: [200, 0, 200]
measured_point_mm: [200, 0, 200]
measurements:
"""


class Identify(Answers):
    def measurements(self, folder, loads):
        """Deflections as `millpose stiffness` predicts them, at the flange for lack of a tool there."""
        path = os.path.join(folder, "m.yaml")
        text = MEASUREMENTS.replace("[200, 0, 200]", "[0, 0, 0]")
        for joints in ((0, -68.8, 85.8, -34.3, -106.9, 61.2), (-12, -70, 90, -35, 103, 67), (29, -99, 130, -17, -61, 29)):
            pose = json.loads(run("stiffness", f"{TOP}/cells/quantec_r2700.yaml", "--joints-deg", *joints, "--normal", 1, 0, 0,
                                  "--at", "flange", "--json").stdout)
            for force in loads:
                moved = [sum(pose["C"][i][j] * force[j] for j in range(3)) for i in range(3)]
                text += f"  - {{joints_deg: {list(joints)}, force_N: {list(force)}, displacement_mm: {moved}}}\n"
        write(path, text.replace("e-05", "e-5"))
        return path

    def test_refuses_numbers_for_joints_1_and_6_and_writes_the_others_into_the_cell(self):
        with tempfile.TemporaryDirectory() as folder:
            cell = os.path.join(folder, "cell.yaml")
            with open(f"{TOP}/cells/quantec_r2700.yaml", encoding="utf-8") as file:
                before = file.read()
            write(cell, before)
            path = self.measurements(folder, ((0, 0, -737.8),))
            result = run("identify", path, "--cell", cell, "--json", "--write-cell", cell)
            self.assertEqual(result.returncode, 1, result.stderr)
            joints = json.loads(result.stdout)["joints"]
            self.assertEqual([j["determined"] for j in joints], [False, True, True, True, True, False])
            self.assertIsNone(joints[0]["stiffness_Nm_per_rad"])
            self.assertIn("not observable", joints[5]["reason"])
            self.assertAlmostEqual(joints[1]["stiffness_Nm_per_rad"] / 6.78e6, 1, 6)
            with open(cell, encoding="utf-8") as file:
                after = file.read()
            (uncertainty,) = [line for line in after.splitlines() if "stiffness_uncertainty_percent" in line]
            self.assertRegex(uncertainty, r"^  stiffness_uncertainty_percent: \[10, [\d.]+, [\d.]+, [\d.]+, [\d.]+, 10\]$")
            rest = [line for line in after.splitlines() if line != uncertainty]
            changed = [(a, b) for a, b in zip(before.splitlines(), rest) if a != b]
            self.assertEqual(len(before.splitlines()), len(rest))
            self.assertTrue(all("joint_stiffness" in a for a, _ in changed), changed)
            self.assertIn("as before: A1 A6", after)

    def test_the_cell_behind_a_link_keeps_its_mode_and_line_ends(self):
        with tempfile.TemporaryDirectory() as folder:
            kept, link = os.path.join(folder, "kept"), os.path.join(folder, "cell.yaml")
            os.mkdir(kept)
            cell = os.path.join(kept, "arm.yaml")
            with open(f"{TOP}/cells/quantec_r2700.yaml", "rb") as file:
                before = b"\xef\xbb\xbf" + file.read().replace(b"\n", b"\r\n").rstrip(b"\r\n")  # as some editors leave it
            with open(cell, "wb") as file:
                file.write(before)
            os.chmod(cell, 0o640)
            os.symlink("kept/arm.yaml", link)
            path = self.measurements(folder, ((0, 0, -737.8), (737.8, 0, 0)))
            for read, written in ((link, link), (cell, link), (link, cell)):
                self.assertIn(f"{written} updated", run("identify", path, "--cell", read, "--write-cell", written).stderr)
                self.assertEqual((os.readlink(link), os.stat(cell).st_mode & 0o7777), ("kept/arm.yaml", 0o640))
                with open(cell, "rb") as file:
                    after = file.read().split(b"\r\n")
                self.assertFalse(any(b"\n" in line or b"\r" in line for line in after))
                self.assertEqual([line for line in after if b"joint_stiffness" not in line and b"uncertainty_percent" not in line],
                                 [line for line in before.split(b"\r\n") if b"joint_stiffness" not in line])
                self.assertEqual(sorted(os.listdir(kept) + os.listdir(folder)), ["arm.yaml", "cell.yaml", "kept", "m.yaml"])
            os.symlink(f"{TOP}/cells/kr500_r2830.yaml", os.path.join(folder, "other.yaml"))
            other = run("identify", path, "--cell", link, "--write-cell", os.path.join(folder, "other.yaml"))
            self.assertEqual(other.returncode, 2)
            self.assertIn("another cell than the one read", other.stderr)

    def test_readings_that_no_arm_gives_are_findings_and_leave_the_cell_alone(self):
        with tempfile.TemporaryDirectory() as folder:
            cell = os.path.join(folder, "cell.yaml")
            with open(f"{TOP}/cells/quantec_r2700.yaml", encoding="utf-8") as file:
                before = file.read()
            write(cell, before)
            path = self.measurements(folder, ((0, 0, -737.8), (737.8, 0, 0)))
            with open(path, encoding="utf-8") as file:
                good = file.read()
            self.assertIn("as expected from the stated deviation", run("identify", path, "--cell", cell).stdout)
            # Kilonewtons and metres together: the same stiffness.
            both = re.sub(r"force_N: \[(.*?)\], displacement_mm: \[(.*?)\]", lambda m: "force_N: [{}], displacement_mm: [{}]".format(
                *(", ".join(repr(float(x) / 1000) for x in group.split(",")) for group in m.groups())), good)
            write(path, both)
            result = run("identify", path, "--cell", cell, "--json", "--write-cell", cell)
            self.assertEqual(result.returncode, 1, result.stderr)
            findings = "; ".join(json.loads(result.stdout)["findings"])
            self.assertIn("largest force is 0.7378 N", findings)
            self.assertIn("largest displacement is", findings)
            self.assertIn("is unchanged", result.stderr)
            with open(cell, encoding="utf-8") as file:
                self.assertEqual(file.read(), before)
            # Two readings determine nothing, but they are two.
            lines = good.splitlines(keepends=True)
            loads = [i for i, line in enumerate(lines) if "joints_deg" in line]
            write(path, "".join(line for i, line in enumerate(lines) if i not in loads or i in (loads[0], loads[2])))
            result = run("identify", path, "--cell", cell)
            self.assertEqual(result.returncode, 1, result.stderr)
            self.assertIn("2 measurements in 2 poses", result.stdout)
            self.assertNotIn("nan", result.stdout)

    def test_readings_both_ways_give_lost_motion(self):
        def readings(step, joint=1):
            """The dial steps by `step` mm when the joint comes from the other side."""
            return (f"millpose_measurements: 1\nmeasured_point_mm: [-250, 0, 250]\ntwo_way:\n"
                    f"  - {{joint: {joint}, joints_deg: [0, -60, 80, 0, 60, 0], direction: [0, -1, 0],\n"
                    f"     from_below_mm: [0.011, 0.012, 0.013], from_above_mm: [{0.011 + step}, {0.012 + step}, {0.013 + step}]}}\n")

        def found(cell, step):
            write(path, readings(step))
            result = run("identify", path, "--cell", cell, "--json")
            self.assertEqual(result.returncode, 0, result.stderr)
            return json.loads(result.stdout)["lost_motion"][0]

        with tempfile.TemporaryDirectory() as folder:
            path, cell = os.path.join(folder, "m.yaml"), os.path.join(folder, "cell.yaml")
            with open(f"{TOP}/cells/kr500_r2830.yaml", encoding="utf-8") as file:
                write(cell, file.read())
            joint = found(cell, 0.17)
            self.assertTrue(joint["determined"])
            self.assertAlmostEqual(joint["half_difference_mm"], 0.085, 9)
            self.assertLess(joint["lower_95_arcmin"], joint["lost_motion_arcmin"])
            self.assertLess(joint["lost_motion_arcmin"], joint["upper_95_arcmin"])
            self.assertAlmostEqual(found(cell, 0.34)["lost_motion_arcmin"] / joint["lost_motion_arcmin"], 2, 9)
            radius = 0.17 / (joint["lost_motion_arcmin"] / 60 * math.pi / 180)
            self.assertTrue(500 < radius < 4000, radius)
            write(path, readings(0.17))
            result = run("identify", path, "--cell", cell, "--write-cell", cell)
            self.assertEqual(result.returncode, 0, result.stderr)
            with open(cell, encoding="utf-8") as file:
                after = file.read()
            self.assertRegex(after, rf"lost_motion_arcmin: \[{joint['lost_motion_arcmin']:.3g}, 0.3, 0.3, 0.3, 0.3, 0.3\]")
            self.assertIn("millpose identify m.yaml, but as before", after)
            self.assertEqual(run("identify", path, "--cell", cell).returncode, 0)
            # The readings exchanged, of too few, of a cell that states none.
            write(path, readings(-0.17))
            result = run("identify", path, "--cell", cell)
            self.assertEqual(result.returncode, 1)
            self.assertIn("wrong sign", result.stdout)
            write(path, readings(0.17).replace(", 0.013]", "]").replace("[0.011, 0.012", "[0.011"))
            self.assertIn("too few readings", run("identify", path, "--cell", cell).stdout)
            write(path, readings(0.17).replace("from_above_mm", "pushed_along_mm"))
            self.assert_refused("pushed_along_mm: has no effect without push_N", "identify", path, "--cell", cell)
            small = os.path.join(folder, "small.yaml")
            with open(f"{TOP}/cells/ur10e.yaml", encoding="utf-8") as file:
                write(small, file.read())
            write(path, readings(0.17))
            self.assert_refused("no number for A2 A3 A4 A5 A6, and the cell states none", "identify", path, "--cell", small, "--write-cell", small)

    def test_bad_csv_measurements_are_answered_by_line(self):
        head = "a1_deg,a2_deg,a3_deg,a4_deg,a5_deg,a6_deg,fx_N,fy_N,fz_N,dx_mm,dy_mm,dz_mm"
        cell = f"{TOP}/cells/quantec_r2700.yaml"
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "m.csv")
            for text, words in ((f"{head}\n0,1,2,3,4,5,0,0,0,0,0,1\n", "m.csv:2: no load"),
                                (f"{head},mx_Nm\n0,1,2,3,4,5,0,0,9,0,0,1,7\n", "m.csv:1: only part of mx_Nm"),
                                (f"{head}\n0,1,2,3,4,5e4,0,0,9,0,0,1\n", "a6_deg: given 50000"),
                                (f"{head}\n0,1,2,3,4,5,0,0,nan,0,0,1\n", "m.csv:2:"),
                                (f"{head}\n0,1,2,3,4,5,0,0,9,0,0\n", "m.csv:2")):
                write(path, text)
                self.assert_refused(words, "identify", path, "--cell", cell)
            write(path, f"{head}\n0,1,2,3,4,5,0,0,9,0,0,1\n")
            self.assert_refused("--load-point-mm: given 0 inf 0", "identify", path, "--cell", cell, "--load-point-mm", 0, "inf", 0)

    def test_proposes_load_cases_that_show_every_joint(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "m.yaml")
            text = MEASUREMENTS.replace("\nmeasurements:", "\ncandidates:")
            for joints in ((0, -68.8, 85.8, -34.3, -106.9, 61.2), (-12, -70, 90, -35, 103, 67)):
                for force in ((0, 0, -700), (700, 0, 0), (0, 700, 0)):
                    text += f"  - {{joints_deg: {list(joints)}, force_N: {list(force)}}}\n"
            write(path, text)
            result = run("identify", path, "--cell", f"{TOP}/cells/quantec_r2700.yaml", "--propose", 3, "--json")
            self.assertEqual(result.returncode, 0, result.stderr)
            found = json.loads(result.stdout)
            self.assertEqual((len(found["chosen"]), found["not_observable"]), (3, []))
            self.assertGreater(found["condition"], 1)
            write(path, text.replace("[200, 0, 200]", "[0, 0, 0]").replace("[700, 0, 0]", "[0, 0, 700]").replace("[0, 700, 0]", "[0, 0, 500]"))
            result = run("identify", path, "--cell", f"{TOP}/cells/quantec_r2700.yaml", "--propose", 0)
            self.assertEqual(result.returncode, 1, result.stderr)
            self.assertIn("A1 is not observable", result.stdout)
            self.assertIn("A6 is not observable", result.stdout)

    def test_bad_measurements_are_answered_by_place(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "m.yaml")
            write(path, MEASUREMENTS + "  - {joints_deg: [0, 1, 2], force_N: [0, 0, 1], displacement: [0, 0, 1]}\n")
            result = run("identify", path, "--cell", f"{TOP}/cells/quantec_r2700.yaml")
            self.assertEqual(result.returncode, 2)
            self.assertIn("m.yaml:5:", result.stderr)
            self.assertIn("displacement_mm", result.stderr)


class Geometry(Answers):
    """Readings of an arm that was drawn here, with kinematics of this test's own."""
    CELL = f"{TOP}/cells/quantec_r2700.yaml"
    LENGTHS = (675, 350, 1150, 1200, -41, 215)  # d1, a1, a2, d4, dz, d6
    SIGNS = (-1, 1, 1, -1, 1, -1)

    @staticmethod
    def times(a, b):
        return [[sum(a[i][k] * b[k][j] for k in range(4)) for j in range(4)] for i in range(4)]

    @classmethod
    def pose(cls, shift, turns=()):
        m = [[float(i == j) for j in range(4)] for i in range(4)]
        for i in range(3):
            m[i][3] = shift[i]
        for axis, angle in turns:
            c, s, r = math.cos(angle), math.sin(angle), [[float(i == j) for j in range(4)] for i in range(4)]
            p, q = (axis + 1) % 3, (axis + 2) % 3
            r[p][p], r[q][q], r[p][q], r[q][p] = c, c, -s, s
            m = cls.times(m, r)
        return m

    def reading(self, degrees, deviations, reflector, tracker=None):
        d1, a1, a2, d4, dz, d6 = self.LENGTHS
        q = [math.radians(s * d) for s, d in zip(self.SIGNS, degrees)]
        own = [self.pose(shift, enumerate(turn)) for shift, turn in deviations]
        X = own[0]
        for frame, step in enumerate((self.pose((0, 0, d1), [(2, q[0])]), self.pose((a1, 0, 0), [(1, q[1])]),
                                      self.pose((a2, 0, 0), [(1, q[2])]), self.pose((d4, 0, dz), [(0, q[3])]),
                                      self.pose((0, 0, 0), [(1, q[4])]),
                                      self.times(self.pose((0, 0, 0), [(0, q[5])]), self.pose((d6, 0, 0), [(1, math.pi / 2)]))), 1):
            X = self.times(self.times(X, step), own[frame])
        X = self.times(tracker or self.pose((3000, -800, 400), [(2, 1.9), (0, 0.2)]), X)
        return [sum(X[i][k] * reflector[k] for k in range(3)) + X[i][3] for i in range(3)]

    def readings(self, path, poses, seed, noise, deviations, share=0):
        """`share` of A2's angle that A3 turns by beside its own."""
        draw = random.Random(seed)
        lines = ["a1_deg,a2_deg,a3_deg,a4_deg,a5_deg,a6_deg,x_mm,y_mm,z_mm"]
        for _ in range(poses):
            degrees = [draw.uniform(*limits) for limits in ((-60, 60), (-110, -30), (40, 120), (-150, 150), (20, 100), (-150, 150))]
            turned = degrees[:2] + [degrees[2] + share * degrees[1]] + degrees[3:]
            place = [x + draw.gauss(0, noise) for x in self.reading(turned, deviations, (70, -30, 190))]
            lines.append(",".join(f"{v:.9f}" for v in degrees + place))
        write(path, "\n".join(lines) + "\n")

    def drawn(self, seed):
        draw = random.Random(seed)
        return [([draw.gauss(0, 0.4) * (0 < frame < 6) for _ in range(3)], [draw.gauss(0, 8e-4) * (0 < frame < 6) for _ in range(3)])
                for frame in range(7)]

    def test_finds_what_was_drawn_and_writes_it(self):
        with tempfile.TemporaryDirectory() as folder:
            seen, other, cell = (os.path.join(folder, name) for name in ("seen.csv", "other.csv", "cell.yaml"))
            shutil.copy(self.CELL, cell)
            deviations = self.drawn(1)
            self.readings(seen, 60, 2, 0.03, deviations)
            self.readings(other, 200, 3, 0.03, deviations)
            before = read(cell)
            result = run("identify", seen, "--geometry", "--cell", cell, "--foretell", other, "--propose", 3, "--json", "--write-cell", cell,
                         "--serial", "882134", "--date", "2026-11-26")
            self.assertEqual(result.returncode, 0, result.stderr)
            found = json.loads(result.stdout)
            self.assertGreater(found["nominal_rms_mm"], 0.3)
            self.assertLess(found["rms_mm"], 0.06)
            self.assertAlmostEqual(found["coordinate_deviation_mm"], 0.03, delta=0.006)
            (foretold,) = found["foretold"]
            self.assertLess(foretold["rms_mm"], 0.08)
            self.assertGreater(foretold["covered"], 0.9)
            self.assertLess(2 * foretold["median_half_width_mm"], 1.5 * 2 * foretold["error_95_mm"])
            self.assertEqual([len(q) for q in found["proposed_deg"]], [6, 6, 6])
            inside = [abs(one["value"] - (deviations[one["frame"]][0] + [1e3 * t for t in deviations[one["frame"]][1]])[i % 6]) <= 1.5 * one["half_width_95"]
                      for i, one in enumerate(found["deviations"]) if one["told"]]
            self.assertGreater(len(inside), 8)
            self.assertGreaterEqual(sum(inside), len(inside) - 1)
            after = read(cell)
            self.assertIn('serial: "882134"', after)
            self.assertIn('date: "2026-11-26"', after)
            self.assertEqual([line for line in after.splitlines() if "deviations:" not in line and "serial:" not in line], before.splitlines())
            self.assertEqual(run("check", cell).returncode, run("check", self.CELL).returncode)
            # The same bytes, and again from what was written: the prior is the sheet, so nothing is added up.
            again = run("identify", seen, "--geometry", "--cell", cell, "--foretell", other, "--propose", 3, "--json")
            self.assertEqual(again.stdout, result.stdout)

    def test_finds_a_joint_that_turns_with_another(self):
        with tempfile.TemporaryDirectory() as folder:
            seen, other, cell = (os.path.join(folder, name) for name in ("seen.csv", "other.csv", "cell.yaml"))
            shutil.copy(self.CELL, cell)
            deviations, share = self.drawn(4), 6e-4
            self.readings(seen, 60, 5, 0.03, deviations, share)
            self.readings(other, 200, 6, 0.03, deviations, share)
            result = run("identify", seen, "--geometry", "--cell", cell, "--foretell", other, "--json", "--write-cell", cell,
                         "--serial", "882134", "--date", "2026-11-26")
            self.assertEqual(result.returncode, 0, result.stderr)
            found = json.loads(result.stdout)
            models = found["couplings"]
            (one,) = models["tried"][models["chosen"]]["couplings"]
            self.assertEqual(one["joints"], "A3 with A2")
            self.assertLess(abs(one["factor"] - share), 1.5 * one["half_width_95"])
            self.assertLess(one["half_width_95"], 0.5 * share)
            self.assertLess(found["foretold"][0]["rms_mm"], 0.08)
            self.assertIn("couplings: [{", read(cell))
            self.assertIn("factors: [", read(cell))
            # What is known now is not looked for again, and the readings are taken at the angles that it makes.
            again = run("identify", seen, "--geometry", "--cell", cell, "--foretell", other, "--json", "--serial", "882134")
            self.assertEqual(again.returncode, 0, again.stderr)
            self.assertEqual(json.loads(again.stdout)["couplings"]["chosen"], 0)
            self.assertLess(json.loads(again.stdout)["foretold"][0]["rms_mm"], 0.08)

    def test_readings_of_another_arm_are_findings_and_leave_the_cell_alone(self):
        with tempfile.TemporaryDirectory() as folder:
            path, cell = os.path.join(folder, "seen.csv"), os.path.join(folder, "cell.yaml")
            self.readings(path, 60, 2, 0.03, self.drawn(1))
            for name, text in (("another arm", read(f"{TOP}/cells/kr500_r2830.yaml")), ("a longer forearm", self.longer(read(self.CELL)))):
                write(cell, text)
                result = run("identify", path, "--geometry", "--cell", cell, "--write-cell", cell, "--serial", "1", "--date", "2026-11-26", "--json")
                self.assertEqual(result.returncode, 1, (name, result.stderr))
                self.assertTrue(json.loads(result.stdout)["findings"], name)
                self.assertIn("is unchanged", result.stderr)
                self.assertEqual(read(cell), text)
            self.assertIn("\nfinding    ", run("identify", path, "--geometry", "--cell", cell).stdout)

    @staticmethod
    def longer(cell):
        """The sheet with a forearm 80 mm longer."""
        changed, count = re.subn(r"(lengths_mm: \{[^}]*d4: )1200", r"\g<1>1280", cell)
        assert count == 1
        return changed

    def test_words_and_errors(self):
        with tempfile.TemporaryDirectory() as folder:
            path, cell = os.path.join(folder, "seen.csv"), os.path.join(folder, "cell.yaml")
            shutil.copy(self.CELL, cell)
            self.readings(path, 30, 4, 0.03, self.drawn(5))
            result = run("identify", path, "--geometry", "--cell", cell)
            self.assertEqual(result.returncode, 0, result.stderr)
            for words in ("mm RMS", "not told", "mrad", "condition number"):
                self.assertIn(words, result.stdout)
            for words, *arguments in (("--cell: missing", path, "--geometry"),
                                      ("--serial: missing", path, "--geometry", "--cell", cell, "--write-cell", cell),
                                      ("--date: missing", path, "--geometry", "--cell", cell, "--write-cell", cell, "--serial", "1"),
                                      ("allowed: a date such as", path, "--geometry", "--cell", cell, "--write-cell", cell, "--serial", "1", "--date", "today"),
                                      ("--propose: given 0", path, "--geometry", "--cell", cell, "--propose", 0),
                                      ("have no effect with it", path, "--geometry", "--cell", cell, "--robust"),
                                      ("has no stiffness.gravity", path, "--geometry", "--cell", cell, "--weight"),
                                      ("another cell than the one read", path, "--geometry", "--cell", cell, "--write-cell", self.CELL)):
                self.assert_refused(words, "identify", *arguments)
            self.assertEqual(read(cell), read(self.CELL))
            head = "a1_deg,a2_deg,a3_deg,a4_deg,a5_deg,a6_deg"
            for text, words in ((f"{head}\n0,1,2,3,4,5\n", "no reflector"), (f"{head},x_mm,y_mm\n0,1,2,3,4,5,1,2\n", "only part of x_mm"),
                                (f"{head},x_mm,y_mm,z_mm\n0,1,2,3,4,5e4,1,2,3\n", "a6_deg: given 50000"),
                                (f"{head},x_mm,y_mm,z_mm\n" + "0,1,2,3,4,5,1,2,3\n" * 3, "readings; needed: more than 3")):
                write(path, text)
                self.assert_refused(words, "identify", path, "--geometry", "--cell", cell)


class Compliances(Answers):
    """Readings under load of arms whose links tilt, by differences of the kinematics above."""
    POINT = (-120, 90, 260)
    STIFFNESS = (8.9e9, 6.8e9, 1.1e10, 2e9, 1.6e9, 1.3e9)  # N*mm/rad
    UNMOVED = [([0, 0, 0], [0, 0, 0])] * 7

    def place(self, degrees, frame=0, turn=(0, 0, 0)):
        deviations = list(self.UNMOVED)
        deviations[frame] = ([0, 0, 0], list(turn))
        return Geometry.reading(Geometry, degrees, deviations, self.POINT, Geometry.pose((0, 0, 0)))

    def ways(self, degrees):
        """mm/rad: of the six joints, of link 3's tilting about x and z."""
        def difference(low, high, step):
            return [(b - a) / (2 * step) for a, b in zip(low, high)]
        ways = []
        for joint in range(6):
            low, high = (self.place([d + side * 1e-3 * (i == joint) for i, d in enumerate(degrees)]) for side in (-1, 1))
            ways.append(difference(low, high, math.radians(1e-3)))
        for axis in (0, 2):
            low, high = (self.place(degrees, 3, [side * 1e-5 * (i == axis) for i in range(3)]) for side in (-1, 1))
            ways.append(difference(low, high, 1e-5))
        return ways

    def readings(self, path, tilt, payload=0.0, seed=1):
        draw = random.Random(seed)
        lines = ["a1_deg,a2_deg,a3_deg,a4_deg,a5_deg,a6_deg,fx_N,fy_N,fz_N,dx_mm,dy_mm,dz_mm"]
        for _ in range(40):
            degrees = [draw.uniform(*limits) for limits in ((-60, 60), (-110, -30), (40, 120), (-150, 150), (20, 100), (-150, 150))]
            force = [draw.gauss(0, 400) for _ in range(3)]
            acting = [force[0], force[1], force[2] - payload]
            moved = [draw.gauss(0, 0.005) for _ in range(3)]
            for way, compliance in zip(self.ways(degrees), [1 / k for k in self.STIFFNESS] + list(tilt)):
                torque = sum(w * f for w, f in zip(way, acting))
                moved = [m + compliance * torque * w for m, w in zip(moved, way)]
            lines.append(",".join(f"{v:.9f}" for v in degrees + force + moved))
        write(path, "\n".join(lines) + "\n")

    def identify(self, folder, *words, **drawn):
        path, cell = os.path.join(folder, "m.csv"), os.path.join(folder, "cell.yaml")
        shutil.copy(Geometry.CELL, cell)
        self.readings(path, **drawn)
        point = ["--load-point-mm", *self.POINT, "--measured-point-mm", *self.POINT]
        return run("identify", path, "--cell", cell, *point, *words), cell

    def test_a_link_that_tilts_is_found_and_written(self):
        with tempfile.TemporaryDirectory() as folder:
            cell = os.path.join(folder, "cell.yaml")
            result, _ = self.identify(folder, "--json", "--write-cell", cell, tilt=(8e-10, 5e-10))
            self.assertEqual(result.returncode, 0, result.stderr)
            found = json.loads(result.stdout)
            models = found["models"]
            chosen = models["tried"][models["chosen"]]
            self.assertEqual(chosen["beside_springs"], ["tilting of link 3"])
            self.assertLess(chosen["left_out_rms_mm"], 0.5 * models["tried"][0]["left_out_rms_mm"])
            self.assertEqual([one["unknowns"] for one in models["tried"]], sorted(one["unknowns"] for one in models["tried"]))
            for joint, truth in zip(found["joints"][:3], self.STIFFNESS):  # the wrist's give is as small as the noise
                self.assertAlmostEqual(joint["stiffness_Nm_per_rad"] * 1e3 / truth, 1, delta=0.03)
            # About x link 3 does nearly as A4, so only their sum is known well.
            for one, axis, truth, share in zip(found["compliances"], "xz", (8e-7, 5e-7), (0.3, 0.03)):
                self.assertEqual(one["what"], f"link 3 about {axis}")
                self.assertAlmostEqual(one["compliance"] / truth, 1, delta=share)
                self.assertLess(one["lower_95"], one["compliance"])
            self.assertIsNone(found["payload"])
            after = read(cell)
            self.assertRegex(after, r'name: "?identified tilting of link 3, 95 %: x [0-9.]+e-07 to [0-9.]+e-07, z [0-9.]+e-07 to')
            self.assertIn("rotational_rad_Nm", after)
            self.assertEqual(run("check", cell).returncode, run("check", Geometry.CELL).returncode)
            springs, _ = self.identify(folder, "--springs", "--json", tilt=(8e-10, 5e-10))
            self.assertEqual(json.loads(springs.stdout)["compliances"], [])

    def test_a_payload_is_found_and_not_written(self):
        with tempfile.TemporaryDirectory() as folder:
            cell = os.path.join(folder, "cell.yaml")
            result, _ = self.identify(folder, "--write-cell", cell, tilt=(0, 0), payload=150.0)
            self.assertEqual(result.returncode, 0, result.stderr)
            self.assertRegex(result.stdout, r"payload +weighs +1[45]\d ")
            self.assertIn("+ a payload  <- chosen", result.stdout)
            self.assertIn("not written: the payload", result.stderr)
            self.assertNotIn("compliances", read(cell))


class Flatness(unittest.TestCase):
    def test_figures_of_a_known_body(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "p.csv")
            write(path, "x_mm,y_mm,z_mm\n1,1,1\n1,-1,-1\n-1,1,-1\n-1,-1,1\n")
            found = json.loads(run("flatness", path, "--json").stdout)
            self.assertAlmostEqual(found["minimum_zone_mm"], 2)
            write(path, "x_mm,y_mm,z_mm\n1,1,1\n2,2,2\n3,3,x\n")
            result = run("flatness", path)
            self.assertEqual(result.returncode, 2)
            self.assertIn("p.csv:4:5: z_mm: given \"x\"", result.stderr)
            write(path, "x_mm,y_mm,z_mm\n1,1,1\n2,2,1e300\n3,3,2\n")
            result = run("flatness", path)
            self.assertEqual(result.returncode, 2)
            self.assertIn("p.csv:3: a point beyond a kilometre", result.stderr)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
