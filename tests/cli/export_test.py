#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The real millpose's export for ROS: forward kinematics of the URDF, written here, bring the exported positions to the plan's
points. Usage: export_test.py MILLPOSE TOP"""
import csv
import json
import math
import re
import shutil
import struct
import sys
import tempfile
import unittest
import xml.etree.ElementTree as ElementTree
from pathlib import Path

from cli_fixture import FEW, TOP, plan, run, tree

FILES = {"cell.urdf", "cell.srdf", "joint_trajectory.yaml", "joint_trajectory.csv"}


def product(a, b):
    return [[sum(a[i][k] * b[k][j] for k in range(4)) for j in range(4)] for i in range(4)]


def about(axis, angle):
    """Rotation about a unit vector, by Rodrigues' formula."""
    (x, y, z), c, s = axis, math.cos(angle), math.sin(angle)
    d = 1 - c
    return [[c + d * x * x, d * x * y - s * z, d * x * z + s * y, 0], [d * y * x + s * z, c + d * y * y, d * y * z - s * x, 0],
            [d * z * x - s * y, d * z * y + s * x, c + d * z * z, 0], [0, 0, 0, 1]]


def shift(by):
    return [[1, 0, 0, by[0]], [0, 1, 0, by[1]], [0, 0, 1, by[2]], [0, 0, 0, 1]]


def triple(element, name):
    return [float(word) for word in element.get(name).split()] if element is not None else [0.0] * 3


def origin(element):
    at = element.find("origin")
    roll, pitch, yaw = triple(at, "rpy")
    return product(shift(triple(at, "xyz")),
                   product(product(about((0, 0, 1), yaw), about((0, 1, 0), pitch)), about((1, 0, 0), roll)))


class Urdf:
    def __init__(self, file):
        self.robot = ElementTree.parse(file).getroot()
        self.above = {joint.find("child").get("link"): joint for joint in self.robot.findall("joint")}

    def pose(self, link, values):
        """Of a link in the root, m."""
        if link not in self.above:
            return shift((0, 0, 0))
        joint = self.above[link]
        X = product(self.pose(joint.find("parent").get("link"), values), origin(joint))
        if joint.get("type") == "fixed":
            return X
        axis, value = triple(joint.find("axis"), "xyz"), values[joint.get("name")]
        return product(X, about(axis, value) if joint.get("type") == "revolute" else shift([value * x for x in axis]))

    def place(self, link, values):
        return [row[3] for row in self.pose(link, values)[:3]]


def rows(file):
    with file.open(newline="") as opened:
        return list(csv.DictReader(opened))


def points_of(yaml):
    """(names, points) of the message: its lists and maps are as JSON has them."""
    names = re.search(r"^joint_names: \[(.*)\]$", yaml, re.M).group(1).split(", ")
    found = re.findall(r"^- positions: (\[.*\])\n  velocities: (\[.*\])\n  time_from_start: \{sec: (\d+), nanosec: (\d+)\}$", yaml, re.M)
    return names, [(json.loads(p), json.loads(v), int(s) + 1e-9 * int(n)) for p, v, s, n in found]


def turn(q):
    """A rotation from a quaternion x, y, z, w."""
    x, y, z, w = q
    return [[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w), 0],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w), 0],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y), 0], [0, 0, 0, 1]]


