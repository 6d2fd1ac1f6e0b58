# SPDX-License-Identifier: GPL-3.0-or-later
"""`millpose register` and `millpose calibrate --map`. Usage: register_test.py MILLPOSE TOP"""
import csv
import json
import math
import random
import unittest

from cli_fixture import TOP, InFolder, plan, run, schema_problems

PAD = TOP / "toolpaths" / "support_pad"
POSE = "pose: {xyz_mm: [2076, 0, 1006], abc_deg: [0, -90, 0]}"
# The pad is a block: five of its faces by their normals, and how far they reach in the part's frame.
FACES = ((0, 0, 1), (1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0))
RADIUS = 3.0


def on_face(normal, draw):
    """A place on one of the block's faces (x, y within 40, z from -40 to 0), not at its edge."""
    place = [draw.uniform(-30, 30), draw.uniform(-30, 30), draw.uniform(-30, -5)]
    for axis, n in enumerate(normal):
        if n:
            place[axis] = 0.0 if axis == 2 else 40.0 * n
    return place


def in_base(p):
    """Where a place of the part stands: the job's pose (P's z looks along the base's -x, its x along z), then 0.8, -0.5,
    1.1 mm and 0.003 rad about the base's z."""
    x, y, z = 2076 - p[2], p[1], 1006 + p[0]
    c, s = math.cos(0.003), math.sin(0.003)
    return [2076 + c * (x - 2076) - s * y + 0.8, s * (x - 2076) + c * y - 0.5, z + 1.1]


def probed(count, sd, seed=1, chips=()):
    draw = random.Random(seed)
    rows = ["x_mm,y_mm,z_mm"]
    for i in range(count):
        normal = FACES[i % len(FACES)]
        reach = RADIUS + (1.0 if i in chips else 0.0)
        ball = in_base([a + reach * n for a, n in zip(on_face(normal, draw), normal)])
        rows.append(",".join(f"{a + draw.gauss(0, sd):.5f}" for a in ball))
    return "\n".join(rows) + "\n"


def rows_of(path):
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


