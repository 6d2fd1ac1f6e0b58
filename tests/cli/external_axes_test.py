#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Rails, lifts and tables: what `plan` makes of them. Usage: external_axes_test.py MILLPOSE MILLPOSE_AUDIT TOP [TEST…]
With MILLPOSE_SLOW in the environment the barrel as it is."""
import csv
import json
import os
import random
import re
import signal
import sys
import time
import unittest

from plan_fixture import CUT_DOWN, WITHOUT_FORCE, Bench, contents, differences, kill_after, started

BENCH = None
SLOW = "MILLPOSE_SLOW" in os.environ
THREADS = ("2", "4") if SLOW else ("4",)
COARSE = [] if SLOW else [(r"rotation_step_deg: 1\n", "rotation_step_deg: 10\n")]
AXES = """external_axes:
  - {name: rail, kind: linear, carries: robot, axis: [1, 0, 0], limits_mm: [0, 400], home_mm: 150, speed_mm_s: 500, acceleration_mm_s2: 500}
  - {name: lift, kind: linear, carries: workpiece, axis: [0, 0, 1], limits_mm: [-100, 100], speed_mm_s: 100, acceleration_mm_s2: 100}
  - {name: turn, kind: rotary, carries: workpiece, axis: [0, 0, 1], origin_mm: [2000, 0, 0], limits_deg: [-90, 90], speed_deg_s: 20, acceleration_deg_s2: 20}
