# SPDX-License-Identifier: GPL-3.0-or-later
"""`millpose register` and `millpose calibrate --map`. Usage: register_test.py MILLPOSE TOP"""
import csv
import json
import math
import random
import re
import shutil
import unittest

from cli_fixture import TOP, InFolder, plan, run, schema_problems, tree

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

    def test_a_part_that_is_turned_over_is_refused(self):
        self.points.write_text(probed(10, 0.01))
        found = run("register", TOP / "toolpaths" / "cabin_pocket" / "job.yaml", "--probe", self.points, "--sd-mm", 0.01, "--tool-radius-mm", RADIUS)
        self.assertEqual((found.returncode, found.stdout), (2, ""))
        self.assertIn("setups: the part stands in several ways, and the points tell of one; allowed: a job of one of them alone (back, face), with its pose as workpiece.pose", found.stderr)

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
        # What was written is found again from there, and known as well about the same place of the part.
        def centre():
            return [float(x) for x in re.search(r"centre_mm: \[(.*?)\]", self.job.read_text())[1].split(",")]
        about = centre()
        again = json.loads(self.register("--json", "--write-job", self.job).stdout)
        self.assertLess(again["moved_mm"], 1e-3)
        self.assertLess(max(abs(a - b) for a, b in zip(centre(), about)), 2.1e-3)
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
        self.assertIn("1 outlier among them", result.stdout)
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


def box_stl(lower, upper):
    """An ASCII STL of a box between two corners."""
    corner = [[(upper if i >> axis & 1 else lower)[axis] for axis in range(3)] for i in range(8)]
    quads = ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5))
    faces = [corners for a, b, c, d in quads for corners in ((a, b, c), (a, c, d))]
    return "solid box\n" + "".join(
        "facet normal 0 0 0\nouter loop\n" + "".join("vertex {} {} {}\n".format(*corner[i]) for i in face) + "endloop\nendfacet\n"
        for face in faces) + "endsolid box\n"


class Plate:
    """A plate of 80 x 80 x 4 mm, its face in z = 0, bent as docs/registration.md says: |u| = |v| = 1 at its sides."""

    def __init__(self, u2, uv, v2, origin=(0, 0, -2), half=(40, 40)):
        self.modes, self.origin, self.half = (u2, uv, v2), origin, half

    def field(self, p):
        u, v = ((p[k] - self.origin[k]) / self.half[k] for k in (0, 1))
        a, b, c = self.modes
        return (a * (1.5 * u * u - 0.5) + b * u * v + c * (1.5 * v * v - 0.5),
                ((3 * a * u + b * v) / self.half[0], (b * u + 3 * c * v) / self.half[1]))

    def bent(self, p):
        d, (x, y) = self.field(p)
        z = p[2] - self.origin[2]
        return [p[0] - z * x, p[1] - z * y, p[2] + d]

    def unbent(self, p):
        q = list(p)
        for _ in range(80):
            q = [a + b - c for a, b, c in zip(q, p, self.bent(q))]
        return q

    def normal(self, p, n):
        """Of the bent surface where the unbent one has n: across two lines of it."""
        across = [[0.0, -n[2], n[1]], [n[2], 0.0, -n[0]], [-n[1], n[0], 0.0]]
        one, other = sorted(across, key=lambda t: -sum(a * a for a in t))[:2]
        tangents = []
        for t in (one, other):
            ends = [self.bent([a + side * 1e-3 * b for a, b in zip(p, t)]) for side in (1, -1)]
            tangents.append([a - b for a, b in zip(*ends)])
        (a, b, c), (d, e, f) = tangents
        cross = [b * f - c * e, c * d - a * f, a * e - b * d]
        size = math.copysign(math.sqrt(sum(x * x for x in cross)), sum(x * y for x, y in zip(cross, n)))
        return [x / size for x in cross]


