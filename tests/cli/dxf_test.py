#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Lines of a DXF as toolpath.curve, beside the same lines as points. Usage: dxf_test.py MILLPOSE TOP"""
import csv
import math
import random
import unittest

from cli_fixture import TOP, InFolder, run

JOB = TOP / "toolpaths/support_curve/job.yaml"
CORNERS = [(-30, -30), (0, 20), (30, -30)]


def pairs(*items):
    return "".join(f"{code}\n{value}\n" for code, value in items)


def dxf(*entities, unit=4):
    header = pairs((0, "SECTION"), (2, "HEADER"), (9, "$ACADVER"), (1, "AC1015"), (9, "$INSUNITS"), (70, unit), (0, "ENDSEC"))
    return header + pairs((0, "SECTION"), (2, "ENTITIES")) + "".join(entities) + pairs((0, "ENDSEC"), (0, "EOF"))


def line(a, b, layer="0"):
    return pairs((0, "LINE"), (8, layer), (10, a[0]), (20, a[1]), (30, 10), (11, b[0]), (21, b[1]), (31, 10))


def light(points, bulges=None, closed=0, height=10, more=()):
    vertices = [item for i, (x, y) in enumerate(points)
                for item in ((10, x), (20, y), *([(42, bulges[i])] if bulges else ()))]
    return pairs((0, "LWPOLYLINE"), (8, "0"), (90, len(points)), (70, closed), (38, height), *vertices, *more)


