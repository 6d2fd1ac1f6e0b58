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


class SampleJobs(InFolder):
    def test_small_samples_plan_whole(self):
        for name in SMALL:
            with self.subTest(job=name):
                result = run("plan", TOP / "toolpaths" / name / "job.yaml", "-o", self.folder / name, "-q")
                self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
                summary = json.loads((self.folder / name / "summary.json").read_text())
                self.assertEqual(summary["points"]["planned"], summary["points"]["total"])
                self.assertTrue(summary["programs"] and all(p["verified"] for p in summary["programs"]))

    def test_every_strategy_has_a_sample(self):
        schema = json.loads((TOP / "docs" / "schema" / "job.schema.json").read_text())
        strategies = set(schema["properties"]["toolpath"]["properties"]["strategy"]["enum"])
        used = {name for job in (TOP / "toolpaths").glob("*/job.yaml") for name in re.findall(r"^ +strategy: (\w+)", job.read_text(), re.M)}
        self.assertEqual(strategies, used)

    def test_arms_stand_where_their_sheets_say(self):
        for cell, sheet in SHEETS.items():
            job = TOP / "toolpaths" / {"irb6640_185_280": "irb6640_pad", "r2000ic_165f": "r2000ic_contours"}[cell] / "job.yaml"
            result = run("plan", job, "-o", self.folder / cell, "-q")
            self.assertEqual(result.returncode, 0, result.stderr)
            head, *rows = (self.folder / cell / "points.csv").read_text().splitlines()
            columns = head.split(",")
            self.assertGreater(len(rows), 10)
            for row in rows:
                value = dict(zip(columns, row.split(",")))
                place = tip(sheet, [float(value[f"a{i}_deg"]) for i in range(1, 7)], (-250, 0, 250))
                for axis, at in zip("xyz", place):
                    self.assertAlmostEqual(at, float(value[f"{axis}_mm"]), 6, (cell, value["point"]))


if __name__ == "__main__":
    unittest.main(argv=["sample_jobs_test"])
