# SPDX-License-Identifier: GPL-3.0-or-later
"""`millpose place`. Usage: place_test.py MILLPOSE TOP; with MILLPOSE_SLOW=1 also whole samples."""
import csv
import json
import math
import os
import re
import signal
import subprocess
import time
import unittest

from cli_fixture import MILLPOSE, TOP, InFolder, run

SLOW = os.environ.get("MILLPOSE_SLOW") == "1"
PAD = (TOP / "toolpaths" / "support_pad" / "job.yaml").read_text()
RANGES = "placement:\n  x_mm: {from: 1700, to: 2300}\n  z_mm: {from: 700, to: 1500}\n  points: 20\n  places: 120\n  plans: 2\n  map_points: 5\n"


def rows(path):
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def read(path):
    return json.loads(path.read_text())


def box(path, lower, upper):
    """An OFF file of a box."""
    corners = [[(lower, upper)[i >> k & 1][k] for k in range(3)] for i in range(8)]
    faces = "0 2 3 1  4 5 7 6  0 1 5 4  2 6 7 3  0 4 6 2  1 3 7 5".split("  ")
    triangles = [triangle for a, b, c, d in map(str.split, faces) for triangle in ((a, b, c), (a, c, d))]
    path.write_text(f"OFF\n8 12 0\n" + "".join("%g %g %g\n" % tuple(corner) for corner in corners)
                    + "".join(f"3 {' '.join(triangle)}\n" for triangle in triangles))


