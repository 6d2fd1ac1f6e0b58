#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes the meshes of the sample jobs (binary STL, mm, frame P, closed solids).

make_meshes.py          writes them beside the jobs
make_meshes.py --check  compares the committed files with what would be written; exit status 1 if one differs
"""

import math
import pathlib
import struct
import sys

HERE = pathlib.Path(__file__).resolve().parent


def stl(name, triangles):
    """Bytes of a binary STL; coordinates are rounded to 1e-5 mm first so that the last bit of a sine is no matter."""
    header = f"millpose sample {name}".encode().ljust(80, b" ")
    parts = [header, struct.pack("<I", len(triangles))]
    for a, b, c in triangles:
        u = [b[i] - a[i] for i in range(3)]
        v = [c[i] - a[i] for i in range(3)]
        n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
        length = math.sqrt(sum(x * x for x in n))
        numbers = [round(x / length, 5) + 0.0 for x in n]
        for p in (a, b, c):
            numbers += [round(x, 5) + 0.0 for x in p]
        parts.append(struct.pack("<12fH", *numbers, 0))
    return b"".join(parts)


def quad(a, b, c, d):
    """Two triangles, a-b-c-d counter-clockwise seen from outside."""
    return [(a, b, c), (a, c, d)]


def support_pad():
    """Block 80 x 80 x 40 mm, the face to be milled is its top, P in the middle of it."""
    lo, hi = (-40.0, -40.0, -40.0), (40.0, 40.0, 0.0)
    p = [[[(x, y, z) for z in (lo[2], hi[2])] for y in (lo[1], hi[1])] for x in (lo[0], hi[0])]
    return (quad(p[0][0][1], p[1][0][1], p[1][1][1], p[0][1][1]) + quad(p[0][0][0], p[0][1][0], p[1][1][0], p[1][0][0]) +
            quad(p[0][0][0], p[1][0][0], p[1][0][1], p[0][0][1]) + quad(p[0][1][0], p[0][1][1], p[1][1][1], p[1][1][0]) +
            quad(p[0][0][0], p[0][0][1], p[0][1][1], p[0][1][0]) + quad(p[1][0][0], p[1][1][0], p[1][1][1], p[1][0][1]))


def cabin_ring():
    """Flange ring, diameters 1000 and 900, 40 mm thick; P in the middle of the face, z out of it."""
    count, outer, inner, depth = 180, 500.0, 450.0, -40.0
    triangles = []
    for k in range(count):
        at = [2 * math.pi * j / count for j in (k, (k + 1) % count)]
        o, i = [[(r * math.cos(a), r * math.sin(a)) for a in at] for r in (outer, inner)]
        top_o, top_i = [[(x, y, 0.0) for x, y in ring] for ring in (o, i)]
        low_o, low_i = [[(x, y, depth) for x, y in ring] for ring in (o, i)]
        triangles += quad(top_i[0], top_o[0], top_o[1], top_i[1]) + quad(low_i[0], low_i[1], low_o[1], low_o[0])
        triangles += quad(top_o[0], low_o[0], low_o[1], top_o[1]) + quad(top_i[0], top_i[1], low_i[1], low_i[0])
    return triangles


class CabinPanel:
    """Outer skin of radius 1500 mm, 900 mm along the arc (y), 600 mm along the cabin's axis (x), 8 mm thick, with a
    window (rounded corners) and three pads raised by 6 mm; P in the middle of the outer skin, z outwards.

    A grid over (x, s), s the arc length at the outer skin, with grid lines through every border; in the window's
    corners its rows follow the rounding."""

    RADIUS, THICK, RAISED = 1500.0, 8.0, 6.0
    HALF_X, HALF_S = 300.0, 450.0
    WINDOW = (-110.0, 90.0, -150.0, 150.0)  # x from, to, s from, to
    CORNER = 60.0
    PADS = [(-240.0, -160.0, -340.0, -220.0), (160.0, 240.0, -60.0, 60.0), (-50.0, 30.0, 260.0, 380.0)]

    def __init__(self):
        x0, x1, s0, s1 = self.WINDOW
        rounding = [self.CORNER * (1 - math.cos(math.radians(15 * k))) for k in range(7)]
        self.xs = self.lines([-self.HALF_X, self.HALF_X, x0, x0 + self.CORNER, x1 - self.CORNER, x1] +
                             [x for pad in self.PADS for x in pad[:2]], 60.0)
        s_fixed = [s0 + d for d in rounding] + [s1 - d for d in rounding] + [s for pad in self.PADS for s in pad[2:]]
        self.ss = self.lines([-self.HALF_S, self.HALF_S] + s_fixed, 20.0)
        self.triangles = []

    @staticmethod
    def lines(fixed, largest):
        """The fixed lines and as many between them that none are farther apart than `largest`."""
        fixed = sorted(set(round(x, 9) for x in fixed))
        result = [fixed[0]]
        for a, b in zip(fixed, fixed[1:]):
            n = math.ceil((b - a) / largest - 1e-9)
            result += [a + (b - a) * k / n for k in range(1, n)] + [b]
        return result

    def point(self, x, s, radius):
        angle = s / self.RADIUS
        return (x, radius * math.sin(angle), radius * math.cos(angle) - self.RADIUS)

    def outer(self, i, j):
        """Radius of the outer skin over a cell."""
        x, s = (self.xs[i] + self.xs[i + 1]) / 2, (self.ss[j] + self.ss[j + 1]) / 2
        raised = any(a < x < b and c < s < d for a, b, c, d in self.PADS)
        return self.RADIUS + (self.RAISED if raised else 0.0)

    def cell(self, i, j):
        """Corners (x, s) of a cell, counter-clockwise seen from outside; None when it lies in the window."""
        xa, xb, sa, sb = self.xs[i], self.xs[i + 1], self.ss[j], self.ss[j + 1]
        x0, x1, s0, s1 = self.WINDOW
        if not (x0 <= xa and xb <= x1 and s0 <= sa and sb <= s1):
            return [(xa, sa), (xb, sa), (xb, sb), (xa, sb)]
        r = self.CORNER
        reach = []  # how far the corner's material reaches into the window at both rows
        for s in (sa, sb):
            d = min(s - s0, s1 - s)
            reach.append(r - math.sqrt(max(0.0, r * r - (r - d) ** 2)) if d < r else 0.0)
        if max(reach) < 1e-9:
            return None
        if xb <= x0 + r + 1e-9:
            corners = [(xa, sa), (xa + reach[0], sa), (xa + reach[1], sb), (xa, sb)]
        elif xa >= x1 - r - 1e-9:
            corners = [(xb - reach[0], sa), (xb, sa), (xb, sb), (xb - reach[1], sb)]
        else:
            return None
        return [p for k, p in enumerate(corners) if math.dist(p, corners[k - 1]) > 1e-9]

    def build(self):
        edges = {}  # directed border of a cell, by its rounded ends -> ends, radius of the outer skin there

        def key(p):
            return (round(p[0], 6), round(p[1], 6))

        for i in range(len(self.xs) - 1):
            for j in range(len(self.ss) - 1):
                corners = self.cell(i, j)
                if corners is None:
                    continue
                radius = self.outer(i, j)
                for k in range(1, len(corners) - 1):
                    three = (corners[0], corners[k], corners[k + 1])
                    self.triangles.append(tuple(self.point(*p, radius) for p in three))
                    self.triangles.append(tuple(self.point(*p, self.RADIUS - self.THICK) for p in reversed(three)))
                for k, p in enumerate(corners):
                    q = corners[(k + 1) % len(corners)]
                    edges[key(p), key(q)] = (p, q, radius)
        for p, q, radius in edges.values():
            # Nothing beside: a wall down to the inner skin.
            beside = edges.get((key(q), key(p)), (q, p, self.RADIUS - self.THICK))[2]
            if beside < radius:
                self.triangles += quad(self.point(*q, radius), self.point(*p, radius), self.point(*p, beside),
                                       self.point(*q, beside))
        return self.triangles


def cabin_barrel():
    """Barrel section, diameter 2400 mm, 500 mm high, skin of 12 mm, with six lands raised by 6 mm around it, each 8
    degrees wide and 96 mm high; P in the middle of its lower end, z along its axis."""
    skin, inner, raised, height = 1200.0, 1188.0, 1206.0, 500.0
    lands, half, rows = 6, 4.0, [0.0, 202.0, 298.0, height]
    angles = []
    for k in range(lands):
        angles += [360.0 / lands * k - half + 0.5 * j for j in range(16)]  # chords within 0.012 mm of the arc
        first, width = 360.0 / lands * k + half, 360.0 / lands - 2 * half
        angles += [first + width * j / 8 for j in range(8)]
    count = len(angles)

    def point(radius, column, z):
        turn = math.radians(angles[column % count])
        return (radius * math.cos(turn), radius * math.sin(turn), z)

    def outer(column, row):
        """Radius of the skin over a cell."""
        return raised if row == 1 and column % count % 24 < 16 else skin

    triangles = []
    for c in range(count):
        d = c + 1
        for r in range(3):
            low, high, radius = rows[r], rows[r + 1], outer(c, r)
            triangles += quad(point(radius, c, low), point(radius, d, low), point(radius, d, high), point(radius, c, high))
            triangles += quad(point(inner, c, low), point(inner, c, high), point(inner, d, high), point(inner, d, low))
            if outer(d, r) < radius:  # a land's end
                triangles += quad(point(radius, d, low), point(skin, d, low), point(skin, d, high), point(radius, d, high))
            if outer(c - 1, r) < radius:
                triangles += quad(point(skin, c, low), point(radius, c, low), point(radius, c, high), point(skin, c, high))
        if outer(c, 1) > skin:
            low, high = rows[1], rows[2]
            triangles += quad(point(skin, c, low), point(skin, d, low), point(raised, d, low), point(raised, c, low))
            triangles += quad(point(raised, c, high), point(raised, d, high), point(skin, d, high), point(skin, c, high))
        triangles += quad(point(inner, c, 0.0), point(inner, d, 0.0), point(skin, d, 0.0), point(skin, c, 0.0))
        triangles += quad(point(inner, c, height), point(skin, c, height), point(skin, d, height), point(inner, d, height))
    return triangles


def rounded(half_x, half_y, radius):
    """A rectangle about the origin with rounded corners, counter-clockwise, 15 degrees from corner to corner of an arc."""
    result = []
    for k, (x, y) in enumerate(((1, 1), (-1, 1), (-1, -1), (1, -1))):
        for j in range(7):
            turn = math.radians(90 * k + 15 * j)
            result.append((x * (half_x - radius) + radius * math.cos(turn), y * (half_y - radius) + radius * math.sin(turn)))
    return result


def at_angles(outline, angles):
    """Where rays from the origin meet a convex outline round it."""
    points = []
    for angle in angles:
        dx, dy = math.cos(angle), math.sin(angle)
        for (ax, ay), (bx, by) in zip(outline, outline[1:] + outline[:1]):
            before, after = (dx * y - dy * x for x, y in ((ax, ay), (bx, by)))
            if before <= 1e-9 < after:
                share = before / (before - after)
                points.append((ax + share * (bx - ax), ay + share * (by - ay)))
    assert len(points) == len(angles)
    return points


def cabin_pocket():
    """Panel 180 x 130 x 36 mm with a pocket of 140 x 90 mm in its face, 20 mm deep, corners of 12 mm, and one of 120 x 70 mm in its back, 8 mm deep,
    corners of 22 mm; P in the middle of the face, z out of it. All outlines have corners at the same angles, so that faces meet corner to corner."""
    back, floor, back_floor = -36.0, -20.0, -28.0
    block = [(90.0, 65.0), (-90.0, 65.0), (-90.0, -65.0), (90.0, -65.0)]
    pocket, relief = rounded(70.0, 45.0, 12.0), rounded(60.0, 35.0, 22.0)
    angles = sorted(math.atan2(y, x) % (2 * math.pi) for x, y in block + pocket + relief)
    angles = [angle for k, angle in enumerate(angles) if k == 0 or angle - angles[k - 1] > 1e-7]
    block, pocket, relief = (at_angles(outline, angles) for outline in (block, pocket, relief))
    triangles = []
    for k in range(len(angles)):
        after = (k + 1) % len(angles)
        o, p, w, q, r, v = block[k], pocket[k], relief[k], block[after], pocket[after], relief[after]
        triangles += quad((*o, 0.0), (*q, 0.0), (*r, 0.0), (*p, 0.0)) + quad((*p, 0.0), (*r, 0.0), (*r, floor), (*p, floor))
        triangles += quad((*o, back), (*q, back), (*q, 0.0), (*o, 0.0)) + quad((*q, back), (*o, back), (*w, back), (*v, back))
        triangles += quad((*v, back), (*w, back), (*w, back_floor), (*v, back_floor))
        triangles += [((*p, floor), (*r, floor), (0.0, 0.0, floor)), ((*v, back_floor), (*w, back_floor), (0.0, 0.0, back_floor))]
    return triangles


def main():
    check = sys.argv[1:] == ["--check"]
    if sys.argv[1:] and not check:
        sys.exit("usage: make_meshes.py [--check]")
    differing = []
    for name, triangles in (("support_pad", support_pad()), ("cabin_panel", CabinPanel().build()),
                            ("cabin_ring", cabin_ring()), ("cabin_barrel", cabin_barrel()),
                            ("cabin_pocket", cabin_pocket())):
        path = HERE / name / f"{name}.stl"
        content = stl(name, triangles)
        if check:
            if not path.is_file() or path.read_bytes() != content:
                differing.append(str(path))
        else:
            path.parent.mkdir(exist_ok=True)
            path.write_bytes(content)
    if differing:
        sys.exit("differs from what make_meshes.py writes: " + ", ".join(differing))


if __name__ == "__main__":
    main()
