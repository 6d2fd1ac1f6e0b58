#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Cells made to be hard, each with its known answer, planned from the outside and judged.

Usage: adversarial_test.py MILLPOSE MILLPOSE_AUDIT TOP [TEST…]. MILLPOSE_JUDGE_TRAVEL_MM: travel between the judge's poses.
"""
import csv
import json
import math
import os
import pathlib
import re
import sys
import unittest

from plan_fixture import Bench, WITHOUT_FORCE

BENCH = None
TRAVEL_MM = os.environ.get("MILLPOSE_JUDGE_TRAVEL_MM", "10")
# Rotations are searched as finely as the sample says only where the judge looks finely.
COARSE = [] if "MILLPOSE_JUDGE_TRAVEL_MM" in os.environ else [(r"rotation_step_deg: 1\n", "rotation_step_deg: 5\n")]
FEW_POINTS = [(r"stepover_mm: [\d.]+", "stepover_mm: 40"), (r"spacing_mm: [\d.]+", "spacing_mm: 20")]

LAYERS = [(r", depth_mm: 1", ""), (r"spacing_mm: [\d.]+", "spacing_mm: 8\n  depth: {total_mm: 2, per_layer_mm: 1}")]


def box(name, size, xyz, kind="fixture"):
    """A body of the cell that stands in the world."""
    return (f"  - {{name: {name}, class: {kind}, mount: world, shape: {{box: {{size_mm: {list(size)}}}}}, "
            f"pose: {{xyz_mm: {list(xyz)}}}}}\n")


def stl(triangles):
    """Triangles, counter-clockwise from outside, as ASCII STL."""
    corners = ["".join(f"vertex {x:.9g} {y:.9g} {z:.9g}\n" for x, y, z in t) for t in triangles]
    return "solid s\n" + "".join(f"facet normal 0 0 0\nouter loop\n{c}endloop\nendfacet\n" for c in corners) + "endsolid s\n"


def quad(a, b, c, d):
    return [(a, b, c), (a, c, d)]


def block(lower, upper):
    (x0, y0, z0), (x1, y1, z1) = lower, upper
    p = [(x, y, z) for z in (z0, z1) for y in (y0, y1) for x in (x0, x1)]
    return (quad(p[0], p[2], p[3], p[1]) + quad(p[4], p[5], p[7], p[6]) + quad(p[0], p[1], p[5], p[4]) +
            quad(p[2], p[6], p[7], p[3]) + quad(p[0], p[4], p[6], p[2]) + quad(p[1], p[3], p[7], p[5]))


def bored_block(half, radius, depth, sides=32):
    """A square block, its top at z = 0, with a blind bore of that depth about z."""
    bottom = -depth - 20
    ring = [(radius * math.cos(2 * math.pi * i / sides), radius * math.sin(2 * math.pi * i / sides)) for i in range(sides)]

    def outer(x, y):  # the ring's point pushed out to the square
        scale = half / max(abs(x), abs(y))
        return x * scale, y * scale

    triangles = []
    for i in range(sides):
        (ax, ay), (bx, by) = ring[i], ring[(i + 1) % sides]
        (cx, cy), (dx, dy) = outer(ax, ay), outer(bx, by)
        triangles += quad((ax, ay, 0), (cx, cy, 0), (dx, dy, 0), (bx, by, 0))          # top
        triangles += quad((ax, ay, -depth), (ax, ay, 0), (bx, by, 0), (bx, by, -depth))  # the bore's wall
        triangles.append(((0, 0, -depth), (ax, ay, -depth), (bx, by, -depth)))           # its bottom
        triangles += quad((cx, cy, bottom), (dx, dy, bottom), (dx, dy, 0), (cx, cy, 0))  # outside
        triangles.append(((0, 0, bottom), (dx, dy, bottom), (cx, cy, bottom)))           # below
    return triangles


def ribbon(points, normals):
    """A sheet through points, 20 mm to either side."""
    edges = []
    for t, normal in enumerate(normals):
        a, b = points[max(t - 1, 0)], points[min(t + 1, len(points) - 1)]
        d = [y - x for x, y in zip(a, b)]
        across = [normal[1] * d[2] - normal[2] * d[1], normal[2] * d[0] - normal[0] * d[2], normal[0] * d[1] - normal[1] * d[0]]
        scale = 20 / math.hypot(*across)
        edges.append([[p + side * scale * c for p, c in zip(points[t], across)] for side in (-1, 1)])
    triangles = []
    for t in range(len(points) - 1):
        triangles += quad(points[t], points[t + 1], edges[t + 1][1], edges[t][1])
        triangles += quad(edges[t][0], edges[t + 1][0], points[t + 1], points[t])
    return triangles


def tool_pose(angles):
    """Tip and tool axis of the KR 500 R2830 with its spindle at angles (KUKA's, degrees): the formula of docs/kinematics.md."""
    q = [math.radians(sign * angle) for sign, angle in zip((-1, 1, 1, -1, 1, -1), angles)]
    tip, axis = [-250.0, 0.0, 250.0], [1.0, 0.0, 0.0]  # in the flange

    def turn(vector, about, angle):
        i, j = {"x": (1, 2), "y": (2, 0), "z": (0, 1)}[about]
        a, b = vector[i], vector[j]
        vector[i], vector[j] = a * math.cos(angle) - b * math.sin(angle), a * math.sin(angle) + b * math.cos(angle)

    steps = [("y", math.pi / 2), (290, 0, 0), ("x", q[5]), ("y", q[4]), ("x", q[3]), (1025, 0, -55), ("y", q[2]), (1300, 0, 0),
             ("y", q[1]), (500, 0, 0), ("z", q[0]), (0, 0, 1045)]
    for step in steps:
        if len(step) == 2:
            turn(tip, *step)
            turn(axis, *step)
        else:
            tip = [a + b for a, b in zip(tip, step)]
    return tip, axis


class Adversarial(unittest.TestCase):
    def plan(self, name, bodies="", changes=(), mesh=None, cell_changes=(), status=0, layers=False):
        """Plans a changed support_pad; returns (summary, rows of points.csv, text), judged clean. `layers`: two, with the job's
        cutting force."""
        cell = (BENCH.top / "cells/kr500_r2830.yaml").read_text(encoding="utf-8").replace(
            "excluded_pairs: []", bodies + "excluded_pairs: []")
        for old, new in cell_changes:
            self.assertEqual(cell.count(old), 1, old)
            cell = cell.replace(old, new)
        (BENCH.top / f"cells/{name}.yaml").write_text(cell, encoding="utf-8")
        if mesh:
            (BENCH.top / f"toolpaths/support_pad/{name}.stl").write_text(stl(mesh), encoding="utf-8")
            changes = [(r"mesh: support_pad.stl", f"mesh: {name}.stl"), *changes]
        job = BENCH.job("support_pad", [*(LAYERS if layers else WITHOUT_FORCE), *COARSE, (r"name: support_pad\n", f"name: {name}\n"),
                                        (r"kr500_r2830.yaml", f"{name}.yaml"), *changes], name)
        result, folder = BENCH.plan(job, name, "--threads", "2")
        self.assertEqual(result.returncode, status, result.stdout + result.stderr)
        judged, verdict = BENCH.audit(folder, job, "--travel-mm", TRAVEL_MM)
        self.assertEqual((judged, verdict["broken"]), (0, {}))
        with open(folder / "points.csv", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        return json.loads((folder / "summary.json").read_text(encoding="utf-8")), rows, result.stdout + result.stderr

    def window(self, close=False):
        """A wall across x = 1800 mm with a window 900 mm wide and from 500 to 1900 mm high, before the pad at 1006."""
        bodies = box("left", (20, 1050, 3000), (1800, 975, 1500)) + box("right", (20, 1050, 3000), (1800, -975, 1500))
        bodies += box("over", (20, 900, 1100), (1800, 0, 2450)) + box("under", (20, 900, 500), (1800, 0, 250))
        return bodies + (box("shutter", (20, 900, 1400), (1800, 0, 1200)) if close else "")

    def test_reaches_through_a_window_frame_and_not_through_a_closed_one(self):
        home = [("home_deg: [0, -90, 90, 0, 0, 0]", "home_deg: [0, -120, 130, 0, 0, 0]")]
        summary, rows, _ = self.plan("window", self.window(), FEW_POINTS, cell_changes=home)
        self.assertEqual(summary["points"]["skipped"], 0)
        self.assertEqual(summary["gaps"]["planned"], summary["gaps"]["total"])
        self.assertLess(min(float(row["clearance_mm"]) for row in rows), 50)  # told up to 50 mm
        summary, _, _ = self.plan("shutter", self.window(close=True), FEW_POINTS, cell_changes=home, status=1)
        self.assertEqual(summary["points"]["planned"], 0)
        self.assertEqual({entry["reason"] for entry in summary["skipped"]}, {"interference"})
        self.assertTrue(all("shutter" in entry["detail"] for entry in summary["skipped"]))

    def bore(self, depth, status):
        """A short line on the bottom of a bore of 36 mm diameter; the cutter is 20 mm thick, 60 mm long."""
        curve = (r"strategy: parallel_planes\n  region: .*\n  planes: .*\n",
                 f"strategy: curve\n  curve: {{points_mm: [[-2, 0, {-depth}], [2, 0, {-depth}]], project_along: [0, 0, -1]}}\n")
        return self.plan(f"bore_{depth}", changes=[curve], mesh=bored_block(100, 18, depth), status=status)

    def test_the_holder_touches_in_a_bore_deeper_than_the_cutter(self):
        summary, _, _ = self.bore(50, 0)  # 10 mm of air between holder and part
        self.assertEqual(summary["points"]["skipped"], 0)
        summary, _, _ = self.bore(70, 1)
        self.assertEqual(summary["points"]["planned"], 0)
        self.assertEqual({entry["reason"] for entry in summary["skipped"]}, {"interference"})
        self.assertTrue(all("holder" in entry["detail"] and "workpiece" in entry["detail"] for entry in summary["skipped"]))

    def test_a_wall_across_every_straight_gap_is_gone_round(self):
        """A plate with three passes 260 mm apart; between them fins of 160 mm stand out of it."""
        plate = block((-60, -390, -20), (60, 390, 0))
        fins = "".join(box(f"fin_{side}", (160, 4, 160), (1900, y, 1006)) for side, y in (("left", 130), ("right", -130)))
        changes = [(r"stepover_mm: [\d.]+", "stepover_mm: 260"), (r"spacing_mm: [\d.]+", "spacing_mm: 30"),
                   (r"xyz_mm: \[2076, 0, 1006\]", "xyz_mm: [2000, 0, 1006]")]

        def gap_motions(name, *arguments):
            summary, _, _ = self.plan(name, *arguments, mesh=plate)
            self.assertEqual(summary["points"]["skipped"], 0)
            self.assertEqual((summary["passes"], summary["gaps"]["planned"], summary["gaps"]["total"]), (3, 4, 4))
            program = (BENCH.top / name / f"programs/linuxcnc/{name}.ngc").read_text(encoding="utf-8")
            return sum(line.startswith("G0") for line in program.splitlines())

        self.assertGreater(gap_motions("fins", fins, changes), gap_motions("no_fins", "", changes))

    def test_a_path_through_the_wrist_singularity_is_broken_there(self):
        """A course of A5 from 6° to −6°; the first three joints are held near it, so that no rotation leads round."""
        home = [2000.0, 0.0, 1000.0]
        course = [tool_pose([-4.5, -63.9, 103.3, 18.8, 6 - 0.4 * t, 16.2]) for t in range(31)]
        tips = [[a - b for a, b in zip(tip, home)] for tip, _ in course]
        text = "".join(",".join(f"{value:.12g}" for value in (*tip, *axis)) + "\n" for tip, (_, axis) in zip(tips, course))
        (BENCH.top / "toolpaths/support_pad/course.csv").write_text("x_mm,y_mm,z_mm,i,j,k\n" + text, encoding="utf-8")
        (BENCH.top / "toolpaths/support_pad/ribbon.stl").write_text(stl(ribbon(tips, [axis for _, axis in course])), encoding="utf-8")
        held = "joints_deg: [[-4.7, -4.3], [-64.1, -63.7], [103.1, 103.5], [-350, 350], [-118, 106], [-350, 350]]"
        job = BENCH.job("support_pad", [
            *WITHOUT_FORCE, (r"name: support_pad\n", "name: singular\n"), (r"mesh: support_pad.stl", "mesh: ribbon.stl"),
            (r"pose: \{xyz_mm: .*", f"pose: {{xyz_mm: {home}, abc_deg: [0, 0, 0]}}"),
            (r"strategy: parallel_planes\n  region: .*\n  planes: .*\n  stepover_mm: .*\n",
             "strategy: cam\n  cam: {file: course.csv}\n"), (r"spacing_mm: [\d.]+", "spacing_mm: 30\n  gouges: {action: report}"),
            (r"  margin_deg: 3", "  margin_deg: 0"), (r"joints_deg: .*", held)], "singular")
        result, folder = BENCH.plan(job, "singular", "--threads", "2")
        self.assertEqual(result.returncode, 1, result.stdout + result.stderr)
        judged, verdict = BENCH.audit(folder, job, "--travel-mm", TRAVEL_MM)
        self.assertEqual((judged, verdict["broken"]), (0, {}))
        with open(folder / "points.csv", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        planned = [row for row in rows if row["a1_deg"]]
        self.assertGreater(len(planned), 5, result.stdout)
        for row in planned:
            self.assertGreaterEqual(abs(math.sin(math.radians(float(row["a5_deg"])))), 0.05 - 1e-9)
        self.assertTrue(any(row["reason"] == "singular" for row in rows if not row["a1_deg"]))

    def test_a_link_swallowed_by_a_solid_is_seen(self):
        rock = block((-9000, -9000, -9000), (9000, 9000, 9000))  # no surface comes near the arm
        (BENCH.top / "cells/rock.stl").write_text(stl(rock), encoding="utf-8")
        body = "  - {name: rock, class: fixture, mount: world, shape: {mesh: {file: rock.stl, unit: mm}}}\n"
        summary, _, text = self.plan("swallowed", body, FEW_POINTS, status=1)
        self.assertEqual(summary["points"]["planned"], 0)
        self.assertEqual({entry["reason"] for entry in summary["skipped"]}, {"interference"})
        self.assertTrue(all("rock" in entry["detail"] for entry in summary["skipped"]))
        self.assertIn("home_deg: rock and", text)

    def test_half_the_part_out_of_reach_costs_only_that_half(self):
        plate = block((-40, -1600, -20), (40, 1600, 0))  # y is the world's y: from the arm's front far to its sides
        changes = [(r"stepover_mm: [\d.]+", "stepover_mm: 60"), (r"spacing_mm: [\d.]+", "spacing_mm: 100"),
                   (r"planes: .*", "planes: {normal: [1, 0, 0]}"), (r"  joints_deg: .*\n", ""),
                   (r"xyz_mm: \[2076, 0, 1006\]", "xyz_mm: [1900, 1900, 1006]")]
        summary, rows, _ = self.plan("half", changes=changes, mesh=plate, status=1)
        planned = [float(row["y_mm"]) for row in rows if row["a1_deg"]]
        skipped = [float(row["y_mm"]) for row in rows if not row["a1_deg"]]
        self.assertGreater(len(planned), 10)
        self.assertGreater(len(skipped), 10)
        self.assertLess(max(planned), min(skipped) + 150)  # the near part is kept as a whole
        self.assertEqual(summary["points"]["planned"] + summary["points"]["skipped"], summary["points"]["total"])
        self.assertTrue(all(e["reason"] in ("unreachable", "limit", "singular", "step") for e in summary["skipped"]))
        self.assertIn("unreachable", {e["reason"] for e in summary["skipped"]})
        self.assertEqual(len(summary["programs"]), 4)
        programs = [path for path in (BENCH.top / "half/programs").rglob("*") if path.stem.lower() == "half"]
        heads = [re.search(r"INCOMPLETE: of (\d+) points are not cut: (.*)", path.read_text(encoding="utf-8"))
                 for path in programs if path.suffix in (".src", ".mpf", ".ngc")]
        self.assertEqual(len(heads), 3)
        for head in heads:
            self.assertEqual(int(head[1]), summary["points"]["total"])
            self.assertEqual(sum(map(int, re.findall(r"\d+", head[2]))), summary["points"]["skipped"])
        self.assertTrue(all(program["verified"] for program in summary["programs"]))

    def test_an_end_that_the_best_pose_could_not_leave_gets_another(self):
        """On a dome the stiffest poses at the rims come so near with a link that there is no room to retract."""
        def height(x, y):
            return math.sqrt(800 ** 2 - x ** 2 - y ** 2) - 800

        grid = [-200 + 10 * i for i in range(41)]
        mesh = [t for x0, x1 in zip(grid, grid[1:]) for y0, y1 in zip(grid, grid[1:])
                for t in quad(*((x, y, height(x, y)) for x, y in ((x0, y0), (x1, y0), (x1, y1), (x0, y1))))]
        changes = [(r"stepover_mm: [\d.]+", "stepover_mm: 60"), (r"spacing_mm: [\d.]+", "spacing_mm: 20"),
                   (r"within_deg: 1", "within_deg: 60"), (r"planes: .*", "planes: {normal: [1, 0, 0]}"), (r"  joints_deg: .*\n", ""),
                   (r"xyz_mm: \[2076, 0, 1006\]", "xyz_mm: [1850, 0, 1200]")]
        summary, _, text = self.plan("dome", changes=changes, mesh=mesh)
        self.assertRegex(text, "[1-9] pass(es)? with an end near something")
        self.assertEqual((summary["points"]["skipped"], summary["gap_remarks"]), (0, []))

    def test_points_are_inserted_where_a_bound_per_step_leaves_too_little(self):
        """Points 20 mm apart, of which no joint step within 0.3° joins two."""
        bound = (r"\npath:", f"\npath:\n  max_joint_step_deg: {[0.3] * 6}")
        summary, rows, text = self.plan("narrow", changes=[*FEW_POINTS, bound])
        self.assertRegex(text, "[1-9][0-9]* points inserted in [1-9] pass(es)?")
        self.assertEqual(summary["points"]["skipped"], 0)
        laid, _, _ = self.plan("wide", changes=FEW_POINTS)
        places = {(row["x_mm"], row["y_mm"], row["z_mm"]) for row in rows}
        with open(BENCH.top / "wide/points.csv", encoding="utf-8") as file:
            wide = [(row["x_mm"], row["y_mm"], row["z_mm"]) for row in csv.DictReader(file)]
        self.assertGreater(len(places), 2 * len(wide))
        self.assertEqual([place for place in wide if place not in places], [])  # none was moved
        self.assertEqual({row["x_mm"] for row in rows}, {place[0] for place in wide})  # all on the pad
        self.assertEqual(laid["passes"], summary["passes"])

    def test_a_ring_that_winds_an_axis_at_its_top_speed_gets_its_programs(self):
        """Round an upright rod of 60 mm: A4 turns by 14° a mm, A6 ends a full revolution from where it began."""
        def place(i, z, sides=180):
            return (30 * math.cos(2 * math.pi * i / sides), 30 * math.sin(2 * math.pi * i / sides), z)

        rod = [t for i in range(180) for t in (*quad(place(i, 0), place(i + 1, 0), place(i + 1, 60), place(i, 60)),
                                              ((0, 0, 0), place(i + 1, 0), place(i, 0)), ((0, 0, 60), place(i, 60), place(i + 1, 60)))]
        changes = [(r"strategy: parallel_planes\n  region: .*\n  planes: .*\n  stepover_mm: .*\n",
                    "strategy: rings\n  rings: {point_mm: [0, 0, 0], axis: [0, 0, 1], on: walls}\n"
                    "  region: {facing: {direction: [0, 0, 1], within_deg: 91}}\n  stepover_mm: 60\n"),
                   (r"  joints_deg: .*\n", ""), (r"pose: \{xyz_mm: .*", "pose: {xyz_mm: [2000, 0, 800], abc_deg: [0, 0, 0]}"),
                   (r"feed_mm_min: 80", "feed_mm_min: 600"), (r"chord_tolerance_mm: [\d.]+", "chord_tolerance_mm: 0.05"),
                   (r"spacing_mm: [\d.]+", "spacing_mm: 10"), (r"rotation_step_deg: \d+\n", "rotation_step_deg: 1\n")]
        summary, rows, text = self.plan("rod", changes=changes, mesh=rod, status=1)  # for feeds far below the programmed one
        self.assertEqual(summary["points"]["skipped"], 0)
        self.assertIn("the speed of A4 allows no more", text)
        self.assertGreater(abs(float(rows[-1]["a6_deg"]) - float(rows[0]["a6_deg"])), 350)
        self.assertEqual([(program["controller"], program["verified"]) for program in summary["programs"]],
                         [("krl", True), ("krl", True), ("sinumerik", True), ("linuxcnc", True)])

    def test_a_zigzag_runs_each_pass_the_way_whose_force_bends_the_arm_less(self):
        def means(name, *changes):
            _, rows, text = self.plan(name, changes=[(r"stepover_mm: [\d.]+", "stepover_mm: 13"), *changes], layers=True)
            values = {}
            for row in rows:
                if row["kind"] == "cut":
                    values.setdefault(row["pass"], []).append(float(row["objective"]))
            return {number: sum(pass_) / len(pass_) for number, pass_ in values.items()}, text

        both, text = means("zigzag")
        self.assertRegex(text, "[1-9][0-9]* pass(es)? run the other way round")
        self.assertRegex(text, r"warning +toolpath: passes \d+(, \d+)* run from their other end")
        one, _ = means("one_way", (r"direction: zigzag  ", "direction: one_way  "))
        self.assertEqual(len(both), len(one))
        for number, mean in both.items():  # the gain that a turn must be worth, and another grid of points
            self.assertLess(mean, one[number] * 1.07, number)

    def test_nothing_is_cut_deeper_than_the_job_says_over_what_is_missing(self):
        """A post at the pad's corner keeps the first of two layers from being milled there."""
        post = box("post", (12, 6, 6), (2070, 38, 1044))

        def deepest(name, *more):
            summary, _, text = self.plan(name, post, more, status=1, layers=True)
            with open(BENCH.top / name / "deflection.csv", encoding="utf-8") as file:
                cuts = [(float(row["width_mm"]), float(row["depth_mm"])) for row in csv.DictReader(file) if row["depth_mm"]]
            left_out = [entry for entry in summary["skipped"] if entry["reason"] == "over_missing"]
            return max(depth for _, depth in cuts), left_out, text

        depth, left_out, text = deepest("over_missing")
        self.assertLessEqual(depth, 1.2)
        self.assertGreater(len(left_out), 0)
        for entry in left_out:
            self.assertRegex(entry["detail"], r"2\.00 mm deep next to the material that point \d+ \(pass \d+, interference\) leaves")
        self.assertIn(f"{len(left_out)} more are left out because the cutter would meet it there", text)
        depth, left_out, _ = deepest("cut_over", (r"\npath:", "\npath:\n  over_missing: cut"))
        self.assertGreater(depth, 1.9)
        self.assertEqual(left_out, [])

    def test_a_start_pose_in_collision_is_told_and_the_cuts_are_planned(self):
        home = [("home_deg: [0, -90, 90, 0, 0, 0]", "home_deg: [0, 0, 120, 0, 0, 0]")]
        summary, _, text = self.plan("start", changes=FEW_POINTS, cell_changes=home, status=1)
        self.assertIn("home_deg: platform and", text)
        self.assertIn("no way from or to home can be planned", text)
        self.assertEqual(summary["points"]["skipped"], 0)
        self.assertEqual(summary["gaps"]["total"] - summary["gaps"]["planned"], 2)

    def test_an_arm_from_a_urdf_is_planned_and_judged_by_its_own_joints(self):
        urdf = pathlib.Path(sys.argv[3], "tests/machine/robot/turned_about.urdf")
        (BENCH.top / "cells/turned_about.urdf").write_text(urdf.read_text(encoding="utf-8"), encoding="utf-8")
        cell = (BENCH.top / "cells/kr500_r2830.yaml").read_text(encoding="utf-8")
        cell = re.sub(r"  lengths_mm: .*\n(  .*\n)*?  accelerations_deg_s2",
                      "  urdf: {file: turned_about.urdf, base_link: base_link, flange_link: tool0}\n  accelerations_deg_s2", cell)
        cell = re.sub(r"home_deg: .*", "home_deg: [90, 0, 0, 0, 0, 0]", cell)
        cell = re.sub(r"  - \{name: \w+, class: link, .*\n", "", cell)
        cell = cell.replace("length_mm: 320, diameter_mm: 160", "length_mm: 200, diameter_mm: 120")
        cell = re.sub(r"  - \{name: bracket, .*\n", "", cell)
        count = "axis_signs: [1, 1, 1, 1, 1, 1], axis_offsets_deg: [0, 0, 0, 0, 0, 0]"  # KRL's follows from the geometry
        cell = cell.replace("sinumerik: {", f"sinumerik: {{{count}, ").replace("linuxcnc: {}", f"linuxcnc: {{{count}}}")
        (BENCH.top / "cells/own.yaml").write_text(cell, encoding="utf-8")
        job = BENCH.job("support_pad", [*WITHOUT_FORCE, (r"kr500_r2830.yaml", "own.yaml"), (r"  joints_deg: .*\n", ""),
                                        (r"xyz_mm: \[2076, 0, 1006\]", "xyz_mm: [1200, 0, 700]"), *FEW_POINTS], "own")
        result, folder = BENCH.plan(job, "own", "--threads", "2")
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        judged, verdict = BENCH.audit(folder, job, "--travel-mm", TRAVEL_MM)
        self.assertEqual((judged, verdict["broken"]), (0, {}))
        self.assertLess(verdict["max_urdf_error_mm"], 1e-9)
        # Home, [90, 0, 0, 0, 0, 0] of the file, is the arm upright with the hand down as KUKA counts.
        krl = "".join(path.read_text() for path in sorted((folder / "programs/krl").rglob("*.src")))
        self.assertRegex(krl, r"PTP \{A1 0,A2 -90,A3 90,A4 0,A5 90,A6 ")
        self.assertIn("zero_offsets_deg: [90, -90, 90, 0, 90, 0]", (folder / "cell.yaml").read_text(encoding="utf-8"))

    def test_the_stock_is_kept_clear_of_between_the_cuts(self):
        (BENCH.top / "toolpaths/support_pad/raw.stl").write_text(
            stl(block((-60, -60, -60), (60, 60, 40))), encoding="utf-8")
        raw = [*FEW_POINTS, (r"  unit: mm\n", "  unit: mm\n  stock: {mesh: raw.stl, unit: mm}\n"),
               (r"retract_mm: 50", "retract_mm: 30")]
        bare = [change for change in raw if "stock" not in change[1]]
        _, without, _ = self.plan("bare", changes=bare)
        summary, with_stock, _ = self.plan("stock", changes=raw)
        self.assertEqual(summary["gaps"]["planned"], summary["gaps"]["total"])
        angles = [f"a{i}_deg" for i in range(1, 7)]
        self.assertEqual([[row[a] for a in angles] for row in without], [[row[a] for a in angles] for row in with_stock])

        def motions(name):
            program = (BENCH.top / name / f"programs/linuxcnc/{name}.ngc").read_text(encoding="utf-8")
            return [line for line in program.splitlines() if line.startswith("G1")]

        # 30 mm out is clear of the part, not of 40 mm of stock: twice as far.
        self.assertGreater(len(motions("stock")), 0)
        self.assertNotEqual(motions("bare"), motions("stock"))


if __name__ == "__main__":
    BENCH = Bench(*sys.argv[1:4])
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]])