class Place(InFolder):
    def job(self, placement=RANGES, changes=(), text=PAD):
        for pattern, replacement in [(r"stepover_mm: \S+", "stepover_mm: 27"), (r"spacing_mm: \S+", "spacing_mm: 20"), *changes]:
            text, count = re.subn(pattern, replacement, text)
            assert count == 1, pattern
        text = text.replace("../../cells", str(TOP / "cells")).replace("mesh: support_pad", f"mesh: {TOP}/toolpaths/support_pad/support_pad")
        path = self.folder / "job.yaml"
        path.write_text(text + placement)
        return path

    def results(self, out):
        return {str(path.relative_to(out)): path.read_bytes() for path in sorted(out.rglob("*"))
                if path.is_file() and path.name != "run.json" and "checkpoints" not in path.parts and ".lock" not in path.name}

    def turned_over(self, placement, frame="world", beyond=2076):
        """The pad in two setups, the second one at x = `beyond`."""
        text = re.sub(r"  frame: .*\n  pose: .*\n", "", PAD)
        setup = "  - {{name: {}, frame: {}, pose: {{xyz_mm: [{}, 0, 1006], abc_deg: [0, -90, 0]}}}}\n"
        operations = "operations:\n  - {name: one, setup: first}\n  - {name: two, setup: second}\n"
        return self.job("setups:\n" + setup.format("first", frame, 2076) + setup.format("second", frame, beyond) + operations + placement, text=text)

    def test_a_part_that_is_turned_over_is_placed_by_the_robot_alone(self):
        refused = run("place", self.turned_over(RANGES), "-q")
        self.assertEqual((refused.returncode, refused.stdout), (2, ""))
        self.assertIn("setups: the part stands in each of them in its own way, and a place is looked for for one; allowed: placement.moves: robot, or a job of one "
                      "of them alone (first, second), with its pose as workpiece.pose", refused.stderr)
        self.assertFalse((self.folder / "support_pad.places").exists())
        robot = "placement: {moves: robot, x_mm: {from: -60, to: 60}, points: 10, places: 4, plans: 1, map_points: 2}\n"
        along = run("place", self.turned_over(robot, "robot_base"), "-q")
        self.assertEqual(along.returncode, 2)
        self.assertIn("setups.first.frame: robot_base, so that the part would go along with the robot", along.stderr)
        # Each operation counts where its own setup has the part: the second one stands out of reach.
        for beyond, both in ((2076, True), (9000, False)):
            done = run("place", self.turned_over(robot, beyond=beyond), "-q", "--set", "programs=[]")
            self.assertIn(done.returncode, (0, 1), done.stderr)
            for row in rows(self.folder / "support_pad.places" / "map.csv"):
                self.assertEqual(2 * int(row["free"]) > int(row["points"]), both, row)

    def test_the_best_place_is_planned_and_written_as_a_job(self):
        job = self.job()
        done = run("place", job, "-q")
        self.assertEqual(done.returncode, 0, done.stderr)
        out = self.folder / "support_pad.places"
        found = read(out / "placement.json")
        plans = found["plans"]
        self.assertEqual([plan["folder"] for plan in plans], ["plans/00_job", "plans/01", "plans/02"])
        # What is told of a plan is what its own folder says.
        own = read(out / "plans" / "00_job" / "summary.json")
        for plan in plans:
            summary = read(out / plan["folder"] / "summary.json")
            self.assertEqual(plan["points"], {"total": summary["points"]["total"], "planned": summary["points"]["planned"]})
            self.assertEqual(plan["objective_worst"], [summary["stiffness"]["objective"]["worst"]])
            self.assertAlmostEqual(plan["worst_ratio"], summary["stiffness"]["objective"]["worst"] / own["stiffness"]["objective"]["worst"], places=12)
            length = [max(float(row["length_um"]) for row in rows(out / folder / "deflection.csv")) for folder in (plan["folder"], "plans/00_job")]
            self.assertAlmostEqual(plan["length_ratio"], length[0] / length[1], places=12)
            self.assertEqual(run("verify", out / plan["folder"]).returncode, 0)
        # The recommended one is the best of them, and better than the job's own.
        best = plans[found["recommended"]]
        self.assertEqual(best["worst_ratio"], min(plan["worst_ratio"] for plan in plans))
        self.assertLess(best["worst_ratio"], 1)
        # By the sampled points a place looks about as a plan there comes out.
        at = next(row for row in rows(out / "places.csv") if all(float(row[key]) == best["place"][key] for key in ("x_mm", "z_mm")))
        self.assertAlmostEqual(float(at["worst_ratio"]), best["worst_ratio"], delta=0.1)
        # The job that was written plans as it is, to the same.
        placed = self.folder / "job.placed.yaml"
        self.assertIn(f"best       {found['recommended']}: {placed}", done.stdout)
        self.assertEqual(run("plan", placed, "-q").returncode, 0)
        again = read(self.folder / "support_pad_placed.out" / "summary.json")
        self.assertEqual([again["stiffness"]["objective"]["worst"]], best["objective_worst"])
        # Every place lies within the ranges, on the raster, and once.
        places = rows(out / "places.csv")
        self.assertEqual(len({(row["x_mm"], row["z_mm"]) for row in places}), len(places))
        for row in places:
            self.assertTrue(1700 <= int(row["x_mm"]) <= 2300 and 700 <= int(row["z_mm"]) <= 1500 and float(row["b_deg"]) == -90, row)
        self.assertEqual(len(rows(out / "map.csv")), 25)
        self.assertEqual([(one["coordinate"], one["by"]) for one in found["sensitivity"]], [("x_mm", -20), ("x_mm", 20), ("z_mm", -20), ("z_mm", 20)])
        self.assertEqual((out / "map.vtk").read_text().count("\n"), 6 + 3 + 2 + 25 * 3)
        page = (out / "placement.html").read_text()
        self.assertEqual(page.count("<rect"), 25)
        self.assertNotIn("<script", page)
        self.assertEqual([name in page for name in ("<svg", ">robot base<", ">job's own</text>", ">best place</text>")], [True] * 4)
        self.assertEqual((page.count("<polygon"), page.count("<svg")), (2, 2))
        own, best = (tuple(map(float, re.search(rf'<text x="([^"]+)" y="([^"]+)"[^>]*>{name}</text>', page).groups())) for name in ("job's own", "best place"))
        self.assertTrue(abs(own[0] - best[0]) >= 100 or abs(own[1] - best[1]) >= 14, (own, best))  # no label on the other

    TINY = "placement:\n  x_mm: {from: 1700, to: 2300}\n  z_mm: {from: 700, to: 1500}\n  points: 2\n  places: %d\n  plans: %d\n  map_points: 2\n"

    def test_what_was_edited_stays_and_what_this_run_does_not_make_goes(self):
        few = [(r"stepover_mm: 27", "stepover_mm: 60"), (r"spacing_mm: 20", "spacing_mm: 60")]

        def place(placement, *more):
            done = run("place", self.job(placement, few), "-q", *more)
            self.assertLess(done.returncode, 2, done.stderr)
            self.assertIn(f"{self.folder}/job.placed", done.stdout)
            return re.search(r"best +\d+: (\S+)", done.stdout).group(1)

        def beside():
            return sorted(path.name for path in self.folder.glob("job.*.yaml"))

        placed, plans = self.folder / "job.placed.yaml", self.folder / "support_pad.places" / "plans"
        self.assertEqual(place(self.TINY % (20, 2)), str(placed))
        self.assertEqual(sorted(path.name for path in plans.iterdir()), ["00_job", "01", "02"])
        (plans / "mine").mkdir()
        written = placed.read_bytes()
        self.assertEqual(place(self.TINY % (20, 1)), str(placed), "as it was written: written over")
        self.assertEqual(sorted(path.name for path in plans.iterdir()), ["00_job", "01", "mine"])
        edited = placed.read_bytes().replace(b"feed_mm_min: 80", b"feed_mm_min: 70")
        placed.write_bytes(edited)
        for places in (20, 30):
            self.assertEqual(place(self.TINY % (places, 1)), str(self.folder / "job.placed.1.yaml"))
            self.assertEqual((placed.read_bytes(), beside()), (edited, ["job.placed.1.yaml", "job.placed.yaml"]))
        (self.folder / "job.placed.1.yaml").write_text(PAD)  # of somebody else
        self.assertEqual(place(self.TINY % (20, 1)), str(self.folder / "job.placed.2.yaml"))
        placed.write_bytes(written)  # as place wrote it once: its own again
        english = (plans.parent / "placement.html").read_text()
        self.assertEqual(place(self.TINY % (20, 1), "--lang", "de"), str(placed))
        german = (plans.parent / "placement.html").read_text()
        self.assertIn('<html lang="de">', german)
        self.assertIn('<html lang="de">', (plans / "00_job" / "report.html").read_text())
        texts = re.sub(r"(?s)<style>.*?</style>|<[^>]*>", " ", german)
        self.assertEqual(re.findall(r"\b(?:the|place|of|and|most|from|by|points|job)\b", texts), [])
        self.assertEqual([len(re.findall(tag, german)) for tag in ("<td\\b", "<rect", "<svg")], [len(re.findall(tag, english)) for tag in ("<td\\b", "<rect", "<svg")])
        self.assertEqual(beside(), ["job.placed.1.yaml", "job.placed.yaml"])
        self.assertEqual((self.folder / "job.placed.1.yaml").read_text(), PAD)

    def test_the_score_knows_what_a_plan_cannot_do(self):
        """Behind the arm axis 1 would have to go round in the middle of a pass: what is best of each point alone promises 0.77."""
        sample = TOP / "toolpaths" / "cabin_panel"
        text = (sample / "job.yaml").read_text().replace("../../cells", str(TOP / "cells")).replace("mesh: cabin_panel", f"mesh: {sample}/cabin_panel")
        text = text.replace("stepover_mm: 20", "stepover_mm: 100").replace("spacing_mm: 10", "spacing_mm: 40").replace("rotation_step_deg: 1\n", "rotation_step_deg: 3\n")
        job = self.folder / "job.yaml"
        job.write_text(text + "placement:\n  x_mm: {from: 1116, to: 1118}\n  y_mm: {from: -88, to: -86}\n  z_mm: {from: 1797, to: 1799}\n"
                              "  places: 3\n  plans: 1\n  map_points: 2\n")
        self.assertEqual(run("place", job, "-q").returncode, 0)
        out = self.folder / "cabin_panel.places"
        planned = read(out / "placement.json")["plans"][1]["worst_ratio"]
        self.assertAlmostEqual(float(rows(out / "places.csv")[0]["worst_ratio"]), planned, delta=0.05)

    def test_what_has_no_range_stays_as_it_is(self):
        job = self.job("placement:\n  x_mm: {from: 1700, to: 2000}\n  a_deg: {from: -3, to: 3}\n  points: 5\n  places: 30\n  plans: 1\n  map_points: 3\n",
                       [(r"xyz_mm: \[2076, 0, 1006\], abc_deg: \[0, -90, 0\]", "xyz_mm: [2076, 0.3, 1006.25], abc_deg: [0, -89.97, 0.123]")])
        self.assertEqual(run("place", job, "-q").returncode, 0)
        out = self.folder / "support_pad.places"
        for row in rows(out / "places.csv"):
            self.assertEqual([row[key] for key in ("y_mm", "z_mm", "b_deg", "c_deg")], ["0.3", "1006.25", "-89.97", "0.123"])
        best = read(out / "placement.json")["plans"][1]["place"]
        self.assertRegex((self.folder / "job.placed.yaml").read_text(), rf"xyz_mm: \[{best['x_mm']:g}, 0\.3, 1006\.25\]\n? *abc_deg: \[{best['a_deg']:g}, -89\.97, 0\.123\]".replace("\\n? *", r"[\s,]*"))

    def test_same_bytes_for_any_threads_and_after_a_kill(self):
        job = self.job(RANGES.replace("120", "60"))
        begun = time.monotonic()
        self.assertLess(run("place", job, "-o", self.folder / "one", "--threads", "1", "-q").returncode, 2)
        seconds = time.monotonic() - begun
        wanted, placed = self.results(self.folder / "one"), (self.folder / "job.placed.yaml").read_bytes()
        for threads in (2, 4):
            self.assertLess(run("place", job, "-o", self.folder / f"t{threads}", "--threads", threads, "-q").returncode, 2)
            self.assertEqual(self.results(self.folder / f"t{threads}"), wanted)
        killed = self.folder / "killed"
        for part in range(1, 5):
            process = subprocess.Popen([MILLPOSE, "place", job, "-o", killed, "-q"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            time.sleep(seconds * part / 6)
            process.send_signal(signal.SIGKILL)
            process.wait()
        self.assertLess(run("place", job, "-o", killed, "-q").returncode, 2)
        self.assertEqual(self.results(killed), wanted)
        self.assertEqual((self.folder / "job.placed.yaml").read_bytes(), placed)

    def test_one_point_in_a_free_cell_against_a_brute_force_grid(self):
        """The search comes within 1 % of the best of a fine grid over the same ranges."""
        job = self.job("placement:\n  x_mm: {from: 1500, to: 2400}\n  z_mm: {from: 600, to: 1600}\n  points: 1\n  places: 400\n  plans: 1\n"
                       f"  map_points: {91 if SLOW else 46}\n")
        self.assertLess(run("place", job, "-q").returncode, 2)
        out = self.folder / "support_pad.places"
        least = [min(float(row["worst_ratio"]) for row in rows(out / name) if row["worst_ratio"]) for name in ("places.csv", "map.csv")]
        self.assertLess(least[0], least[1] * 1.01)

    def test_bodies_in_the_way_are_no_place(self):
        # A box as a mesh, in metres: as docs/placement.md has it.
        x, y, z = 0.1, 0.2, 1.5
        corners = "".join(f"v {i * x} {j * y} {k * z}\n" for k in (-1, 1) for j in (-1, 1) for i in (-1, 1))
        quads = ((1, 3, 4, 2), (5, 6, 8, 7), (1, 2, 6, 5), (3, 7, 8, 4), (1, 5, 7, 3), (2, 4, 8, 6))
        (self.folder / "column.obj").write_text(corners + "".join("f {} {} {} {}\n".format(*quad) for quad in quads))
        keep_out = "  keep_out:\n    - {name: column, shape: {mesh: {file: column.obj, unit: m}}, pose: {xyz_mm: [2100, 0, 0], abc_deg: [0, 0, 0]}}\n"
        job = self.job(RANGES + keep_out)
        done = run("place", job, "-q")
        self.assertLess(done.returncode, 2, done.stderr)
        out = self.folder / "support_pad.places"
        touching = 0
        for row in rows(out / "map.csv") + rows(out / "places.csv"):
            # The block is 80 mm wide and 40 mm deep, its face at x of the pose, the body of it behind that.
            inside = float(row["x_mm"]) + 40 > 2000.001 and float(row["x_mm"]) < 2199.999
            self.assertEqual(row["touches"], "column" if inside else row["touches"].replace("column", "not here"), row)
            touching += inside
            if inside:
                self.assertEqual((row["free"], row["worst_ratio"]), ("0", ""))
        self.assertGreater(touching, 5)
        self.assertIn("touches column", (out / "placement.html").read_text())
        for plan in read(out / "placement.json")["plans"][1:]:
            self.assertFalse(1960 < plan["place"]["x_mm"] < 2200, plan["place"])

    def test_the_robot_moved_one_way_is_the_part_moved_the_other_way(self):
        cell = (TOP / "cells" / "kr500_r2830.yaml").read_text()
        cell, count = re.subn(r"  - \{name: platform,.*\n", "", cell)
        self.assertEqual(count, 1)
        (self.folder / "cell.yaml").write_text(cell)
        changes = [(r"cell: \S+", "cell: cell.yaml"), (r"frame: robot_base", "frame: world")]
        few = "  points: 12\n  places: 30\n  plans: 1\n  map_points: 5\n"
        maps = {}
        for moves, x, z in (("part", "1876, to: 2276", "906, to: 1106"), ("robot", "-200, to: 200", "-100, to: 100")):
            job = self.job(f"placement:\n  moves: {moves}\n  x_mm: {{from: {x}}}\n  z_mm: {{from: {z}}}\n{few}", changes)
            done = run("place", job, "-o", self.folder / moves, "-q")
            self.assertEqual(done.returncode, 0, done.stderr)
            maps[moves] = {(int(row["x_mm"]), int(row["z_mm"])): row for row in rows(self.folder / moves / "map.csv")}
        for (x, z), row in maps["robot"].items():
            other = maps["part"][2076 - x, 1006 - z]
            self.assertEqual(row["free"], other["free"], (x, z))
            self.assertAlmostEqual(float(row["worst_ratio"]), float(other["worst_ratio"]), places=6, msg=(x, z))
        found = read(self.folder / "robot" / "placement.json")
        self.assertEqual(found["moves"], "robot")
        page = (self.folder / "robot" / "placement.html").read_text()
        self.assertEqual((page.count("<polygon"), page.count("<svg")), (1, 2))
        for name in (">part</text>", ">robot, job's own</text>", ">robot, best</text>", "In the world; dots"):
            self.assertIn(name, page)
        best = found["plans"][found["recommended"]]
        self.assertLess(best["worst_ratio"], 1)
        placed = self.folder / "job.placed.yaml"
        self.assertEqual(run("plan", placed, "-q").returncode, 0)
        out = self.folder / "support_pad_placed.out"
        self.assertEqual([read(out / "summary.json")["stiffness"]["objective"]["worst"]], best["objective_worst"])
        self.assertEqual(read(out / "summary.json")["cell"]["X_WB"][0][3], best["place"]["x_mm"])
        self.assertEqual(run("verify", out).returncode, 0)
        refused = run("place", self.job("placement: {moves: robot, x_mm: {from: -5, to: 5}}\n"), "-q")
        self.assertEqual(refused.returncode, 2)
        self.assertIn("so that the part would go along with the robot", refused.stderr)
        # A body that the robot's base would stand in.
        keep_out = "  keep_out:\n    - {name: pit, shape: {box: {size_mm: [100, 4000, 100]}}, pose: {xyz_mm: [700, 0, 50], abc_deg: [0, 0, 0]}}\n"
        job = self.job(f"placement:\n  moves: robot\n  x_mm: {{from: -200, to: 200}}\n{few}{keep_out}", changes)
        self.assertLess(run("place", job, "-o", self.folder / "pit", "-q").returncode, 2)
        # The base's cylinder is 1054 mm across: it reaches the box at 650 mm from x = 123 mm on.
        for row in rows(self.folder / "pit" / "map.csv") + rows(self.folder / "pit" / "places.csv"):
            self.assertEqual(row["touches"], "pit" if int(row["x_mm"]) >= 123 else "", row)

    def test_the_map_is_drawn_over_the_directions_asked_for(self):
        ranges = "placement:\n  x_mm: {from: 1900, to: 2100}\n  y_mm: {from: -50, to: 50}\n  z_mm: {from: 900, to: 1100}\n  points: 3\n  places: 5\n  plans: 1\n  map_points: 3\n"
        for drawn, first, second in (("", "x_mm", "y_mm"), ("  map: [z_mm, x_mm]\n", "z_mm", "x_mm"), ("  map: [y_mm]\n", "y_mm", None)):
            self.assertLess(run("place", self.job(ranges + drawn), "-q").returncode, 2)
            table = rows(self.folder / "support_pad.places" / "map.csv")
            self.assertEqual(len(table), 9 if second else 3)
            self.assertEqual(len({row[first] for row in table[:3]}), 3, drawn)
            if second:
                self.assertEqual([row[second] for row in table[:3]], [table[0][second]] * 3)
        for drawn, told in (("  map: [a_deg]\n", "given a_deg, which has no range"), ("  map: [x_mm, x_mm]\n", "give one direction or two different ones")):
            done = run("place", self.job(ranges + drawn), "-q")
            self.assertEqual(done.returncode, 2)
            self.assertIn(told, done.stderr)

    def test_a_place_that_is_best_already_stays(self):
        job = self.job("placement:\n  y_mm: {from: 900, to: 1100}\n  points: 10\n  places: 10\n  plans: 1\n  map_points: 3\n")
        done = run("place", job, "-q")
        self.assertIn("no place that was planned is better than the job's own", done.stdout)
        self.assertFalse((self.folder / "job.placed.yaml").exists())

    def test_what_is_wrong_is_told_with_its_place(self):
        for placement, told in (
            ("", r"job\.yaml.*placement: missing"),
            ("placement: {points: 5}\n", r"job\.yaml:\d+:\d+: placement: give a range for one of x_mm, y_mm"),
            ("placement: {x_mm: {from: 5, to: 5}}\n", r"placement\.x_mm: `to` must be more than `from`"),
            ("placement: {x_mm: {from: 5}}\n", r"placement\.x_mm\.to: missing"),
            ("placement: {x_mm: {from: 5, to: 6}, stations: {most: 2}}\n", r"placement\.stations\.error_mm: missing"),
            ("placement: {x_mm: {from: 5, to: 6}, stations: {most: 1, error_mm: 1}}\n", r"placement\.stations\.most: given 1"),
            ("placement: {x_m: {from: 5, to: 6}}\n", r"placement\.x_m: unknown key; nearest known key: x_mm"),
            ("placement: {x_mm: {from: 5, to: 6}, points: 0}\n", r"placement\.points: given 0"),
            ("placement: {x_mm: {from: 5, to: 6}, keep_out: [{name: a, shape: {mesh: {file: a.stl, unit: mm}}, pose: {xyz_mm: [0, 0, 0], abc_deg: [0, 0, 0]}}]}\n",
             r"a\.stl: cannot open"),
        ):
            with self.subTest(told):
                done = run("place", self.job(placement), "-q")
                self.assertEqual(done.returncode, 2, done.stdout)
                self.assertRegex(done.stderr, told)
                self.assertEqual([path.name for path in self.folder.iterdir()], ["job.yaml"])
        stations = "placement: {x_mm: {from: 5, to: 6}, stations: {most: 2, error_mm: 1}}\n"
        (self.folder / "path.csv").write_text("x_mm,y_mm,z_mm,i,j,k\n-50,0,0,0,0,1\n50,0,0,0,0,1\n")
        for pattern, replacement, told in (
            (r"planes: .*\n  stepover_mm.*\n  direction.*", "cam: {file: path.csv}", "the path of strategy cam is not split"),
            (r"planes: (.*)", r"planes: \1\n  share: {direction: [1, 0, 0], to_mm: 3}", "toolpath.share says already what of the path is milled"),
        ):
            text, count = re.subn(pattern, replacement, PAD)
            self.assertEqual(count, 1)
            if "cam" in told:
                text = re.sub(r"  region: .*\n", "", text).replace("parallel_planes", "cam").replace("  cutting: {material: 5A06, teeth: 4, depth_mm: 1}\n", "").replace("surface_error", "chen2021")
            (self.folder / "job.yaml").write_text(text.replace("../../cells", str(TOP / "cells")).replace("mesh: support_pad", f"mesh: {TOP}/toolpaths/support_pad/support_pad") + stations)
            done = run("place", self.folder / "job.yaml", "-q")
            self.assertEqual(done.returncode, 2)
            self.assertIn("placement.stations: ", done.stderr)
            self.assertIn(told, done.stderr)
        sample = (TOP / "toolpaths" / "cabin_window" / "job.yaml").read_text().replace("../../cells", str(TOP / "cells"))
        (self.folder / "window.yaml").write_text(re.sub(r"mesh: (\S+)", rf"mesh: {TOP}/toolpaths/cabin_window/\1", sample) + stations)
        self.assertIn("a job of several operations is not split", run("place", self.folder / "window.yaml", "-q").stderr)
        targets = ", ".join("{nominal_mm: [%d, %d, 0], measured_mm: [2076, %d, %d]}" % (x, y, y, 1006 + x) for x, y in ((0, 0), (30, 0), (0, 30)))
        done = run("place", self.job(changes=[(r"pose: \{xyz_mm.*\}", f"targets: [{targets}]")]), "-q")
        self.assertEqual(done.returncode, 2)
        self.assertIn("these measure where the part is already", done.stderr)

    def panel(self, length, placement, stepover=100, spacing=100, cutting=False):
        """A job on a standing panel of 400 mm height, far longer than the arm reaches, with `length` mm of it in y."""
        box(self.folder / "panel.off", (0, 0, -20), (400, length, 0))
        text = re.sub(r"  joints_deg: .*\n", "", PAD).replace("../../cells", str(TOP / "cells"))
        if not cutting:
            text = re.sub(r"  cutting: .*\n", "", text).replace("{name: surface_error}", "{name: chen2021}")
            text = re.sub(r"programs: .*", "programs: [krl]", text.replace("rotation_step_deg: 1\n", "rotation_step_deg: 5\n"))
        for pattern, replacement in ((r"name: support_pad\n", "name: long_standing_panel\n"), (r"mesh: \S+", "mesh: panel.off"),
                                     (r"normal: \[0, 1, 0\]", "normal: [1, 0, 0]"), (r"xyz_mm: \[2076, 0, 1006\]", f"xyz_mm: [2000, {-length / 2}, 800]"),
                                     (r"stepover_mm: \S+", f"stepover_mm: {stepover}"), (r"spacing_mm: \S+", f"spacing_mm: {spacing}")):
            text, count = re.subn(pattern, replacement, text)
            assert count == 1, pattern
        path = self.folder / "panel.yaml"
        path.write_text(text + placement)
        return path

    STATIONS = ("placement:\n  x_mm: {from: 1700, to: 2300}\n  y_mm: {from: -6000, to: 3000}\n  z_mm: {from: 500, to: 1300}\n"
                "  points: 20\n  places: 40\n  plans: 1\n  map_points: 2\n  stations: {most: 3, error_mm: 1.5}\n")

    def covered(self, out, station, rows_apart):
        """Of a planned station: by row of the panel the planned stretches of y in the part's frame, with the largest step."""
        place = station["place"]
        self.assertEqual([place[key] for key in ("a_deg", "b_deg", "c_deg")], [0, -90, 0])
        lanes = {}
        for row in rows(out / station["folder"] / "points.csv"):
            self.assertEqual(row["status"], "planned", row)
            # Turned by B = -90 degrees: x of the part is z of the world.
            x, y = float(row["z_mm"]) - place["z_mm"], float(row["y_mm"]) - place["y_mm"]
            self.assertAlmostEqual(float(row["x_mm"]), place["x_mm"], places=6)
            lanes.setdefault(round(x / rows_apart, 6), []).append(y)
        return {x: sorted(ys) for x, ys in lanes.items()}

    def stations_cover(self, out, length, stepover, spacing):
        """Stations mill all of the panel, overlap as stated, and leave no gap between points."""
        found = read(out / "placement.json")
        stations = found["stations"]
        overlap = stations["overlap_mm"]
        self.assertEqual(overlap, 2 * 1.5 + stepover)
        self.assertEqual(stations["along"], [0, 1, 0])
        split = stations["splits"][stations["recommended"]]
        seams = [None] + [station["to_mm"] for station in split["stations"][:-1]] + [None]
        for station, least, most in zip(split["stations"], seams, seams[1:]):
            self.assertEqual((station["from_mm"], station["to_mm"]), (least, most))
            lanes = self.covered(out, station, stepover)
            self.assertEqual(len(lanes), math.ceil(400 / stepover - 1e-9))
            for ys in lanes.values():
                self.assertAlmostEqual(ys[0], 0 if least is None else least - overlap / 2, places=6)
                self.assertAlmostEqual(ys[-1], length if most is None else most + overlap / 2, places=6)
                self.assertLessEqual(max(b - a for a, b in zip(ys, ys[1:])), spacing + 1e-6)
        return found, split

    def test_a_part_twice_the_reach_is_split_between_stations(self):
        job = self.panel(6000, self.STATIONS, 200, 200)
        done = run("place", job, "--threads", "2", "-q")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        out = self.folder / "long_standing_panel.places"
        found, split = self.stations_cover(out, 6000, 200, 200)
        # No single place reaches all, in the sample nor in any plan.
        self.assertTrue(all(int(row["free"]) < int(row["points"]) for row in rows(out / "places.csv")))
        for plan in found["plans"]:
            self.assertLess(plan["points"]["planned"], plan["points"]["total"])
        self.assertEqual(split["points"]["planned"], split["points"]["total"])
        self.assertEqual(split["objective_worst"], [max(station["objective_worst"][0] for station in split["stations"])])
        self.assertIn(f"best       {len(split['stations'])} stations: {self.folder}/panel.station_1.yaml, ", done.stdout)
        self.assertFalse((self.folder / "panel.placed.yaml").exists())
        bases = set()
        for number, station in enumerate(split["stations"], 1):
            # Every station's job plans as it is, to what was planned, with programs of its own.
            again = self.folder / f"again_{number}"
            self.assertEqual(run("plan", self.folder / f"panel.station_{number}.yaml", "-o", again, "-q").returncode, 0)
            (source,) = (again / "programs" / "krl").glob(f"*_s{number}.src")
            self.assertRegex(source.name, r"^long_stan\w*_[0-9a-z]{5}_s\d+\.src$")
            for name in ("points.csv", f"programs/krl/{source.name}"):
                self.assertEqual((again / name).read_bytes(), (out / station["folder"] / name).read_bytes())
            self.assertEqual(run("verify", out / station["folder"]).returncode, 0)
            bases.add(re.search(r"\$BASE *= *\{.*\}", source.read_text())[0])
            self.assertEqual([(one["coordinate"], one["by"]) for one in station["sensitivity"]],
                             [(key, by) for key in ("x_mm", "y_mm", "z_mm") for by in (-20, 20)])
        self.assertEqual(len(bases), len(split["stations"]))
        page = (out / "placement.html").read_text()
        self.assertIn("Split between stations", page)
        self.assertEqual([f">station {number}</text>" in page for number in range(1, 4)], [number <= len(split["stations"]) for number in range(1, 4)])
        # Splitting a share again is refused, and a station of an earlier split does not stay behind.
        refused = run("place", self.folder / "panel.station_1.yaml", "-q")
        self.assertEqual(refused.returncode, 2)
        self.assertIn("toolpath.share says already what of the path is milled", refused.stderr)
        stale = self.folder / "panel.station_3.yaml"
        if not stale.exists():
            stale.write_text((self.folder / "panel.station_1.yaml").read_text())
        wanted = self.results(out)
        self.assertEqual(run("place", job, "--threads", "1", "-o", self.folder / "one", "-q").returncode, 0)
        self.assertEqual(self.results(self.folder / "one"), wanted)
        self.assertEqual(stale.exists(), len(split["stations"]) == 3)

    def test_one_station_is_preferred_where_it_reaches_all(self):
        placement = self.STATIONS.replace("places: 40", "places: 20").replace("y_mm: {from: -6000, to: 3000}", "y_mm: {from: -500, to: -300}")
        for gain, splits in (("", 0), (", gain_percent: 99", 2)):
            job = self.panel(800, placement.replace("error_mm: 1.5", "error_mm: 1.5" + gain), spacing=200, stepover=200)
            done = run("place", job, "-q")
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
            stations = read(self.folder / "long_standing_panel.places" / "placement.json")["stations"]
            self.assertEqual((len(stations["splits"]), stations["recommended"]), (splits, None), gain)
            self.assertEqual(list(self.folder.glob("panel.station_*")), [])

    def test_plan_takes_the_job_as_without_the_section(self):
        plans = []
        for placement in ("", RANGES):
            self.assertEqual(run("plan", self.job(placement), "-o", self.folder / "out", "--fresh", "-q").returncode, 0)
            plans.append({name: data for name, data in self.results(self.folder / "out").items() if name.endswith((".src", ".mpf", ".ngc", "points.csv"))})
        self.assertEqual(*plans)
        self.assertGreater(len(plans[0]), 3)

    @unittest.skipUnless(SLOW, "the quick twin is above, with few points")
    def test_the_whole_panel_is_split_between_stations(self):
        """As docs/placement.md shows it, with a cutting force; after kills it is the same."""
        placement = self.STATIONS.replace("  points: 20\n  places: 40\n  plans: 1\n", "")
        job = self.panel(6000, placement, stepover=16, spacing=10, cutting=True)
        done = run("place", job, "-q", timeout=1800)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        out = self.folder / "long_standing_panel.places"
        found, split = self.stations_cover(out, 6000, 16, 10)
        self.assertEqual(found["objective"], "surface_error")
        self.assertEqual(len(split["stations"]), 2)
        for number, station in enumerate(split["stations"], 1):
            self.assertEqual(run("verify", out / station["folder"]).returncode, 0)
        few = self.panel(6000, self.STATIONS)
        self.assertEqual(run("place", few, "-o", self.folder / "whole", "-q", timeout=1800).returncode, 0)
        killed, wanted = self.folder / "killed", self.results(self.folder / "whole")
        jobs = [path.read_bytes() for path in sorted(self.folder.glob("panel.station_*"))]
        for seconds in (2, 4, 6, 8, 10, 12):
            process = subprocess.Popen([MILLPOSE, "place", few, "-o", killed, "-q"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            time.sleep(seconds)
            process.send_signal(signal.SIGKILL)
            process.wait()
        for threads in (1, 4):
            self.assertEqual(run("place", few, "-o", killed, "--threads", threads, "-q", timeout=1800).returncode, 0)
            self.assertEqual(self.results(killed), wanted)
            self.assertEqual([path.read_bytes() for path in sorted(self.folder.glob("panel.station_*"))], jobs)

    @unittest.skipUnless(SLOW, "the quick twins are above, on a pad of few points")
    def test_samples_near_the_best_place_by_full_plans(self):
        """What is told of ±20 mm holds of full plans there, and of the place itself."""
        sample = TOP / "toolpaths" / "cabin_panel" / "job.yaml"
        text = sample.read_text().replace("../../cells", str(TOP / "cells")).replace("mesh: cabin_panel", f"mesh: {sample.parent}/cabin_panel")
        job = self.folder / "job.yaml"
        job.write_text(text + "placement:\n  x_mm: {from: 1100, to: 2200}\n  y_mm: {from: -500, to: 500}\n  z_mm: {from: 700, to: 1900}\n")
        self.assertEqual(run("place", job, "-q").returncode, 0)
        found = read(self.folder / "cabin_panel.places" / "placement.json")
        best = found["plans"][found["recommended"]]
        own = found["plans"][0]["objective_worst"][0]
        for one in found["sensitivity"]:
            place = one["place"]
            done = run("plan", job, "-q", "-o", self.folder / "near", "--set", f"workpiece.pose.xyz_mm=[{place['x_mm']}, {place['y_mm']}, {place['z_mm']}]")
            self.assertLess(done.returncode, 2, done.stderr)
            worst = read(self.folder / "near" / "summary.json")["stiffness"]["objective"]["worst"] / own
            self.assertAlmostEqual(worst, place["worst_ratio"], delta=0.15, msg=one)
        self.assertLess(best["worst_ratio"], 0.9)


if __name__ == "__main__":
    unittest.main(argv=["place_test.py"], verbosity=2)