class Bent(InFolder):
    SD = 0.01

    def setUp(self):
        super().setUp()
        self.job = self.folder / "job.yaml"
        (self.folder / "plate.stl").write_text(box_stl((-40, -40, -4), (40, 40, 0)))
        self.text = ((PAD / "job.yaml").read_text().replace("../../cells", str(TOP / "cells")).replace("support_pad.stl", "plate.stl"))
        self.job.write_text(self.text)
        self.points = self.folder / "points.csv"
        self.plate = Plate(-0.3, 0.1, -0.15)  # its middle is raised: a flat cutter leaves it whole

    def allow(self, registration):
        self.job.write_text(self.text.replace(POSE, f"{POSE}\n  registration: {registration}"))

    def probe(self, plate, count=60, sd=SD, seed=2):
        draw = random.Random(seed)
        rows = ["x_mm,y_mm,z_mm"]
        for i in range(count):
            normal = FACES[0] if i % 2 == 0 else FACES[1 + i // 2 % 4]
            place = [draw.uniform(-38, 38), draw.uniform(-38, 38), draw.uniform(-3, -1)]
            for axis, n in enumerate(normal):
                if n:
                    place[axis] = 0.0 if axis == 2 else 40.0 * n
            ball = [a + RADIUS * n for a, n in zip(plate.bent(place), plate.normal(place, normal))]
            rows.append(",".join(f"{a + draw.gauss(0, sd):.6f}" for a in in_base(ball)))
        self.points.write_text("\n".join(rows) + "\n")

    def register(self, *more):
        return run("register", self.job, "--probe", self.points, "--sd-mm", self.SD, "--tool-radius-mm", RADIUS, "--propose", 0, *more)

    def registered(self):
        """The bending that the job holds, its modes in their order."""
        line = next(line for line in self.job.read_text().splitlines() if "registered:" in line)
        numbers = {key: [float(x) for x in re.search(key + r": [\[{]([^\]}]*)", line).group(1).replace(":", ",").split(",") if re.search(r"\d$", x.strip()) and not re.search("[uv]", x)]
                   for key in ("origin_mm", "u_mm", "v_mm", "modes_mm")}
        return numbers

    def planned(self, *changes, status=(0, 1)):
        out = self.folder / "out"
        words = [word for change in ("toolpath.stepover_mm=20", "toolpath.spacing_mm=20", "programs=[]", *changes) for word in ("--set", change)]
        result = run("plan", self.job, "-o", out, "-v", *words)
        self.assertIn(result.returncode, status, result.stdout + result.stderr)
        return result

    def cut_points(self):
        """(position, normal, axis) of cut points in the part's frame."""
        summary = json.loads((self.folder / "out" / "summary.json").read_text())
        X = summary["cell"]["X_WP"]
        rows = []
        for row in rows_of(self.folder / "out" / "points.csv"):
            if row["kind"] != "cut":
                continue
            vectors = [[float(row[f"{name}{axis}{unit}"]) for axis in "xyz"] for name, unit in (("", "_mm"), ("n", ""), ("t", ""))]
            vectors[0] = [a - X[k][3] for k, a in enumerate(vectors[0])]
            rows.append([[sum(X[k][axis] * v[k] for k in range(3)) for axis in range(3)] for v in vectors])
        self.assertGreater(len(rows), 10)
        return rows

    def test_a_bent_plate_is_planned_as_it_is_bent(self):
        self.probe(self.plate)
        # Not allowed: told, and not taken as rigid.
        before = self.job.read_text()
        told = self.register("--write-job", self.job)
        self.assertEqual(told.returncode, 1, told.stdout + told.stderr)
        self.assertIn("workpiece.registration.max_bending_mm (0: take it as rigid all the same)", told.stdout)
        self.assertEqual(self.job.read_text(), before)
        # Allowed, but not as much.
        self.allow("{max_bending_mm: 0.2}")
        small = self.register("--write-job", self.job)
        self.assertEqual(small.returncode, 1, small.stdout + small.stderr)
        self.assertRegex(small.stdout, r"the part is bent by up to 0\.\d+ ± 0\.\d+ mm .* allowed: workpiece.registration.max_bending_mm, 0.200 mm")
        # Rigid, whatever the points say.
        self.allow("{max_bending_mm: 0}")
        rigid = json.loads(self.register("--json").stdout)
        self.assertEqual((rigid["bending"]["applied"], rigid["findings"]), (False, []))
        self.allow("{max_bending_mm: 1}   # clamps")
        before = self.job.read_text()
        result = self.register("--json", "--write-job", self.job)
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        found = json.loads(result.stdout)
        self.assertTrue(found["bending"]["applied"])
        self.assertLess(found["bending"]["p"], 1e-6)
        self.assertLess(found["face_um_95"], rigid["face_um_95"])
        self.assertEqual(len(found["covariance_mm_mrad"]), 9)
        for name, true in zip(("u2", "uv", "v2"), self.plate.modes):
            self.assertAlmostEqual(found["bending"]["modes_mm"][name], true, delta=2 * found["bending"]["modes_mm_95"][name])
        lines = self.job.read_text().splitlines()
        lines.remove(next(line for line in lines if "registered:" in line))
        lines[next(i for i, line in enumerate(lines) if line.strip().startswith("pose: {xyz_mm"))] = "  " + POSE
        self.assertEqual("\n".join(lines) + "\n", before)
        # Found anew it is the same: a bent job is registered from its unbent part.
        again = json.loads(self.register("--json").stdout)
        for name in ("u2", "uv", "v2"):
            self.assertAlmostEqual(again["bending"]["modes_mm"][name], found["bending"]["modes_mm"][name], delta=1e-3)
        bending = self.registered()
        self.assertEqual((bending["u_mm"], bending["v_mm"]), ([40, 0, 0], [0, 40, 0]))
        written = Plate(*bending["modes_mm"], origin=bending["origin_mm"])
        result = self.planned()
        self.assertIn("it is planned as bent by up to 0.", result.stdout)
        summary = json.loads((self.folder / "out" / "summary.json").read_text())
        self.assertEqual(schema_problems("summary", summary), [])
        self.assertLess(summary["registration"]["bent_mm"], found["bending"]["largest_mm"] + 1e-6)  # no cut point is in a corner
        self.assertGreater(summary["registration"]["bent_mm"], 0.2)
        lifted = 0
        for position, normal, axis in self.cut_points():
            flat = written.unbent(position)
            self.assertLess(abs(flat[2]), 1e-6)
            lifted = max(lifted, abs(position[2]))
            for a, b in zip(normal, written.normal(flat, (0, 0, 1))):
                self.assertAlmostEqual(a, b, delta=1e-6)
            self.assertEqual(normal, axis)
        self.assertAlmostEqual(summary["registration"]["bent_mm"], lifted, delta=2e-3)
        # Over its checkpoints a plan bent otherwise is what it is afresh.
        self.job.write_text(re.sub(r"modes_mm: {u2: [^,]*,", "modes_mm: {u2: -0.2,", self.job.read_text()))
        self.planned()
        kept = tree(self.folder / "out")
        shutil.rmtree(self.folder / "out")
        self.planned()
        self.assertEqual(kept, tree(self.folder / "out"))
        other = Plate(-0.2, *bending["modes_mm"][1:], origin=bending["origin_mm"])
        self.assertLess(max(abs(other.unbent(position)[2]) for position, _, _ in self.cut_points()), 1e-6)

    def test_a_cam_path_goes_with_the_part(self):
        self.probe(self.plate)
        self.allow("{max_bending_mm: 1}")
        self.assertEqual(self.register("--write-job", self.job).returncode, 0)
        path = [(x, 12.5, 0) for x in range(-30, 31, 5)]
        (self.folder / "path.csv").write_text("x_mm,y_mm,z_mm,i,j,k\n" + "".join(f"{x},{y},{z},0,0,1\n" for x, y, z in path))
        text = self.job.read_text()
        start, end = text.index("toolpath:"), text.index("process:")
        text = text[:start] + "toolpath:\n  strategy: cam\n  cam: {file: path.csv}\n  spacing_mm: 100\n" + text[end:]
        self.job.write_text("".join(line for line in text.splitlines(keepends=True) if "cutting:" not in line and "objective:" not in line))
        result = run("plan", self.job, "-o", self.folder / "out", "--set", "programs=[]")
        self.assertIn(result.returncode, (0, 1), result.stdout + result.stderr)
        bending = self.registered()
        written = Plate(*bending["modes_mm"], origin=bending["origin_mm"])
        flat = [written.unbent(position) for position, _, _ in self.cut_points()]
        for p in path:
            self.assertLess(min(math.dist(p, q) for q in flat), 1e-6)
        for (_, normal, axis), q in zip(self.cut_points(), flat):
            for a, b, c in zip(normal, axis, written.normal(q, (0, 0, 1))):
                self.assertAlmostEqual(a, c, delta=1e-6)
                self.assertAlmostEqual(b, c, delta=1e-6)

    def test_a_rigid_plate_is_not_bent(self):
        self.probe(Plate(0, 0, 0))
        self.allow("{max_bending_mm: 1}")
        found = json.loads(self.register("--json").stdout)
        self.assertIsNone(found["bending"])
        self.assertEqual(len(found["covariance_mm_mrad"]), 6)

    def test_refuses_bending_that_the_job_does_not_allow(self):
        self.probe(self.plate)
        self.allow("{max_bending_mm: 1}")
        self.assertEqual(self.register("--write-job", self.job).returncode, 0)
        text = self.job.read_text()
        for change, words in ((("max_bending_mm: 1", "max_bending_mm: 0.2"), "allowed: workpiece.registration.max_bending_mm, 0.200 mm"),
                              (("max_bending_mm: 1", "tolerance_mm: 1"), "workpiece.registered.bending: is not allowed by the job"),
                              (("{max_bending_mm: 1}", "{}"), "says nothing; allowed: tolerance_mm, max_bending_mm or both"),
                              (("v2: ", "uv2: "), "needs the first three or more of u2, uv, v2, u3, u2v, uv2, none left out"),
                              (("u_mm: [40, 0, 0]", "u_mm: [0, 40, 0]"), "u_mm and v_mm must be at right angles")):
            self.job.write_text(text.replace(*change))
            refused = run("check", self.job)
            self.assertEqual(refused.returncode, 2, refused.stdout)
            self.assertIn(words, refused.stderr)
            self.assertIn("job.yaml:", refused.stderr)


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
        for seed in (4, 6, 8):
            noise = run("calibrate", self.measured(0, 20, seed), *calibrate)
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
