#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Strategies of the shop from a job file to programs: holes, trimmed contours. Usage: shop_test.py MILLPOSE TOP"""
import csv
import json
import math
import re
import unittest

from cli_fixture import TOP, InFolder, run, tree

CELL = TOP / "cells" / "kr500_r2830.yaml"
CENTRE = ", centre_cutting: true"


def sample(name):
    text = (TOP / "toolpaths" / name / "job.yaml").read_text()
    return re.sub(r"(?<=[ :])\.\./", f"{TOP}/toolpaths/", text).replace(f"{TOP}/toolpaths/../cells", str(TOP / "cells"))


def quick_trim():
    """The sample in one round, with few points."""
    return sample("cabin_trim").replace("per_depth_mm: 5", "per_depth_mm: 20").replace("spacing_mm: 25", "spacing_mm: 80").replace("chord_tolerance_mm: 0.02", "chord_tolerance_mm: 0.05")


class Shop(InFolder):
    def plan(self, text, out="out"):
        (self.folder / "job.yaml").write_text(text)
        return run("plan", self.folder / "job.yaml", "-o", self.folder / out, "-q", "-v", "--set", "path.rotation_step_deg=20")

    def points(self, out="out"):
        with (self.folder / out / "points.csv").open() as file:
            return list(csv.DictReader(file))

    def check_programs(self):
        verified = run("verify", self.folder / "out", "--cell", CELL)
        self.assertEqual(verified.returncode, 0, verified.stdout)
        for controller in ("krl", "sinumerik", "linuxcnc"):
            self.assertTrue(list((self.folder / "out" / "programs" / controller).iterdir()))
            self.assertRegex(verified.stdout, rf"{controller} +\d+ motions  confirmed")

    def test_holes_are_planned_to_programs_of_all_controllers(self):
        planned = self.plan(sample("cabin_holes"))
        self.assertEqual(planned.returncode, 0, planned.stderr)
        self.assertIn("mm/N  drilling", planned.stdout)
        self.check_programs()
        # The text as resolved says the same.
        again = run("plan", self.folder / "out" / "job.yaml", "-o", self.folder / "again", "-q")
        self.assertEqual(again.returncode, 0, again.stderr)
        first, second = tree(self.folder / "out"), tree(self.folder / "again")
        self.assertEqual(first["points.csv"], second["points.csv"])
        self.assertEqual(first["programs/krl/cabin_holes.src"].split(b"units")[1], second["programs/krl/cabin_holes.src"].split(b"units")[1])

    def test_the_feed_of_a_drill_is_the_one_into_the_material(self):
        text = sample("cabin_holes")
        self.assertIn("feed_mm_min: 120 ", text)
        beside = self.plan(text.replace("feed_mm_min: 120 ", "plunge_feed_mm_min: 120\n  feed_mm_min: 300 "))
        self.assertEqual(beside.returncode, 2, beside.stdout)
        self.assertRegex(beside.stderr, r"job\.yaml:\d+:3: process\.feed_mm_min: has no effect here: holes are drilled at plunge_feed_mm_min, 120; given 300; allowed: the same, or feed_mm_min alone")
        self.assertEqual(self.plan(text.replace("feed_mm_min: 120 ", "plunge_feed_mm_min: 120\n  feed_mm_min: 120 "), "both").returncode, 0)
        self.assertEqual(self.plan(text).returncode, 0)
        self.assertEqual(*((self.folder / out / "points.csv").read_bytes() for out in ("both", "out")))
        text = (self.folder / "out" / "programs" / "sinumerik" / "cabin_holes.mpf").read_text()
        feeds = {float(feed) for feed in re.findall(r"\bF=?(\d+(?:\.\d+)?)", text)}
        self.assertLessEqual({120.0, 2000.0}, feeds)

    def test_a_drill_has_its_thrust(self):
        cutting = "  cutting: {material: AlMgSi, teeth: 2}\nprograms: [krl, sinumerik, linuxcnc]"
        text = sample("cabin_holes").replace("programs: [krl, sinumerik, linuxcnc]", cutting).replace("peck_mm: 4", "peck_mm: 4\n    point_deg: 118")
        planned = self.plan(text)
        self.assertEqual(planned.returncode, 0, planned.stderr)
        self.assertIn("mm/N  drilling", planned.stdout, "the objective stays")
        self.check_programs()
        # 120 mm/min at 1500 rpm: 0.04 mm a lip, h = 0.04 sin 59 deg.
        diameter = float(re.search(r"cutter: \{shape: flat, diameter_mm: (\d+)", CELL.read_text()).group(1))
        sine = math.sin(math.radians(59))
        thrust = 0.63 * (diameter / 2) * 0.08 * 800 * (0.04 * sine) ** -0.25 * sine
        points = {int(row["point"]): row for row in self.points()}
        with (self.folder / "out" / "deflection.csv").open() as file:
            rows = list(csv.DictReader(file))
        cut = [row for row in rows if row["side"] != "air"]
        self.assertEqual({row["side"] for row in cut}, {"slot"})
        self.assertTrue(0 < len(cut) < len(rows), "out of the hole and down again nothing is cut")
        bottoms = 0
        for row in cut:
            point = points[int(row["point"])]
            force = [float(row[f"force_{axis}_N"]) for axis in "xyz"]
            self.assertLessEqual(math.hypot(*force), thrust * (1 + 1e-9))
            self.assertGreater(float(row["normal_um"]), 0, "it bends the tool out of the hole")
            bottoms += math.hypot(*force) > thrust * (1 - 1e-9)
        self.assertGreaterEqual(bottoms, 8, "every hole is as deep as the point is long")
        summary = json.loads((self.folder / "out" / "summary.json").read_text())
        self.assertAlmostEqual(summary["deflection"]["mean_force_N"]["axial"], thrust, 6)
        self.assertIsNone(summary["deflection"]["level_mm"], "holes are no face")
        budget = {row["source"]: row["um"] for row in summary["budget"]["rows"]}
        self.assertAlmostEqual(budget["static_compliance"], max(abs(float(row["normal_um"])) for row in cut), 6)

    def test_what_a_drill_does_not_know_of_a_milling_cut_is_refused(self):
        own = "cutting: {material: AlMgSi, teeth: 2}"
        for changed, told in ((own[:-1] + ", depth_mm: 1}", r"process\.cutting\.depth_mm: has no effect with strategy drill"),
                              (own[:-1] + ", side: slot}", r"process\.cutting\.side: has no effect with strategy drill"),
                              (own[:-1] + ", axial_ratio: 0.5}", r"process\.cutting\.axial_ratio: has no effect with strategy drill"),
                              (own + "\n  force_factors: {up: 1.2}", r"process\.force_factors: has no effect with strategy drill"),
                              (own + "\npath: {over_missing: cut}", r"path\.over_missing: has no effect here"),
                              (own + "\npose: {objective: {name: face_error}}", r"pose\.objective: has no effect with strategy drill: it leaves no face"),
                              (own + "\ncompensation: {deflection: normal}", r"compensation\.deflection: has no effect with strategy drill"),
                              (own + "\n  stock: mesh", r"process\.stock: given mesh; the job needs workpiece\.stock")):
            planned = self.plan(sample("cabin_holes").replace("programs: [", f"  {changed}\nprograms: ["))
            self.assertEqual(planned.returncode, 2, changed)
            self.assertRegex(planned.stderr, told)
        sink = sample("cabin_holes").replace("    peck_mm: 4\n", "    countersink: {depth_mm: 2}\n").replace("    depth_mm: 10", "    # ")
        planned = self.plan(sink.replace("programs: [", f"  {own}\nprograms: ["))
        self.assertEqual(planned.returncode, 2, planned.stdout)
        self.assertRegex(planned.stderr, r"job\.yaml:\d+:3: process\.cutting: has no effect here: of the force of strategy drill nothing is known")
        planned = self.plan(sink.replace("programs: [", "compensation: {deflection: normal}\nprograms: ["))
        self.assertRegex(planned.stderr, r"compensation\.deflection: has no effect with strategy drill")

    def test_the_tool_stands_at_the_bottom(self):
        one_hole = re.sub(r"(      - \{at_mm: .*\n){7}", "", sample("cabin_holes"), count=1)
        self.assertEqual(self.plan(one_hole).returncode, 0)
        without = {times["controller"]: times["total_s"] for times in json.loads((self.folder / "out" / "summary.json").read_text())["cycle_times"]}
        self.assertEqual(self.plan(one_hole.replace("peck_mm: 4", "peck_mm: 4\n    dwell_s: 0.75")).returncode, 0)
        self.check_programs()
        for times in json.loads((self.folder / "out" / "summary.json").read_text())["cycle_times"]:
            self.assertAlmostEqual(times["total_s"], without[times["controller"]] + 0.75, places=3)
        for program, stop_and_dwell in (("krl/cabin_holes.src", r"LIN \{[^}]*\}\nWAIT SEC 0\.75\n"), ("sinumerik/cabin_holes.mpf", r"\nG9 G1 [^\n]*\nG4 F0\.75\n"),
                                        ("linuxcnc/cabin_holes.ngc", r"G61\.1\n(?:G1 [^\n]*\n)+G4 P0\.75\n")):
            text = (self.folder / "out" / "programs" / program).read_text()
            self.assertEqual(len(re.findall(stop_and_dwell, text)), 1, program)

    def test_a_tool_that_cannot_plunge_and_comes_down_on_material_is_told_of(self):
        pad = sample("support_pad").replace("mesh: ", f"mesh: {TOP}/toolpaths/support_pad/")
        cell = CELL.read_text()
        self.assertIn(CENTRE, cell)
        (self.folder / "cell.yaml").write_text(cell.replace(CENTRE, ""))
        own = pad.replace(str(CELL), "cell.yaml")
        for text, told in ((own, True), (pad, False), (own.replace("  stepover_mm: 8", "  ends: {overrun_mm: 11}\n  stepover_mm: 8"), False)):
            planned = self.plan(text)
            self.assertEqual(planned.returncode, 0, planned.stderr)
            self.assertEqual("the tool comes straight down on material at 1 of 10 entries, first at point 0 (pass 0)" in planned.stdout, told, planned.stdout[:2000])

    def test_a_program_of_holes_stands_by_itself(self):
        """Where the tool turns back, or goes on slower, it stops."""
        self.assertEqual(self.plan(re.sub(r"(      - \{at_mm: .*\n){7}", "", sample("cabin_holes"), count=1)).returncode, 0)
        for program in ("krl/cabin_holes.src", "sinumerik/cabin_holes.mpf", "linuxcnc/cabin_holes.ngc"):
            alone = run("verify", self.folder / "out" / "programs" / program, "--cell", CELL)
            self.assertEqual(alone.returncode, 0, alone.stdout)
            self.assertRegex(alone.stdout, r"\d motions  confirmed")

    def test_a_hole_is_drilled_whole_or_not_at_all(self):
        # One hole far away, one whose bottom alone is out of reach: the others are made.
        text = re.sub(r"(?m)^ {4}holes:\n", "    holes:\n      - {at_mm: [0, 0, 9000], axis: [0, 0, 1]}\n", sample("cabin_holes"))
        planned = self.plan(text)
        self.assertEqual(planned.returncode, 1, planned.stdout)
        points = self.points()
        self.assertEqual({p["status"] for p in points if p["pass"] == "0"}, {"skipped"})
        self.assertEqual({p["status"] for p in points if p["pass"] != "0"}, {"planned"})
        self.check_programs()

        deep = sample("cabin_holes").replace("depth_mm: 10", "depth_mm: 900").replace("peck_mm: 4", "peck_mm: 900").replace(
            "  spacing_mm: 5", "  spacing_mm: 100")
        deep = re.sub(r"(?m)^ {6}- .*\n", "", deep).replace("    holes:\n", "    holes:\n      - {at_mm: [-145, 0, 0], axis: [0, 0, 1]}\n")
        planned = self.plan(deep, "deep")
        self.assertEqual(planned.returncode, 1, planned.stdout)
        summary = json.loads((self.folder / "deep" / "summary.json").read_text())
        self.assertEqual(summary["points"]["planned"], 0)
        self.assertIn("incomplete", {entry["reason"] for entry in summary["skipped"]})

    def test_holes_of_a_part_are_found_and_listed(self):
        (self.folder / "block.off").write_text(self.bored_block())
        listed = json.loads(run("check", self.folder / "block.off", "--unit", "mm", "--json").stdout)
        self.assertEqual(listed["round_holes"], [{"diameter_mm": 20.0, "through": 1, "blind": 0, "in_sheet": 0}])
        holes = "    circles: {diameter_mm: 20, from: [0, 0, 1]}\n    breakthrough_mm: 1\n"
        text = re.sub(r"(?m)^ {4}holes:\n(?: {6}.*\n)+ {4}depth_mm.*\n", holes, sample("cabin_holes"))
        text = re.sub(r"mesh: .*", f"mesh: {self.folder}/block.off", text)
        planned = self.plan(text)
        self.assertEqual(planned.returncode, 0, planned.stdout + planned.stderr)
        off = [math.hypot(float(p["x_mm"]) - float(self.points()[0]["x_mm"]), 0) for p in self.points()]
        self.assertAlmostEqual(max(off), 23 + 1, places=3, msg="3 mm over the entrance, 20 through, 1 beyond")

    @staticmethod
    def bored_block():
        """100 mm across, 20 mm thick, a hole of 20 mm through its middle."""
        count = 48
        rings = [(r, z) for r, z in ((10, -20), (50, -20), (50, 0), (10, 0))]
        lines = [f"{r * math.cos(2 * math.pi * k / count)!r} {r * math.sin(2 * math.pi * k / count)!r} {z}"
                 for r, z in rings for k in range(count)]
        faces = []
        for ring in range(4):
            a, b = ring * count, (ring + 1) % 4 * count
            for k in range(count):
                n = (k + 1) % count
                faces += [f"3 {a + k} {a + n} {b + n}", f"3 {a + k} {b + n} {b + k}"]
        return "\n".join(["OFF", f"{len(lines)} {len(faces)} 0", *lines, *faces]) + "\n"

    def test_a_window_is_cut_out_down_its_ramp_alone(self):
        planned = self.plan(quick_trim())
        self.assertEqual(planned.returncode, 0, planned.stdout + planned.stderr)
        self.check_programs()
        again = run("plan", self.folder / "out" / "job.yaml", "-o", self.folder / "again", "-q")
        self.assertEqual(again.returncode, 0, again.stderr)
        self.assertEqual(tree(self.folder / "out")["points.csv"], tree(self.folder / "again")["points.csv"])
        # In the robot's base the skin's normal leads to -x, near enough beside the lead-in.
        rows = [p for p in self.points() if p["kind"] == "lead-in"]
        places = [tuple(float(p[key]) for key in ("x_mm", "y_mm", "z_mm")) for p in rows]
        down = [(b[0] - a[0], math.hypot(b[1] - a[1], b[2] - a[2])) for a, b in zip(places, places[1:])]
        self.assertGreater(sum(x for x, _ in down), 5, "from over the skin to the first round's depth")
        self.assertLess(max(x / way for x, way in down), math.tan(math.radians(5)) * 1.05 + 0.1, "the axis leans by the skin's slope")

    def test_a_cutter_goes_down_only_as_it_says_it_can(self):
        text = quick_trim().replace(str(CELL), "cell.yaml")
        one = CELL.read_text().replace(CENTRE, "")
        for cell, change, said in (
            (one, ("ramp_deg: 3", "ramp_deg: 4"), r"job\.yaml:\d+:\d+: toolpath\.trim\.ramp_deg: given 4; allowed: at most tool\.cutter\.max_ramp_deg, 3"),
            (one.replace("cutting_length_mm: 40}", "cutting_length_mm: 40, max_ramp_deg: 4}"), ("ramp_deg: 3", "ramp_deg: 4"), None),
            (one, ("ramp_deg: 3", "ramp_deg: 3\n    entry: plunge"), r"toolpath\.trim\.entry: given plunge, but the tool says nothing of centre_cutting"),
            (CELL.read_text(), ("ramp_deg: 3", "ramp_deg: 3\n    entry: plunge"), None),
        ):
            with self.subTest(said or "allowed"):
                (self.folder / "cell.yaml").write_text(cell)
                told = self.plan(text.replace(*change))
                self.assertEqual(told.returncode, 2 if said else 0, told.stdout + told.stderr)
                self.assertRegex(told.stderr, said or "^$")

    def test_passes_are_entered_along_themselves(self):
        pad = (TOP / "toolpaths" / "support_pad" / "job.yaml").read_text().replace("../../cells", str(TOP / "cells"))
        pad = pad.replace("support_pad.stl", str(TOP / "toolpaths" / "support_pad" / "support_pad.stl"))
        pad = pad.replace("stepover_mm: 8", "stepover_mm: 27\n  ends: {lead: along, lead_length_mm: 1.5, ramp_deg: 3}").replace("spacing_mm: 4", "spacing_mm: 10")
        planned = self.plan(pad)
        self.assertEqual(planned.returncode, 0, planned.stdout + planned.stderr)
        points = self.points()
        self.assertEqual({row["status"] for row in points}, {"planned"})
        passes = {}
        for row in points:
            passes.setdefault(row["pass"], []).append(row)
        for rows in passes.values():
            down = [row for row in rows if row["kind"] == "lead-in"] + [next(row for row in rows if row["kind"] == "cut")]
            self.assertGreater(len(down), 2)
            place = [[float(row[c]) for c in ("x_mm", "y_mm", "z_mm", "nx", "ny", "nz")] for row in down]
            for a, b in zip(place, place[1:]):
                step = [q - p for p, q in zip(a[:3], b[:3])]
                drop = -sum(s * n for s, n in zip(step, a[3:]))
                across = math.sqrt(max(0, sum(s * s for s in step) - drop * drop))
                self.assertLessEqual(drop, across * math.tan(math.radians(3)) + 1e-9, "never straight down")
        verified = run("verify", self.folder / "out", "--cell", CELL)
        self.assertEqual(verified.returncode, 0, verified.stdout)
        steep = self.plan(pad.replace("ramp_deg: 3", "ramp_deg: 5"), "steep")
        self.assertEqual(steep.returncode, 2)
        self.assertRegex(steep.stderr, r"job\.yaml:\d+:\d+: toolpath\.ends\.ramp_deg: given 5; allowed: at most tool\.cutter\.max_ramp_deg of cell kr500_r2830, 3")

    def test_the_overcut_keeps_off_fixtures(self):
        """A clamp 17 mm behind the skin, at the window's edge; the cell wants 10 mm."""
        clamp = ("  - {name: clamp, class: fixture, mount: base, shape: {box: {size_mm: [20, 60, 60]}}, pose: "
                 "{xyz_mm: [1885, 0, 1100]}}\n")
        (self.folder / "cell.yaml").write_text(re.sub(r"(?m)^bodies:\n", "bodies:\n" + clamp, CELL.read_text()))
        text = quick_trim().replace(str(CELL), "cell.yaml")
        self.assertEqual(self.plan(text).returncode, 0)
        cell = (self.folder / "cell.yaml").read_text().replace(CENTRE, ", max_ramp_deg: 30")
        (self.folder / "cell.yaml").write_text(cell)
        deep = self.plan(text.replace("overcut_mm: 1", "overcut_mm: 12").replace("ramp_deg: 3", "ramp_deg: 30"), "deep")
        self.assertEqual(deep.returncode, 1, deep.stdout + deep.stderr)
        summary = json.loads((self.folder / "deep" / "summary.json").read_text())
        self.assertEqual(summary["points"]["planned"], 0, "half a contour is none")
        self.assertLessEqual({"interference", "incomplete"}, {entry["reason"] for entry in summary["skipped"]})
        self.assertTrue(any("clamp" in entry["detail"] for entry in summary["skipped"]))

    def test_tight_corners_are_findings_and_missing_tabs_a_warning(self):
        line = "line: {points_mm: [[-30, -30, 0], [30, -30, 0], [30, 30, 0], [-30, 30, 0]], closed: true, side: inside, blank: true}"
        text = re.sub(r"border: .*", line, quick_trim()).replace("    tabs:", "    # tabs:")
        text = re.sub(r"(?m)^  mesh: .*", f"  mesh: {self.folder}/plate.off", text)
        corners = [(x, y, z) for z in (-8, 0) for y in (-60, 60) for x in (-60, 60)]
        faces = ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5))
        (self.folder / "plate.off").write_text("\n".join(
            ["OFF", "8 6 0", *(f"{x} {y} {z}" for x, y, z in corners), *(f"4 {' '.join(map(str, face))}" for face in faces)]) + "\n")
        planned = self.plan(text)
        self.assertEqual(planned.returncode, 1, planned.stdout + planned.stderr)
        self.assertEqual(len(re.findall(r"tighter than the cutter of 20 mm, which leaves 4\.142 mm standing", planned.stdout + planned.stderr)), 4)
        self.assertIn("no tabs hold the piece", planned.stdout)
        self.check_programs()

    def test_wrong_trims_are_refused_in_their_place(self):
        for given, told in ((("    tabs: {count: 4,", "    tabs: {count: 4, at_mm: [[0, 0, 0]],"), ":5: toolpath.trim.tabs: allowed: one of"),
                            (("border: {near_mm: [-110, 0, 0]}", "border: {near_mm: [0, 0, 0], between_mm: [[0, 0, 0]]}"), "between_mm: given 1 places; allowed: 2"),
                            (("  overcut_mm: 1\n", "\n"), "toolpath.trim.overcut_mm: missing; required"),
                            (("    milling: climb", "    milling: clim"), "given clim; allowed: one of climb, conventional"),
                            (("  trim:\n", "  ends: {lead: arc}\n  trim:\n"), ":3: toolpath.ends: has no effect with strategy trim"),
                            (("through_mm: 8 ", "through_mm: 40 "), "its shank would rub"),
                            (("border: {near_mm: [-110, 0, 0]}", "border: {}"), "the region has ")):
            refused = self.plan(sample("cabin_trim").replace(*given))
            self.assertEqual(refused.returncode, 2)
            self.assertIn(told, refused.stderr)

    def test_what_has_no_effect_is_refused_in_its_place(self):
        wrong = sample("cabin_holes").replace("  order: travel", "  stepover_mm: 3\n  lead_deg: 4\n  order: travel")
        told = self.plan(wrong)
        self.assertEqual(told.returncode, 2)
        for key in ("stepover_mm", "lead_deg"):
            self.assertRegex(told.stderr, rf"job\.yaml:\d+:3: toolpath\.{key}: has no effect with strategy drill")
        for given, told in ((("peck_mm: 4", "chip_retract_mm: 1"), "drill.chip_retract_mm: has no effect here: needs peck_mm"),
                            (("peck_mm: 4", "peck_mm: 4\n    breakthrough_mm: 1"), "drill.breakthrough_mm: has no effect"),
                            (("clearance_mm: 3", "clearance_mm: 0"), "drill.clearance_mm: given 0; allowed: "),
                            (("peck_mm: 4", "countersink: {diameter_mm: 30}"), "drill.depth_mm: has no effect here: countersink"),
                            (("    depth_mm: 10  ", "    # "), "drill.holes[0].depth_mm: missing")):
            self.assertIn(told, self.plan(sample("cabin_holes").replace(*given)).stderr)


if __name__ == "__main__":
    unittest.main(argv=["shop_test.py"])