class Glb:
    """A reader of binary glTF 2.0: https://registry.khronos.org/glTF/specs/2.0/glTF-2.0.html, as far as it is needed."""

    def __init__(self, file):
        data = file.read_bytes()
        magic, version, length, size, kind = struct.unpack_from("<4sIII4s", data)
        assert (magic, version, length, kind) == (b"glTF", 2, len(data), b"JSON"), data[:20]
        self.json = json.loads(data[20:20 + size])
        more, kind = struct.unpack_from("<I4s", data, 20 + size)
        assert kind == b"BIN\0" and size % 4 == 0 and more % 4 == 0
        self.bytes = data[28 + size:28 + size + more]
        self.nodes = self.json["nodes"]
        self.above = {child: i for i, node in enumerate(self.nodes) for child in node.get("children", [])}
        self.number = {node["name"]: i for i, node in enumerate(self.nodes)}

    def values(self, accessor):
        of = self.json["accessors"][accessor]
        view = self.json["bufferViews"][of["bufferView"]]
        width = {"SCALAR": 1, "VEC3": 3, "VEC4": 4}[of["type"]]
        form = {5126: "f", 5125: "I"}[of["componentType"]]
        start = view.get("byteOffset", 0) + of.get("byteOffset", 0)
        assert start % 4 == 0 and start + 4 * width * of["count"] <= len(self.bytes)
        flat = struct.unpack_from(f"<{width * of['count']}{form}", self.bytes, start)
        return [flat[i:i + width] for i in range(0, len(flat), width)]

    def run(self):
        """Times, and for each node its (path, values) of the one animation."""
        (animation,) = self.json["animations"]
        times, moved = None, {}
        for channel in animation["channels"]:
            sampler = animation["samplers"][channel["sampler"]]
            assert sampler.get("interpolation", "LINEAR") == "LINEAR"
            times = [t for (t,) in self.values(sampler["input"])]
            moved[channel["target"]["node"]] = (channel["target"]["path"], self.values(sampler["output"]))
        return times, moved

    def pose(self, node, moved, at):
        of = dict(self.nodes[node])
        if node in moved:
            path, values = moved[node]
            of[path] = values[at]
        scale = of.get("scale", [1, 1, 1])
        X = product(product(shift(of.get("translation", [0, 0, 0])), turn(of.get("rotation", [0, 0, 0, 1]))),
                    [[scale[0], 0, 0, 0], [0, scale[1], 0, 0], [0, 0, scale[2], 0], [0, 0, 0, 1]])
        return product(self.pose(self.above[node], moved, at), X) if node in self.above else X

    def place(self, name, moved, at):
        """In mm with z up, as the cell has it."""
        x, y, z = (1000 * row[3] for row in self.pose(self.number[name], moved, at)[:3])
        return x, -z, y


class Exported(unittest.TestCase):
    """What holds of the export of any plan."""

    def check(self, out, ros):
        urdf, table = Urdf(ros / "cell.urdf"), rows(ros / "joint_trajectory.csv")
        names, points = points_of((ros / "joint_trajectory.yaml").read_text())
        self.assertEqual(len(points), len(table))
        planned = [row for row in rows(out / "points.csv") if row["status"] == "planned"]
        numbers = {}  # of a point in its pass -> row
        for row in rows(out / "points.csv"):
            of_pass = numbers.setdefault(int(row["pass"]), [])
            of_pass.append(row)
        limits = {joint.get("name"): joint.find("limit") for joint in urdf.robot.findall("joint") if joint.get("type") != "fixed"}
        self.assertEqual(sorted(names), sorted(limits))
        seen, before = set(), -1
        for (positions, velocities, time), row in zip(points, table):
            self.assertAlmostEqual(time, float(row["t_s"]), 8)
            self.assertGreater(time, before)
            before = time
            values = dict(zip(names, positions))
            columns = {name: next(key for key in row if key in (f"{name}_rad", f"{name}_m")) for name in names}
            for name, velocity in zip(names, velocities):
                self.assertEqual(values[name], float(row[columns[name]]))
                self.assertLessEqual(float(limits[name].get("lower")) - 1e-9, values[name])
                self.assertLessEqual(values[name], float(limits[name].get("upper")) + 1e-9)
                self.assertLessEqual(abs(velocity), (1 + 1e-6) * float(limits[name].get("velocity")))
            if row["point"]:
                of = numbers[int(row["pass"])][int(row["point"])]
                tip = urdf.place("tool_tip", values)
                # Where external axes move along a pass, points.csv has vectors of that moment too.
                for have, key in zip(tip, ("x_mm", "y_mm", "z_mm")):
                    self.assertAlmostEqual(1000 * have, float(of[key]), 5)
                seen.add((row["pass"], row["point"]))
        self.assertEqual(len(seen), len(planned))
        for end in (points[0], points[-1]):
            self.assertEqual(end[1], [0.0] * len(names))
        # Whatever a mesh is named, it is there and whole: 50 bytes a triangle.
        for mesh in urdf.robot.iter("mesh"):
            content = (ros / mesh.get("filename")).read_bytes()
            self.assertEqual(len(content), 84 + 50 * int.from_bytes(content[80:84], "little"))
        return urdf, names, points


    def check_scene(self, out, file):
        """The animation passes every planned point of points.csv in its order; times rise."""
        scene = Glb(file)
        times, moved = scene.run()
        self.assertEqual(times[0], 0)
        self.assertTrue(all(a < b for a, b in zip(times, times[1:])))
        at = 0
        for row in rows(out / "points.csv"):
            if row["status"] != "planned":
                continue
            wanted = [float(row[key]) for key in ("x_mm", "y_mm", "z_mm")]
            while math.dist(scene.place("tool_tip", moved, at), wanted) > 0.01:
                at += 1
                self.assertLess(at, len(times), row)
        for mesh in scene.json["meshes"]:
            for primitive in mesh["primitives"]:
                places = scene.values(primitive["attributes"]["POSITION"])
                of = scene.json["accessors"][primitive["attributes"]["POSITION"]]
                self.assertEqual([min(c) for c in zip(*places)], of["min"])
                self.assertEqual([max(c) for c in zip(*places)], of["max"])
                if "indices" in primitive:
                    self.assertLess(max(i for (i,) in scene.values(primitive["indices"])), len(places))
        return scene