"""
SMALL = [*CUT_DOWN, *WITHOUT_FORCE, (r"frame: robot_base", "frame: world"), (r"programs: .*", "programs: []")]
# Two of the lands, in few passes.
BARREL = [] if SLOW else [(r"\ntoolpath:", "\npath: {rotation_step_deg: 10}\ntoolpath:"), (r"stepover_mm: 16", "stepover_mm: 45"), (r"spacing_mm: 12", "spacing_mm: 50"), (r"step_deg: 15", "step_deg: 60"),
                          *((rf"\n      - connected: \{{seed_mm: \[{seed}[^\n]*", "") for seed in ("603.000, 1044", "-603.000, 1044", "-603.000, -1044", "603.000, -1044"))]


def program(folder, controller):
    """The text with the motions."""
    texts = [path.read_text(encoding="utf-8") for path in (folder / "programs" / controller).iterdir() if path.is_file()]
    return max(texts, key=len)


def rows(folder):
    with (folder / "points.csv").open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


class Standing(unittest.TestCase):
    """External axes that the job puts somewhere."""

    def cell(self, name, changes, controllers=False):
        text = (BENCH.top / "cells" / "kr500_r2830.yaml").read_text(encoding="utf-8")
        if not controllers:
            text = text.split("\ncontrollers:")[0] + "\n"
        for old, new in changes:
            self.assertEqual(text.count(old), 1, old)
            text = text.replace(old, new)
        (BENCH.top / "cells" / f"{name}.yaml").write_text(text, encoding="utf-8")
        return (r"cell: .*", f"cell: ../../cells/{name}.yaml")

    def with_axes(self, **more):
        return self.cell("axes", [("home_deg:", AXES + "home_deg:"), ("excluded_pairs: []", "excluded_pairs: [[platform, base], [platform, base_rear]]")], **more)

    def test_a_plan_at_a_station_is_that_of_a_cell_put_there_by_hand(self):
        external = "external: [{axis: rail, scope: constant, at_mm: 150}, {axis: lift, scope: constant, at_mm: 40}]\ntoolpath:"
        job = BENCH.job("support_pad", [*SMALL, self.with_axes(), (r"toolpath:", external)], "at_a_station")
        by_hand = BENCH.job("support_pad", [*SMALL, self.cell("by_hand", [("{xyz_mm: [0, 0, 0], abc_deg: [0, 0, 0]}", "{xyz_mm: [150, 0, 0], abc_deg: [0, 0, 0]}")]),
                                            (r"xyz_mm: \[2076, 0, 1006\]", "xyz_mm: [2076, 0, 1046]")], "by_hand")
        folders = []
        for path in (job, by_hand):
            result, folder = BENCH.plan(path, path.stem)
            self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
            folders.append(folder)
        own, hand = map(rows, folders)
        self.assertEqual([(row["e1_mm"], row["e2_mm"], row["e3_deg"]) for row in own], [("150", "40", "0")] * len(own))
        self.assertEqual([{key: row[key] for key in hand[0]} for row in own], hand)
        self.assertEqual(json.loads((folders[0] / "summary.json").read_text())["external"]["moves"], 2, "the lift's, there and back")

    def test_controllers_must_name_the_axes_where_a_program_is_asked_for(self):
        cell = self.with_axes(controllers=True)
        result, folder = BENCH.plan(BENCH.job("support_pad", [*SMALL, cell], "unnamed"), "unnamed")
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        self.assertFalse((folder / "programs").exists())
        asked = [change for change in SMALL if "programs" not in change[0]]
        for command in ("plan", "check"):
            job = BENCH.job("support_pad", [*asked, cell, (r"programs: .*", "programs: [sinumerik]")], "asked")
            result = BENCH.run(command, job)
            self.assertEqual(result.returncode, 2, result.stdout)
            self.assertRegex(result.stderr, r"axes\.yaml:\d+:\d+: controllers\.sinumerik.external_axes: the cell's axis 'rail' is missing")

    def test_programs_of_the_sample_rail_drive_e1(self):
        external = "external: [{axis: rail, scope: constant, at_mm: -300}]\ntoolpath:"
        changes = [*SMALL[:-1], (r"cell: .*", "cell: ../../cells/kr500_rail.yaml"), (r"toolpath:", external)]
        result, folder = BENCH.plan(BENCH.job("support_pad", changes, "on_the_rail"), "on_the_rail")
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        words = {"krl": r"^LIN \{.*E1 -300\}", "sinumerik": r"SUPA .*RAIL_AX=-300\.0000", "linuxcnc": r"^G0 .* U-300\.0000"}
        for controller, pattern in words.items():
            self.assertRegex(program(folder, controller), re.compile(pattern, re.MULTILINE), controller)
        self.assertEqual(BENCH.run("verify", folder).returncode, 0)

    def test_the_judge_reads_where_programs_have_the_rail(self):
        external = "external: [{axis: rail, scope: constant, at_mm: -300}]\ntoolpath:"
        changes = [*SMALL[:-1], (r"cell: .*", "cell: ../../cells/kr500_rail.yaml"), (r"toolpath:", external)]
        job = BENCH.job("support_pad", changes, "judged_rail")
        result, folder = BENCH.plan(job, "judged_rail")
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        status, verdict = BENCH.audit(folder, job, "--travel-mm", "5")
        self.assertEqual((status, verdict["broken"]), (0, {}))
        # The rail elsewhere, and the other way round, in one word or in all: the tip stays only where the controller counts it in.
        for controller, word in {"krl": "E1 ", "sinumerik": "RAIL_AX=", "linuxcnc": "U"}.items():
            path = max((path for path in (folder / "programs" / controller).iterdir() if path.is_file()), key=lambda path: path.stat().st_size)
            right = path.read_text(encoding="utf-8")
            for value, count in (("-299.9500", 1), ("300.0000", 0)):
                path.write_text(re.sub(rf"{re.escape(word)}-300(\.0000)?\b", word + value, right, count=count), encoding="utf-8")
                broken = BENCH.audit(folder, job, "--travel-mm", "50")[1]["broken"]
                self.assertIn(f"program_external_violations_{controller}" if count else f"program_deviation_external_{controller}", broken, value)
            path.write_text(right, encoding="utf-8")

    def test_what_is_not_so_is_refused_with_its_place(self):
        cases = (
            ("{axis: rial, scope: constant}", r"external\[0\].axis: given 'rial'; allowed: .*rail, lift, turn; did you mean 'rail'\?"),
            ("{axis: rail, scope: continuous, at_mm: 5}", r"external\[0\].at_mm: has no effect here: with scope continuous the planner chooses"),
            ("{axis: rail, scope: continuous, step_mm: 1}", r"external: given steps make 401 positions; allowed: up to 200 where an axis has scope continuous"),
            ("{axis: rail, scope: constant, at_deg: 5}", r"external\[0\].at_deg: has no effect here: axis rail is linear; allowed: at_mm"),
            ("{axis: rail, scope: constant, at_mm: 500}", r"external\[0\].at_mm: given 500; allowed: 0 to 400, the limits of rail"),
            ("{axis: rail, scope: per_pass, at_mm: 5}", r"at_mm: has no effect here: with scope per_pass"),
            ("{axis: rail, scope: constant}, {axis: rail, scope: per_pass}", r"external\[[01]\].axis: given rail twice"),
            ("{axis: rail, scope: per_pass, step_mm: 0.1}", r"external: given steps make 4001 positions; allowed: up to 2000"),
        )
        for number, (entries, wanted) in enumerate(cases):
            job = BENCH.job("support_pad", [*SMALL, self.with_axes(), (r"toolpath:", f"external: [{entries}]\ntoolpath:")], f"refused{number}")
            result, _ = BENCH.plan(job, "refused")
            self.assertEqual(result.returncode, 2, entries)
            self.assertRegex(result.stderr, rf"refused{number}\.yaml:\d+:\d+: .*" + wanted)

    def test_axes_and_carriages_of_a_cell_are_checked(self):
        cases = (
            ("limits_mm: [0, 400]", "limits_deg: [0, 400]", r"limits_deg: has no effect here: kind is linear; allowed: limits_mm"),
            ("home_mm: 150", "home_mm: 500", r"home_mm: given 500; allowed: within limits_mm"),
            ("name: lift", "name: rail", r"external_axes\[1\].name: given rail twice"),
            ("origin_mm: [2000, 0, 0], ", "", r"origin_mm: missing; required where kind is rotary"),
            ("speed_mm_s: 500", "speed_mm_s: 500, stiffness_N_mm: 1000", r"stiffness_source: missing; required with a stiffness"),
            ("mount: world, shape: {box: {size_mm: [2000", "mount: carriage, axis: ral, shape: {box: {size_mm: [2000",
             r"axis: given 'ral'; allowed: the name of one of external_axes; did you mean 'rail'\?"),
            ("mount: world, shape: {box: {size_mm: [2000", "mount: world, axis: rail, shape: {box: {size_mm: [2000", r"axis: has no effect here: mount is not carriage"),
        )
        for old, new, wanted in cases:
            cell = self.cell("wrong", [("home_deg:", AXES.replace(old, new) + "home_deg:"), *(() if old in AXES else ((old, new),))])
            result, _ = BENCH.plan(BENCH.job("support_pad", [*SMALL, cell], "wrong"), "wrong")
            self.assertEqual(result.returncode, 2, new)
            self.assertRegex(result.stderr, r"wrong\.yaml:\d+:\d+: .*" + wanted)


class Barrel(unittest.TestCase):
    """Passes that need the table, whose stations the planner chooses."""

    @classmethod
    def setUpClass(cls):
        cls.job = BENCH.job("cabin_barrel", BARREL, "barrel")
        began = time.monotonic()
        cls.result, cls.folder = BENCH.plan(cls.job, "barrel", "--threads", "1", timeout=3600)
        cls.seconds = time.monotonic() - began
        if cls.result.returncode != 0:
            raise AssertionError(f"plan ends with {cls.result.returncode}:\n{cls.result.stdout}{cls.result.stderr}")

    def test_every_land_is_milled_where_the_table_has_turned_it_to(self):
        external = json.loads((self.folder / "summary.json").read_text())["external"]
        self.assertEqual([axis["name"] for axis in external["axes"]], ["tilt", "turn"])
        stations = {tuple(position) for position in external["passes"]}
        self.assertEqual(len(stations), 6 if SLOW else 2)
        self.assertEqual({tilt for tilt, _ in stations}, {0})
        # From home and back, and from land to land: a change more than there are stations.
        self.assertLessEqual(external["moves"], len(stations) + 1)
        for row in rows(self.folder):
            self.assertEqual(row["status"], "planned")
            self.assertLess(float(row["x_mm"]), 3100 - 1100, "before the robot")

    def test_the_setup_sheet_has_a_picture_of_each_station(self):
        page = self.folder.parent / "sheet.html"
        result = BENCH.run("report", self.folder, "--job", self.job, "--html", page)
        self.assertEqual(result.returncode, 0, result.stderr)
        views = re.findall(r"<h2>Setup at tilt 0 deg, turn (-?[\d.]+) deg</h2>\s*(<svg.*?</svg>)<p>(.*?)</p>", page.read_text(encoding="utf-8"), re.DOTALL)
        passes = [turn for _, turn in json.loads((self.folder / "summary.json").read_text())["external"]["passes"]]
        stations = list(dict.fromkeys(passes))
        self.assertEqual([round(float(turn), 3) for turn, _, _ in views], [round(turn, 3) for turn in stations])
        points = {turn: sum(row["status"] == "planned" and passes[int(row["pass"])] == turn for row in rows(self.folder)) for turn in stations}
        for number, (turn, svg, note) in enumerate(views):
            self.assertIn(f"Station {number + 1} of {len(stations)}: passes ", note)
            drawn = {kind: re.findall(rf'class="{kind}" d="([^"]*)"', svg) for kind in ("cut", "elsewhere")}
            shown = {kind: sum(len(re.findall("[ML]", d)) for d in lines) for kind, lines in drawn.items()}
            here = points[stations[number]]
            self.assertEqual(shown, {"cut": here, "elsewhere": sum(points.values()) - here})
        self.assertEqual(len({svg for _, svg, _ in views}), len(views))

    def test_programs_turn_the_table_and_replay(self):
        self.assertEqual({(p["controller"], p["verified"]) for p in json.loads((self.folder / "summary.json").read_text())["programs"]},
                         {("krl", True), ("sinumerik", True), ("linuxcnc", True)})
        self.assertEqual(BENCH.run("verify", self.folder, "--job", self.job).returncode, 0)
        turns = {turn for _, turn in json.loads((self.folder / "summary.json").read_text())["external"]["passes"]}
        found = {"krl": r"^LIN \{.*,E1 0,E2 (-?[\d.]+)\}", "sinumerik": r"TILT_AX=0\.0000\d* TURN_AX=(-?[\d.]+)", "linuxcnc": r"^G0 .* U0\.000000 V(-?[\d.]+)"}
        for controller, pattern in found.items():
            text = program(self.folder, controller)
            self.assertEqual({round(float(word), 3) for word in re.findall(pattern, text, re.MULTILINE)} - {0}, {round(turn, 3) for turn in turns} - {0}, controller)
        # A coupled table turns $BASE with it: stated once, and again where INITMOV has taken it away.
        statements = set(re.findall(r"^\$BASE = .*", program(self.folder, "krl"), re.MULTILINE))
        self.assertEqual(len(statements), 1)
        self.assertIn("MACHINE_DEF[2].ROOT", statements.pop())

    def test_linuxcnc_with_the_table_in_its_kinematics(self):
        cell = BENCH.top / "cells" / "kr500_tilt_turn.yaml"
        text, count = re.subn(r"  linuxcnc: .*", "  linuxcnc: {coordinates: cartesian, external_axes: [{name: U, axis: tilt, coupled: true}, {name: V, axis: turn, coupled: true}]}", cell.read_text(encoding="utf-8"))
        self.assertEqual(count, 1)
        cell.with_name("kinematics.yaml").write_text(text, encoding="utf-8")
        job = BENCH.job("cabin_barrel", [*BARREL, (r"cell: .*", "cell: ../../cells/kinematics.yaml"), (r"programs: .*", "programs: [linuxcnc]")], "kinematics")
        result, folder = BENCH.plan(job, "kinematics", timeout=3600)
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        self.assertEqual([p["verified"] for p in json.loads((folder / "summary.json").read_text())["programs"]], [True])

    def test_the_judge_finds_nothing(self):
        status, verdict = BENCH.audit(self.folder, self.job, "--travel-mm", "0.2" if SLOW else "10")
        self.assertEqual((status, verdict["broken"]), (0, {}))
        self.assertGreater(verdict["objectives_recomputed"], 10)
        for controller in ("krl", "sinumerik", "linuxcnc"):
            self.assertLess(verdict[f"program_deviation_external_{controller}"], 1e-3)

    def test_the_same_bytes_for_any_threads_and_after_a_kill(self):
        reference = contents(self.folder)
        for threads in THREADS:
            _, folder = BENCH.plan(self.job, f"barrel{threads}", "--threads", threads, timeout=3600)
            self.assertEqual(differences(reference, contents(folder)), [])
        killed = BENCH.top / "killed"
        with started(BENCH.millpose, "plan", self.job, "-o", killed) as process:
            kill_after(process, random.uniform(0.3, 0.7) * self.seconds, signal.SIGKILL)
        _, folder = BENCH.plan(self.job, "killed", timeout=3600)
        self.assertEqual(differences(reference, contents(folder)), [])


class Moving(unittest.TestCase):
    """Passes along which an axis moves: a rail under the arm, a table under the part."""

    CELLS = {"rail": ("kr500_rail", "rail, scope: {scope}, step_mm: 500", "[1850, 0, 1200]"),
             "table": ("kr500_tilt_turn", "turn, scope: {scope}, step_deg: 30", "[2500, 0, 1300]")}
    FEW = [] if SLOW else [*COARSE, (r"stepover_mm: 20", "stepover_mm: 350"), (r"spacing_mm: 10", "spacing_mm: 75"), (r"chord_tolerance_mm: 0.01", "chord_tolerance_mm: 0.05")]
    kept = {}  # plans, by axis and scope: made by one thread for the first test that asks

    def job(self, axis, scope, name):
        cell, entry, place = self.CELLS[axis]
        external = f"external: [{{axis: {entry.format(scope=scope)}}}]\ntoolpath:"
        changes = [*self.FEW, (r"cell: .*", f"cell: ../../cells/{cell}.yaml"), (r"xyz_mm: \[1850, 0, 1200\]", f"xyz_mm: {place}"), (r"\ntoolpath:", "\n" + external)]
        return BENCH.job("cabin_panel", changes, name)

    def planned(self, axis, scope, *more, out=None):
        job = self.job(axis, scope, f"{axis}_{scope}")
        result, folder = BENCH.plan(job, out or job.stem, *more, timeout=3600)
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        return job, folder

    def planned_once(self, axis, scope):
        """By one thread: job, folder, seconds."""
        if (axis, scope) not in self.kept:
            began = time.monotonic()
            self.kept[axis, scope] = *self.planned(axis, scope, "--threads", "1"), time.monotonic() - began
        return self.kept[axis, scope]

    def test_axes_move_and_programs_follow(self):
        columns = {"rail": "e1_mm", "table": "e2_deg"}
        words = {"rail": {"krl": "E1 ", "sinumerik": "RAIL_AX=", "linuxcnc": "U"}, "table": {"krl": "E2 ", "sinumerik": "TURN_AX=", "linuxcnc": "V"}}
        for axis, column in columns.items():
            job, folder, _ = self.planned_once(axis, "continuous")
            summary = json.loads((folder / "summary.json").read_text())
            along = {move["pass"]: move for move in summary["external"]["along"]}
            self.assertGreater(len(along), 0, axis)
            for number, move in along.items():
                values = [float(row[column]) for row in rows(folder) if int(row["pass"]) == number]
                steps = [b - a for a, b in zip(values, values[1:])]
                self.assertTrue(all(step * steps[0] > 0 for step in steps), f"{axis}: one way along pass {number}")
                at = 0 if axis == "rail" else 1
                self.assertAlmostEqual(values[0], move["from"][at], 6)
                self.assertAlmostEqual(values[-1], move["to"][at], 6)
            # Never worse than what stands: that is among the choices.
            _, standing, _ = self.planned_once(axis, "per_pass")
            worst = [max(float(row["objective"]) for row in rows(where)) for where in (folder, standing)]
            self.assertLessEqual(worst[0], worst[1], axis)
            self.assertEqual({(p["controller"], p["verified"]) for p in summary["programs"]}, {("krl", True), ("sinumerik", True), ("linuxcnc", True)})
            self.assertEqual(BENCH.run("verify", folder, "--job", job).returncode, 0)
            status, verdict = BENCH.audit(folder, job, "--travel-mm", "0.5" if SLOW else "10")
            self.assertEqual((status, verdict["broken"]), (0, {}), axis)
            # One word of a cut half a unit off: the judge reads it where the tip does not show it, too.
            for controller, word in words[axis].items():
                path = max((path for path in (folder / "programs" / controller).iterdir() if path.is_file()), key=lambda path: path.stat().st_size)
                right = path.read_text(encoding="utf-8")
                found = [m for m in re.finditer(rf"^(?:N\d+ )?(?:LIN|G1) .*?{re.escape(word)}(-?[\d.]+)", right, re.MULTILINE)]
                mid = found[len(found) // 2]
                path.write_text(right[:mid.start(1)] + f"{float(mid[1]) + 0.5:.4f}" + right[mid.end(1):], encoding="utf-8")
                broken = BENCH.audit(folder, job, "--travel-mm", "5000")[1]["broken"]
                self.assertTrue(any(controller in figure for figure in broken), f"{axis}, {controller}: {broken}")
                path.write_text(right, encoding="utf-8")

    def test_the_same_bytes_for_any_threads_and_after_a_kill(self):
        job, one, seconds = self.planned_once("rail", "continuous")
        for threads in THREADS:
            _, folder = self.planned("rail", "continuous", "--threads", threads, out=f"rail_{threads}")
            self.assertEqual(differences(contents(one), contents(folder)), [])
        killed = BENCH.top / "killed_rail"
        with started(BENCH.millpose, "plan", job, "-o", killed) as process:
            kill_after(process, random.uniform(0.3, 0.7) * seconds, signal.SIGKILL)
        _, folder = self.planned("rail", "continuous", out="killed_rail")
        self.assertEqual(differences(contents(one), contents(folder)), [])

    def test_a_controller_that_does_not_count_the_axis_in_is_refused(self):
        cell = BENCH.top / "cells" / "kr500_rail.yaml"
        text, count = re.subn(r"name: RAIL_AX, axis: rail, coupled: true", "name: RAIL_AX, axis: rail, coupled: false", cell.read_text(encoding="utf-8"))
        self.assertEqual(count, 1)
        cell.with_name("uncoupled.yaml").write_text(text, encoding="utf-8")
        job = self.job("rail", "continuous", "uncoupled")
        job.write_text(re.sub(r"kr500_rail\.yaml", "uncoupled.yaml", job.read_text(encoding="utf-8")), encoding="utf-8")
        result = BENCH.run("plan", job, "-o", BENCH.top / "uncoupled")
        self.assertEqual(result.returncode, 2, result.stdout + result.stderr)
        self.assertRegex(result.stderr, r"sinumerik.*rail|rail.*sinumerik")


if __name__ == "__main__":
    BENCH = Bench(*sys.argv[1:4])
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]])
