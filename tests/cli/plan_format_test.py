#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""docs/plan-format.md against real plans, by a reader that knows nothing but that page. Usage: plan_format_test.py MILLPOSE TOP"""
import csv
import gzip
import math
import re
import struct
import unittest

from cli_fixture import FEW, JOB, TOP, InFolder, run

PAGE = "\n".join((TOP / "docs" / name).read_text(encoding="utf-8") for name in ("plan-format.md", "plan-format-points.md"))


def tables():
    """{map: {key: (form, optional)}} as the page's tables have them."""
    found = {}
    for section in PAGE.split("\n## ")[1:]:
        rows = re.findall(r"^\| `(\w+)` \| ([^|]*?) \|", section, re.MULTILINE)
        if rows:
            found[section.split("\n")[0]] = {key: (form.removesuffix(", optional"), form.endswith(", optional")) for key, form in rows}
    return found


class Cbor:
    """What the page's section Items says."""

    def __init__(self, data):
        self.data, self.at = data, 0

    def take(self, form):
        value = struct.unpack_from(">" + form, self.data, self.at)[0]
        self.at += struct.calcsize(form)
        return value

    def item(self):
        first = self.take("B")
        if first in (0xf4, 0xf5):
            return first == 0xf5
        if first in (0xf9, 0xfa, 0xfb):
            number = self.take("efd"[first - 0xf9])
            assert first != 0xf9 or not math.isfinite(number)
            if first == 0xfb and math.isfinite(number) and abs(number) < 3e38:
                assert struct.unpack(">f", struct.pack(">f", number))[0] != number, "longer than it needs to be"
            return number
        major, count = first >> 5, first & 31
        if count > 23:
            count = self.take("BHIQ"[count - 24])
        if major in (0, 1):
            return count if major == 0 else -1 - count
        if major == 3:
            self.at += count
            return self.data[self.at - count:self.at].decode("utf-8")
        if major == 4:
            return [self.item() for _ in range(count)]
        assert major == 5, f"an item of major type {major}"
        pairs = [(self.item(), self.item()) for _ in range(count)]
        return dict(pairs)


def whole(data):
    reader = Cbor(data)
    value = reader.item()
    assert reader.at == len(data)
    return value


PLAIN = {"text": str, "number": float, "integer": int, "bool": bool}


def wrong(value, form, maps, path, seen):
    """Where a value is not of a form of the page; `seen` has the tables that were looked at."""
    if form in PLAIN:
        return [] if type(value) is PLAIN[form] else [f"{path}: {form} expected, is {value!r}"]
    if form in ("numbers", "integers", "texts"):
        form = f"[{form[:-1]}]"
    if form == "4x4":
        form = "16 numbers"
    if counted := re.fullmatch(r"(\d+) numbers", form):
        if not isinstance(value, list) or len(value) != int(counted[1]):
            return [f"{path}: {form} expected"]
        form = "[number]"
    if form.startswith("["):
        return [text for i, one in enumerate(value) for text in wrong(one, form[1:-1], maps, f"{path}[{i}]", seen)]
    if form not in maps:
        return [f"{path}: the page has no table {form}"]
    seen.add(form)
    known = [key for key, (_, optional) in maps[form].items() if not optional or key in value]
    if list(value) != known:
        return [f"{path}: keys are {list(value)}, the page has {known}"]
    return [text for key in known for text in wrong(value[key], maps[form][key][0], maps, f"{path}.{key}", seen)]


class Format(InFolder):
    def planned(self, *changes, job=JOB):
        done = run("plan", job, "-o", self.folder / "out", "-q", *[word for change in (*FEW, *changes) for word in ("--set", change)])
        self.assertLess(done.returncode, 2, done.stderr)
        return whole(gzip.decompress((self.folder / "out/plan.cbor.gz").read_bytes()))

    def test_tables_are_what_plans_hold(self):
        cell = (TOP / "cells/kr500_r2830.yaml").read_text(encoding="utf-8")
        coupled = "  coupled_limits_deg: [{a: [0, -1, 1, 0, 0, 0], at_most: 270}]\n  speeds_deg_s:"
        (self.folder / "cell.yaml").write_text(cell.replace("  speeds_deg_s:", coupled), encoding="utf-8")
        rail = run("plan", TOP / "toolpaths/irb6640_rail/job.yaml", "-o", self.folder / "rail", "-q", "--set", "programs=[]")
        self.assertLess(rail.returncode, 2, rail.stderr)
        maps, seen = tables(), set()
        for document in (self.planned("compensation={deflection: normal}", f"cell={self.folder}/cell.yaml"),
                         self.planned("pose={formulation: paper, objective: {name: chen2021}}"),
                         whole(gzip.decompress((self.folder / "rail/plan.cbor.gz").read_bytes()))):
            self.assertEqual(wrong(document, "Plan", maps, "plan", seen)[:5], [])
        self.assertEqual(seen, set(maps))

    def test_figures_are_those_of_points_csv(self):
        document = self.planned()
        points = [point for one in document["passes"] for point in one["points"]]
        with open(self.folder / "out/points.csv", encoding="utf-8", newline="") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual(len(rows), len(points))
        for row, point in zip(rows, points):
            self.assertEqual([float(row[key]) for key in ("x_mm", "y_mm", "z_mm")], point["point"]["position"])
            self.assertEqual(float(row["objective"]), point["objective"])
            for i in range(6):
                self.assertAlmostEqual(float(row[f"a{i + 1}_deg"]), math.degrees(point["q"][i]), 9)
        self.assertEqual([document["X_WP"][i] for i in (12, 13, 14, 15)], [2076, 0, 1006, 1])
        self.assertIn(f"`{document['format']}`", PAGE)


if __name__ == "__main__":
    unittest.main(argv=["plan_format_test"])