class Pad(Exported):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.top = Path(folder.name)
        cls.out = cls.top / "out"
        result = plan(cls.out, changes=(*FEW, "programs=[]"))
        if result.returncode != 0:
            raise AssertionError(result.stdout + result.stderr)

    def setUp(self):
        self.ros = self.top / self.id()
        self.addCleanup(shutil.rmtree, self.ros, ignore_errors=True)

    def export(self, *arguments, out=None, ros=None):
        return run("export", out or self.out, "--ros", ros or self.ros, *arguments)

    def copy(self):
        folder = self.top / (self.id() + ".plan")
        shutil.copytree(self.out, folder)
        self.addCleanup(shutil.rmtree, folder)
        return folder

    def test_the_urdf_brings_every_exported_position_to_its_point(self):
        result = self.export()
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        self.assertRegex(result.stdout, r"trajectory +\d+ points, \d+\.\d+ s")
        self.assertEqual({path.name for path in self.ros.iterdir() if path.name[0] != "."}, FILES | {"meshes", "manifest.json"})
        urdf, names, points = self.check(self.out, self.ros)
        self.assertEqual(names, [f"joint_{i}" for i in range(1, 7)])
        # The flange of some of them as `stiffness` has it; the base stands in the world's origin.
        for positions, _, _ in points[:: max(1, len(points) // 5)]:
            pose = json.loads(run("stiffness", TOP / "cells/kr500_r2830.yaml", "--joints-deg", *map(math.degrees, positions),
                                  "--normal", 1, 0, 0, "--at", "flange", "--json").stdout)
            for have, wanted in zip(urdf.place("tool0", dict(zip(names, positions))), pose["origin_mm"]):
                self.assertAlmostEqual(have, wanted / 1000, 9)
        summary = json.loads((self.out / "summary.json").read_text())
        self.assertGreater(points[-1][2], 1)
        self.assertIn(f"inputs {summary['input_hash']}", (self.ros / "joint_trajectory.yaml").read_text().split("header:")[0])

    def test_the_same_again_are_the_same_bytes_and_files_of_the_user_stay(self):
        self.assertEqual(self.export().returncode, 0)
        first = tree(self.ros)
        (self.ros / "package.xml").write_text("mine")
        (self.ros / "meshes" / "old.stl").write_text("of an older export")
        self.assertEqual(self.export("--package", "my_cell").returncode, 0)
        self.assertEqual((self.ros / "package.xml").read_text(), "mine")
        self.assertIn('filename="package://my_cell/meshes/workpiece.stl"', (self.ros / "cell.urdf").read_text())
        (self.ros / "package.xml").unlink()
        self.assertEqual(self.export().returncode, 0)
        self.assertEqual(tree(self.ros), first)

    def test_the_scene_moves_the_arm_through_every_point(self):
        file = self.top / "pad.glb"
        result = run("export", self.out, "--gltf", file)
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        self.assertIn("animation    run", result.stdout)
        scene = self.check_scene(self.out, file)
        self.assertLessEqual({"workpiece", "path", "link_6", "tool_tip"}, set(scene.number))
        # At home as the URDF has it.
        self.assertEqual(self.export().returncode, 0)
        urdf, (names, points) = Urdf(self.ros / "cell.urdf"), points_of((self.ros / "joint_trajectory.yaml").read_text())
        times, moved = scene.run()
        for link in (*(f"link_{i}" for i in range(1, 7)), "tool_tip", "workpiece_frame"):
            home = urdf.place(link, dict(zip(names, points[0][0])))
            for have, wanted in zip(scene.place(link, moved, 0), home):
                self.assertAlmostEqual(have, 1000 * wanted, delta=0.01)
        again = self.top / "again.glb"
        self.assertEqual(run("export", self.out, "--gltf", again, "--ros", self.ros).returncode, 0)
        self.assertEqual(again.read_bytes(), file.read_bytes())

    def test_one_of_both_is_needed(self):
        for arguments, words in (((), "--ros FOLDER or --gltf FILE: missing"),
                                 (("--gltf", self.top / "x.glb", "--package", "a"), "--package: has no effect without --ros")):
            result = run("export", self.out, *arguments)
            self.assertEqual(result.returncode, 2, result.stdout)
            self.assertIn(words, result.stderr)
        self.assertFalse((self.top / "x.glb").exists())

    def test_a_plan_without_a_piece_writes_nothing(self):
        fast = self.top / "fast"  # no joint step is small enough at that feed
        self.addCleanup(shutil.rmtree, fast)
        result = plan(fast, changes=(*FEW, "programs=[]", "process.feed_mm_min=200000"))
        self.assertIn(result.returncode, (0, 1), result.stderr)
        result = self.export(out=fast)
        self.assertEqual(result.returncode, 1, result.stdout + result.stderr)
        self.assertEqual(result.stdout, "nothing is written: no piece was planned\n")
        self.assertFalse(self.ros.exists())

    def test_broken_plans_are_refused(self):
        for name, change, words in (
                ("plan.cbor.gz", lambda path: path.write_bytes(path.read_bytes()[:-7]), "was changed or is of another plan"),
                ("plan.cbor.gz", Path.unlink, "plan.cbor.gz"),
                ("job.yaml", lambda path: path.write_text(path.read_text() + "# more\n"), "was changed or is of another plan"),
                ("cell.yaml", Path.unlink, "cell.yaml"),
                ("manifest.json", Path.unlink, "manifest.json"),
                ("manifest.json", lambda path: path.write_text("{"), "manifest.json")):
            with self.subTest(name=name, words=words):
                folder = self.copy()
                change(folder / name)
                result = self.export(out=folder)
                self.assertEqual(result.returncode, 2, result.stdout)
                self.assertIn(words, result.stderr)
                self.assertFalse(self.ros.exists())
                self.doCleanups()

    def test_folders_that_are_not_its_own_are_refused(self):
        foreign, file, link = self.top / "foreign", self.top / "file", self.top / "link"
        foreign.mkdir(), file.write_text("x"), (foreign / "kept").write_text("kept")
        link.symlink_to(foreign)
        before = tree(self.out)
        for ros, words in ((foreign, "was not written by millpose export"), (file, "is not a folder"), (link, "was not written by"),
                           (self.out, "holds plan.cbor.gz")):
            result = self.export(ros=ros)
            self.assertEqual(result.returncode, 2, ros)
            self.assertIn(words, result.stderr)
        self.assertEqual(tree(self.out), before)
        self.assertEqual([path.name for path in foreign.iterdir()], ["kept"])
        # A link in the place of a result is replaced, what it leads to stays.
        self.assertEqual(self.export().returncode, 0)
        (self.ros / "cell.urdf").unlink()
        (self.ros / "cell.urdf").symlink_to(file)
        self.assertEqual(self.export().returncode, 0)
        self.assertEqual((file.read_text(), (self.ros / "cell.urdf").is_symlink()), ("x", False))

    def test_root_and_words(self):
        result = self.export("--root", TOP / "docs")
        self.assertEqual(result.returncode, 2)
        self.assertIn("outside", result.stderr)
        for package in ("My", "a-b", "9a", "a/b"):
            result = self.export("--package", package)
            self.assertEqual(result.returncode, 2)
            self.assertIn("--package: given", result.stderr)
        self.assertEqual(run("export", self.out).returncode, 2)


class Axes(Exported):
    """Arms on rails and parts on tables."""

    def test_external_axes_are_joints(self):
        changes = ("toolpath.stepover_mm=40", "toolpath.spacing_mm=40", "programs=[]")
        for name, kind, unit in (("irb6640_rail", "prismatic", "m"), ("irb6640_turn", "revolute", "rad")):
            with self.subTest(name), tempfile.TemporaryDirectory() as folder:
                out, ros = Path(folder, "out"), Path(folder, "ros")
                sets = [word for change in changes for word in ("--set", change)]
                result = run("plan", TOP / "toolpaths" / name / "job.yaml", "-o", out, *sets)
                self.assertIn(result.returncode, (0, 1), result.stderr)
                result = run("export", out, "--ros", ros, "--gltf", Path(folder, "run.glb"))
                self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
                self.check_scene(out, Path(folder, "run.glb"))
                urdf, names, points = self.check(out, ros)
                axis = names[-1]
                self.assertEqual(urdf.above[f"{axis}_carriage"].get("type"), kind)
                self.assertIn(f"{axis}_{unit}", (ros / "joint_trajectory.csv").read_text().split("\n")[0].split(","))
                moved = {round(positions[-1], 6) for positions, _, _ in points}
                self.assertGreater(len(moved), 1, "the axis stands still")
                self.assertIn('<group name="external_axes">', (ros / "cell.srdf").read_text())


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