class Register(InFolder):
    def setUp(self):
        super().setUp()
        self.job = self.folder / "job.yaml"
        self.job.write_text((PAD / "job.yaml").read_text().replace("../../cells", str(TOP / "cells"))
                            .replace("support_pad.stl", str(PAD / "support_pad.stl")))
        self.points = self.folder / "points.csv"

    def register(self, *more):
        return run("register", self.job, "--probe", self.points, "--sd-mm", 0.02, "--tool-radius-mm", RADIUS, *more)

    def test_writes_pose_and_covariance_and_nothing_else(self):
        self.points.write_text(probed(30, 0.02))
        before = self.job.read_text()
        result = self.register("--json", "--write-job", self.job)
        self.assertEqual(result.returncode, 0, result.stderr)
        found = json.loads(result.stdout)
        for got, want in zip(found["pose"]["xyz_mm"], in_base([0, 0, 0])):
            self.assertAlmostEqual(got, want, delta=0.05)
        self.assertLess(found["face_um_95"], 200)
        self.assertGreater(found["face_um_95"], 5)
        self.assertAlmostEqual(found["rms_mm"], 0.018, delta=0.008)
        self.assertEqual(len(found["probe_next"]), 3)
        self.assertLess(found["probe_next"][2]["face_um_95"], found["face_um_95"])
        lines = self.job.read_text().splitlines()
        registered = [line for line in lines if "registered:" in line]
        self.assertEqual(len(registered), 1)
        lines.remove(registered[0])
        at = next(i for i, line in enumerate(lines) if line.strip().startswith("pose: {xyz_mm"))
        lines[at] = "  " + POSE
        self.assertEqual("\n".join(lines) + "\n", before)
        # The pose that was written is found again, and is known as well.
        again = json.loads(self.register("--json").stdout)
        self.assertLess(again["moved_mm"], 1e-3)
        # A plan says how far its face may be off.
        out = self.folder / "out"
        changes = [word for change in ("toolpath.stepover_mm=40", "toolpath.spacing_mm=40", "programs=[]",
                                       "workpiece.registration={tolerance_mm: 0.001}") for word in ("--set", change)]
        planned = run("plan", self.job, "-o", out, *changes)
        self.assertEqual(planned.returncode, 1, planned.stderr)
        self.assertIn("the part's place is not known well enough", planned.stdout)
        summary = json.loads((out / "summary.json").read_text())
        self.assertAlmostEqual(summary["registration"]["face_um_95"], found["face_um_95"], delta=0.2 * found["face_um_95"])
        self.assertEqual(schema_problems("summary", summary), [])
        # A pose changed by hand is not the one that was measured.
        self.job.write_text(self.job.read_text().replace("  pose: {xyz_mm: [2", "  pose: {xyz_mm: [1"))
        stale = run("check", self.job)
        self.assertEqual(stale.returncode, 2)
        self.assertIn("workpiece.registered: is of another pose", stale.stderr)

    def test_leaves_a_job_alone_whose_tolerance_it_cannot_keep(self):
        self.points.write_text(probed(15, 0.02))
        self.job.write_text(self.job.read_text().replace(POSE, POSE + "\n  registration: {tolerance_mm: 0.002}"))
        before = self.job.read_text()
        result = self.register("--write-job", self.job)
        self.assertEqual(result.returncode, 1, result.stderr)
        self.assertIn("allowed: workpiece.registration.tolerance_mm, 2 µm", result.stdout)
        self.assertIn("is unchanged", result.stderr)
        self.assertEqual(self.job.read_text(), before)

    def test_leaves_a_job_alone_whose_last_layer_is_thinner_than_the_face_is_known(self):
        self.points.write_text(probed(30, 0.02))
        text = self.job.read_text().replace(", depth_mm: 1}", "}")
        for finishing, status in ((0.002, 1), (0.5, 0)):
            self.job.write_text(text.replace("toolpath:\n", "toolpath:\n  depth: {total_mm: 1, per_layer_mm: 1, "
                                             f"finishing_mm: {finishing}}}\n", 1))
            before = self.job.read_text()
            result = self.register("--propose", 0, "--write-job", self.job)
            self.assertEqual(result.returncode, status, result.stdout + result.stderr)
            self.assertEqual("more than its last layer takes off (toolpath.depth, 2 µm)" in result.stdout, status == 1)
            self.assertEqual(self.job.read_text() == before, status == 1)

    def test_names_outliers_and_what_no_point_tells(self):
        self.points.write_text(probed(30, 0.02, chips=(7,)))
        result = self.register("--propose", 0)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("1 outliers among them", result.stdout)
        self.assertIn(f"{self.points}:9: +", result.stdout)
        flat = probed(30, 0.02).splitlines()
        self.points.write_text("\n".join([flat[0], *flat[1::5]]) + "\n")
        result = self.register()
        self.assertEqual(result.returncode, 1, result.stderr)
        self.assertIn("no point tells a turn about (0.00, 0.00, 1.00)", result.stdout)
        self.assertNotIn("µm that it may be off", result.stdout)

    def test_refuses_what_it_cannot_read(self):
        self.points.write_text(probed(12, 0.02))
        for arguments, words in (((), "nobody says how well these points are known; allowed: a column sd_mm, or --sd-mm"),
                                 (("--sd-mm", 0.1), "nobody says how large the probe's ball is")):
            result = run("register", self.job, "--probe", self.points, *arguments)
            self.assertEqual(result.returncode, 2)
            self.assertIn(words, result.stderr)
        result = run("register", self.job)
        self.assertIn("no probed point; allowed: --probe, --edges, --holes, --targets", result.stderr)
        self.points.write_text("x_mm,y_mm,z_mm,nx\n1,2,3,4\n")
        self.assertIn("a normal needs three columns", self.register().stderr)
        self.points.write_text("x_mm,y_mm,z_mm,sd_mm\n1,2,3,-1\n")
        self.assertIn("points.csv:2: sd_mm: given -1", self.register().stderr)


