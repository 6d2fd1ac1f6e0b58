# SPDX-License-Identifier: GPL-3.0-or-later
"""The small samples: one job for each strategy, and arms by the data sheets that their cells name. Arguments: MILLPOSE TOP"""
import json
import math
import re
import unittest

from cli_fixture import TOP, InFolder, run

SMALL = ("irb6640_pad", "irb6640_rail", "irb6640_turn", "r2000ic_contours", "support_cam", "support_curve", "support_rough", "ur10e_pad")

# Origins (m) and axes of the joints from base to flange, all angles 0, as the sheets' drawings have them.
SHEETS = {
    "irb6640_185_280": [("0 0 0.780", "0 0 1"), ("0.320 0 0", "0 1 0"), ("0 0 1.075", "0 1 0"), ("0 0 0.2", "1 0 0"),
                        ("1.392 0 0", "0 1 0"), ("0.2 0 0", "1 0 0")],
    "r2000ic_165f": [("0 0 0.670", "0 0 1"), ("0.312 0 0", "0 1 0"), ("0 0 1.075", "0 -1 0"), ("0 0 0.225", "-1 0 0"),
                     ("1.280 0 0", "0 -1 0"), ("0.215 0 0", "-1 0 0")],
}
SHEET_OF = {"irb6640_pad": "irb6640_185_280", "r2000ic_contours": "r2000ic_165f"}  # of samples


def turned(axis, angle):
    """The matrix of a rotation about a unit axis along x, y or z."""
    c, s = math.cos(angle), math.sin(angle)
    x, y, z = axis
    return [[c + x * x * (1 - c), x * y * (1 - c) - z * s, x * z * (1 - c) + y * s],
            [y * x * (1 - c) + z * s, c + y * y * (1 - c), y * z * (1 - c) - x * s],
            [z * x * (1 - c) - y * s, z * y * (1 - c) + x * s, c + z * z * (1 - c)]]


def times(a, b):
    return [[sum(a[i][k] * b[k][j] for k in range(3)) for j in range(len(b[0]))] for i in range(3)]


def tip(sheet, degrees, in_tool0):
    """Where a point of tool0 (z out of the flange, x down) comes to, mm."""
    place, turn = [0.0, 0.0, 0.0], [[1, 0, 0], [0, 1, 0], [0, 0, 1]]

    def go(along):
        step = times(turn, [[v] for v in along])
        return [place[i] + step[i][0] for i in range(3)]

    for (origin, axis), angle in zip(sheet, degrees):
        place = go([1000 * float(v) for v in origin.split()])
        turn = times(turn, turned([float(v) for v in axis.split()], math.radians(angle)))
    turn = times(turn, turned((0, 1, 0), math.pi / 2))
    return go(in_tool0)


def across(a, b, radius, y):
    """What of a line along x at height y lies within a radius of the way from a to b: its ends, or nothing."""
    ends = [x + side * math.sqrt(radius ** 2 - (y - at) ** 2) for x, at in (a, b) if abs(y - at) <= radius for side in (-1, 1)]
    length = math.dist(a, b)
    if length > 0:
        aside = (radius * (a[1] - b[1]) / length, radius * (b[0] - a[0]) / length)
        corners = [(p[0] + s * aside[0], p[1] + s * aside[1]) for p, s in ((a, 1), (b, 1), (b, -1), (a, -1))]
        for (x, low), (other, high) in zip(corners, corners[1:] + corners[:1]):
            if min(low, high) <= y < max(low, high):
                ends.append(x + (y - low) / (high - low) * (other - x))
    return (min(ends), max(ends)) if ends else None


class Milled:
    """An independent count of what flat cutters take off a blank whose face lies at z = 0, by their level cuts; mm."""

    CELL = 0.25

    def __init__(self, half_x, half_y):
        self.half_x, self.half_y = half_x, half_y
        self.levels = {}  # by height: which cells a cutter was over
        self.removed = 0.0  # mm³

    def level(self, z):
        if z not in self.levels:
            columns, rows = (round(2 * half / self.CELL) for half in (self.half_x, self.half_y))
            self.levels[z] = [bytearray(columns) for _ in range(rows)]
        return self.levels[z]

    def mill(self, points, radius):
        """points: (pass, x, y, z) in P."""
        for (one, *a), (other, *b) in zip(points, points[1:]):
            if one != other or abs(a[2] - b[2]) > 1e-6:
                continue
            for row, cells in enumerate(self.level(round(a[2], 4))):
                reached = across(a[:2], b[:2], radius, (row + 0.5) * self.CELL - self.half_y)
                if reached:
                    first, end = (min(max(math.ceil((x + self.half_x) / self.CELL - 0.5), 0), len(cells)) for x in reached)
                    cells[first:end] = b"\1" * (end - first)
        self.removed = 0.0
        # A cell that was milled at one height is so at all above it.
        whole = [0] * len(next(iter(self.levels.values())))
        for z in sorted(self.levels):
            whole = [cells | int.from_bytes(milled, "big") for cells, milled in zip(whole, self.levels[z])]
            above = min([0.0] + [other for other in self.levels if other > z])
            self.removed += sum(cells.bit_count() for cells in whole) * self.CELL ** 2 * (above - z)