class Dxf(InFolder):
    def setUp(self):
        super().setUp()
        text = JOB.read_text(encoding="utf-8").replace("../../cells", str(TOP / "cells"))
        self.text = text.replace("../support_pad", str(TOP / "toolpaths/support_pad"))

    def plan(self, drawing, more="", keep=None):
        (self.folder / "lines.dxf").write_text(drawing, encoding="utf-8")
        points = "points_mm: [[-30, -30, 10], [0, 20, 10], [30, -30, 10]]"
        self.assertIn(points, self.text)
        job = self.text if keep else self.text.replace(points, f"dxf: {{file: lines.dxf{more}}}")
        (self.folder / "job.yaml").write_text(job, encoding="utf-8")
        return run("plan", self.folder / "job.yaml", "-o", self.folder / "out", "-q", "--set", "programs=[]")

    def points(self, *arguments, **options):
        done = self.plan(*arguments, **options)
        self.assertLess(done.returncode, 2, done.stderr)
        with open(self.folder / "out/points.csv", encoding="utf-8", newline="") as file:
            return [(row["pass"], row["kind"], row["x_mm"], row["y_mm"], row["z_mm"]) for row in csv.DictReader(file)]

    def in_part(self, points):
        """Of the cut points: x, y in the part's frame. Its pose is xyz 2076 0 1006, turned by -90 deg about y."""
        return [(float(z) - 1006, float(y)) for _, kind, _, y, z in points if kind == "cut"]

    def refused(self, drawing, words, more=""):
        done = self.plan(drawing, more)
        self.assertEqual(done.returncode, 2, done.stdout)
        self.assertIn(words, done.stderr)

    def test_lines_are_those_of_the_points(self):
        wanted = self.points("", keep=True)
        a, b, c = CORNERS
        self.assertEqual(self.points(dxf(light(CORNERS))), wanted)
        self.assertEqual(self.points(dxf(line(a, b), line(b, c))), wanted)
        self.assertEqual(self.points(dxf(line(a, b), line(c, b))), wanted)  # joined end to end
        three = pairs((0, "POLYLINE"), (8, "0"), (66, 1), (70, 8))
        three += "".join(pairs((0, "VERTEX"), (8, "0"), (10, x), (20, y), (30, 10), (70, 32)) for x, y in CORNERS)
        self.assertEqual(self.points(dxf(three, pairs((0, "SEQEND")))), wanted)
        inches = [(x / 25.4, y / 25.4) for x, y in CORNERS]
        for got, want in zip(self.points(dxf(light(inches, height=10 / 25.4), unit=1)), wanted):
            self.assertEqual(got[:2], want[:2])
            for x, y in zip(got[2:], want[2:]):
                self.assertAlmostEqual(float(x), float(y), 6)
        self.assertEqual(self.points(dxf(light(CORNERS), unit=0), ", unit: mm"), wanted)
        # A plane seen from below: its x runs against the world's.
        mirrored = [(-x, y) for x, y in CORNERS]
        self.assertEqual(self.points(dxf(light(mirrored, height=-10, more=((210, 0), (220, 0), (230, -1))))), wanted)
        other = dxf(line(a, b, "cut"), line(b, c, "cut"), line((-20, 0), (-10, 0), "mark"), pairs((0, "TEXT"), (8, "cut"), (1, "7")))
        self.assertEqual(self.points(other, ", layers: [cut]"), wanted)
        self.assertGreater(len(self.points(other)), len(wanted))

    def test_arcs_are_round(self):
        half = 1.0  # bulge of a half circle to the left
        circle = pairs((0, "CIRCLE"), (8, "0"), (10, 2), (20, -3), (30, 10), (40, 25))
        arc = pairs((0, "ARC"), (8, "0"), (10, 2), (20, -3), (30, 10), (40, 25), (50, 350), (51, 100))
        for drawing, first, turn in ((light([(27, -3), (-23, -3)], [half, 0]), 0, 180), (light([(-23, -3), (27, -3)], [-half, 0]), 180, -180),
                                     (light([(27, -3), (-23, -3)], [half, half], closed=1), 0, 360), (circle, 0, 360), (arc, 350, 110)):
            points = self.in_part(self.points(dxf(drawing)))
            self.assertGreater(len(points), 5)
            angles = [math.degrees(math.atan2(y + 3, x - 2)) for x, y in points]
            for x, y in points:
                self.assertLess(abs(math.hypot(x - 2, y + 3) - 25), 0.02)
            turned = sum((b - a + 180) % 360 - 180 for a, b in zip(angles, angles[1:]))
            self.assertLess(abs((angles[0] - first + 180) % 360 - 180), 1)
            self.assertLess(abs(turned - turn), 25 if abs(turn) == 360 else 1, drawing)

    def test_what_is_wrong_is_told_with_its_line(self):
        sound = dxf(light(CORNERS))
        self.refused(dxf(light(CORNERS), unit=0), "the file states no unit ($INSUNITS); give toolpath.curve.dxf.unit")
        self.refused(sound, "the file states that its unit is 1 mm, given 25.4 mm", ", unit: in")
        self.refused(dxf(light(CORNERS), unit=3), "$INSUNITS is 3; allowed: 1 (in), 2 (foot), 4 (mm)")
        self.refused(sound, 'no layer "1"', ", layers: ['1']")
        self.refused(dxf(pairs((0, "SPLINE"), (8, "0"))), "lines.dxf:20: SPLINE is not read; allowed: LINE, LWPOLYLINE")
        self.refused(dxf(line((0, 0), (1, "x"))), "LINE: code 21 is x")
        self.refused(dxf(pairs((0, "CIRCLE"), (8, "0"), (10, 0), (20, 0))), "CIRCLE: code 40 is missing")
        self.refused(dxf(), "the file holds no line")
        self.refused(sound[:-6], "cut off")
        self.refused("solid x\n", "the number of a code")
        self.refused("AutoCAD Binary DXF\r\n\x1a", "this is a binary DXF")
        done = self.plan(sound, "}, points_mm: [[0, 0, 0], [1, 0, 0]], dxf: {file: lines.dxf")
        self.assertEqual(done.returncode, 2)

    def test_damage_is_an_error_or_a_path(self):
        sound = dxf(light(CORNERS), pairs((0, "CIRCLE"), (8, "0"), (10, 2), (20, -3), (30, 10), (40, 25)))
        stream = random.Random(3)
        for i in range(15):
            at = stream.randrange(len(sound))
            self.assertIn(self.plan(sound[:at] + stream.choice("0-9.\nx") + sound[at + stream.randrange(3):]).returncode, (0, 1, 2), i)


if __name__ == "__main__":
    unittest.main(argv=["dxf_test"])