class ErrorMap(InFolder):
    CHANGES = ("toolpath.stepover_mm=40", "toolpath.spacing_mm=20", "programs=[linuxcnc]",
               "pose.objective={name: chen2021}")  # poses do not follow the force

    @staticmethod
    def error(x, y):
        return 60 * math.sin(x / 20 + 0.5) + 40 * math.cos(y / 25)

    def measured(self, size=1.0, noise=2.0, seed=3):
        draw = random.Random(seed)
        path = self.folder / f"measured{seed}.csv"
        rows = ["x_mm,y_mm,z_mm,error_um"]
        for i in range(64):
            x, y = -38 + 76 / 7 * (i % 8), -38 + 76 / 7 * (i // 8)
            rows.append(f"{x:.3f},{y:.3f},0,{size * self.error(x, y) + draw.gauss(0, noise):.3f}")
        path.write_text("\n".join(rows) + "\n")
        return path

    def test_shifts_the_next_part_in_the_same_poses(self):
        first, second, chart = self.folder / "first", self.folder / "second", self.folder / "map.csv"
        self.assertEqual(plan(first, changes=self.CHANGES).returncode, 0)
        calibrate = ("--plan", first, "--job", TOP / "toolpaths" / "support_pad" / "job.yaml", "--map", chart)
        noise = run("calibrate", self.measured(0, 20, 4), *calibrate)
        self.assertEqual(noise.returncode, 1, noise.stderr)
        self.assertIn("nothing to correct", noise.stdout)
        self.assertFalse(chart.exists())
        both = run("calibrate", self.measured(), *calibrate, "--write-job", self.folder / "job.yaml")
        self.assertEqual(both.returncode, 2)
        self.assertIn("never both", both.stderr)
        found = run("calibrate", self.measured(), *calibrate, "--second", self.measured(0.8, 2, 5), "--json")
        self.assertEqual(found.returncode, 0, found.stderr)
        self.assertAlmostEqual(json.loads(found.stdout)["second_part"]["share"], 0.8, delta=0.05)
        found = run("calibrate", self.measured(), *calibrate)
        self.assertEqual(found.returncode, 0, found.stderr)
        compensation = f"compensation={{map_csv: '{chart}', max_mm: 0.07}}"
        result = plan(second, changes=(*self.CHANGES, compensation))
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        before, after = rows_of(first / "points.csv"), rows_of(second / "points.csv")
        moved = 0
        for was, now in zip(before, after, strict=True):
            for joint in range(1, 7):
                self.assertEqual(was[f"a{joint}_deg"], now[f"a{joint}_deg"])
            # The pad's normal looks along -x; its x is the world's z, its y the world's y.
            shift = 1000 * sum((float(now[f"commanded_{axis}_mm"]) - float(now[f"{axis}_mm"])) * float(now[f"n{axis}"])
                               for axis in "xyz")
            if now["kind"] == "cut":
                row = next(row for row in rows_of(chart) if row["point"] == now["point"])
                wanted = max(-70.0, min(70.0, self.error(float(row["x_mm"]), float(row["y_mm"]))))
                self.assertAlmostEqual(shift, -wanted, delta=6)
                moved += abs(shift) > 20
        self.assertGreater(moved, 4)
        summary = json.loads((second / "summary.json").read_text())
        self.assertEqual(schema_problems("summary", summary), [])
        self.assertAlmostEqual(summary["compensation"]["largest_map_um"], 70, delta=0.01)
        # Another place of the part is milled in other poses.
        other = plan(self.folder / "other", changes=(*self.CHANGES, compensation, "workpiece.pose.xyz_mm=[2086, 0, 1006]"))
        self.assertEqual(other.returncode, 2)
        self.assertIn("milled in other poses", other.stderr)
        # Something else that is taken out now would be taken out twice.
        other = plan(self.folder / "other", changes=(
            *self.CHANGES, f"compensation={{map_csv: '{chart}', max_mm: 0.5, deflection: normal, shrink: 1}}",
            "process.force_factors={up: 10, down: 10, slot: 10}"))
        self.assertEqual(other.returncode, 2, other.stdout)
        self.assertIn("when the measured part was milled", other.stderr)


if __name__ == "__main__":
    unittest.main(argv=["register_test.py"], verbosity=2)