class SampleJobs(InFolder):
    def test_small_samples_plan_whole(self):
        for name in SMALL:
            with self.subTest(job=name):
                result = run("plan", TOP / "toolpaths" / name / "job.yaml", "-o", self.folder / name, "-q")
                self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
                if name in SHEET_OF:
                    self.check_against_sheet(name)
                summary = json.loads((self.folder / name / "summary.json").read_text())
                self.assertEqual(summary["points"]["planned"], summary["points"]["total"])
                self.assertTrue(summary["programs"] and all(p["verified"] for p in summary["programs"]))
                page = self.folder / "summary.html"
                told = run("report", self.folder / name, "--job", TOP / "toolpaths" / name / "job.yaml", "--summary", "--html", page)
                self.assertEqual(told.returncode, 0, told.stderr)
                self.assertEqual(page.read_text().count('<section class="page">'), 2)

    def test_a_panel_is_milled_from_both_sides(self):
        """cabin_pocket: roughed, rested and finished in one setup, then turned over: programs for each, and the material handed on."""
        result = run("plan", TOP / "toolpaths" / "cabin_pocket" / "job.yaml", "-o", self.folder / "out", "-q")
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        whole = json.loads((self.folder / "out" / "summary.json").read_text())
        self.assertEqual(whole["points"]["planned"], whole["points"]["total"])
        self.assertEqual([(program["controller"], program["setup"]) for program in whole["programs"]],
                         [(controller, setup) for controller in ("krl", "sinumerik", "linuxcnc") for setup in ("face", "back")])
        self.assertTrue(all(program["verified"] for program in whole["programs"]))
        self.check_mains(self.folder / "out" / "programs" / "krl")
        setups = [operation["setup"] for operation in whole["operations"]]
        self.assertEqual(setups, ["face", "face", "face", "back", "back"])
        removed = self.check_removed(setups)
        # In the end both pockets, with corners of 12 and 22 mm.
        for setup, (length, width, depth, corner) in (("face", (140, 90, 20, 12)), ("back", (120, 70, 8, 22))):
            pocket = depth * (length * width - (4 - math.pi) * corner ** 2)
            self.assertAlmostEqual(removed[setup], pocket, delta=0.005 * pocket)

    def check_mains(self, programs):
        """Each setup's main program is confirmed, but not with the text of the other's."""
        mains = [next(file for file in programs.glob(f"{setup}_?????.src")) for setup in ("face", "back")]
        texts = [main.read_text() for main in mains]
        for main, text, other in zip(mains, texts, texts[::-1]):
            self.assertEqual(run("verify", main, "--plan", self.folder / "out").returncode, 0)
            main.write_text(other)
            told = run("verify", main, "--plan", self.folder / "out")
            self.assertIn(told.returncode, (1, 2), told.stdout + told.stderr)
            main.write_text(text)
        whole = run("verify", self.folder / "out", "-q")
        self.assertEqual(whole.returncode, 0, whole.stdout)

    def check_removed(self, setups):
        """Operation by operation, what is taken off against an independent count; mm³ by setup, as counted."""
        milled, blank, removed = {setup: Milled(90, 65) for setup in setups}, 180 * 130 * 36 / 1e3, 0.0
        for folder, setup, radius in zip(sorted((self.folder / "out" / "operations").iterdir()), setups, (20, 10, 10, 20, 10)):
            stock = json.loads((folder / "summary.json").read_text())["stock"]
            self.assertEqual(stock["pieces_left_out"], 0)
            self.assertAlmostEqual(stock["blank_cm3"], blank - removed, 3, "what was milled before is gone, in a setup before too")
            self.assertGreater(stock["removed_cm3"], 5)
            removed += stock["removed_cm3"]
            head, *rows = (folder / "points.csv").read_text().splitlines()
            points = []
            for row in rows:
                value = dict(zip(head.split(","), row.split(",")))
                x, y, z = (float(value[f"{axis}_mm"]) for axis in "xyz")
                points.append((value["pass"], z - 1200, y, 1900 - x))  # in both setups the milled side lies at x = 1900 and looks at the arm
            milled[setup].mill(points, radius)
            counted = sum(side.removed for side in milled.values()) / 1e3
            self.assertAlmostEqual(removed, counted, delta=0.005 * removed)
        return {setup: side.removed for setup, side in milled.items()}

    def test_every_strategy_has_a_sample(self):
        schema = json.loads((TOP / "docs" / "schema" / "job.schema.json").read_text())
        strategies = set(schema["properties"]["toolpath"]["properties"]["strategy"]["enum"])
        used = {name for job in (TOP / "toolpaths").glob("*/job.yaml") for name in re.findall(r"^ +strategy: (\w+)", job.read_text(), re.M)}
        self.assertEqual(strategies, used)

    def check_against_sheet(self, name):
        """The arm stands where its sheet says."""
        head, *rows = (self.folder / name / "points.csv").read_text().splitlines()
        columns = head.split(",")
        self.assertGreater(len(rows), 10)
        for row in rows:
            value = dict(zip(columns, row.split(",")))
            place = tip(SHEETS[SHEET_OF[name]], [float(value[f"a{i}_deg"]) for i in range(1, 7)], (-250, 0, 250))
            for axis, at in zip("xyz", place):
                self.assertAlmostEqual(at, float(value[f"{axis}_mm"]), 6, (name, value["point"]))


if __name__ == "__main__":
    unittest.main(argv=["sample_jobs_test"])
