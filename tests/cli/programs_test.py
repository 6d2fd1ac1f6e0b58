#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Programs as an operator gets them: dry run, numbered frames, $BASE window, edits by hand, all from the outside.
Usage: programs_test.py MILLPOSE TOP"""
import json
import math
import re
import sys
import unittest

from plan_fixture import Bench

BENCH = None
CUT_DOWN = [(r"stepover_mm: [\d.]+", "stepover_mm: 30"), (r"spacing_mm: [\d.]+", "spacing_mm: 20")]
EVERY_POINT = (r"(?m)^programs: ", "program_options: {point_economy: {chord_mm: 0}}\nprograms: ")
NUMBER = r"(-?[\d.]+)"


def matrix(a, b, c):
    """Rz(a)·Ry(b)·Rx(c), degrees: rows."""
    (sa, ca), (sb, cb), (sc, cc) = ((math.sin(math.radians(w)), math.cos(math.radians(w))) for w in (a, b, c))
    return [[ca * cb, ca * sb * sc - sa * cc, ca * sb * cc + sa * sc],
            [sa * cb, sa * sb * sc + ca * cc, sa * sb * cc - ca * sc],
            [-sb, cb * sc, cb * cc]]


def header(text):
    return dict(re.findall(r"(?m)^; ([a-z_]+): (.*)$", text))


def straight(text):
    """X, Y, Z, A, B, C of every LIN, in order; what a target does not name stays as it was."""
    poses, words = [], {}
    for kind, fields in re.findall(r"(?m)^(PTP|LIN) \{([^}]*)\}", text):
        words.update((name, float(value)) for name, value in re.findall(rf"\b([XYZABC]) {NUMBER}", fields))
        if kind == "LIN":
            poses.append([words[name] for name in "XYZABC"])
    return poses


def cell(name, krl):
    """A copy of the sample's cell with more keys for KRL."""
    path = BENCH.top / "cells/kr500_r2830.yaml"
    text = path.read_text(encoding="utf-8")
    changed, count = re.subn(r"(?m)^    tool_axis: -x.*$", "\n".join(f"    {key}" for key in ["tool_axis: -x", *krl]), text)
    assert count == 1
    path.with_name(name + ".yaml").write_text(changed, encoding="utf-8")
    return path.with_name(name + ".yaml")


class Planned(unittest.TestCase):
    def plan(self, name, changes, *more):
        job = BENCH.job("support_pad", CUT_DOWN + changes, name)
        result, folder = BENCH.plan(job, name, *more)
        self.told = result.stdout
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        self.assertNotIn("NOT", result.stdout)
        programs = json.loads((folder / "summary.json").read_text(encoding="utf-8"))["programs"]
        self.assertTrue(programs and all(program["verified"] for program in programs))
        self.assertEqual(BENCH.run("verify", folder, "--job", job).returncode, 0)
        return job, folder, (folder / "programs/krl/support_pad.src").read_text(encoding="ascii")


class Options(Planned):
    def test_a_dry_run_is_the_program_lifted_and_goes_nowhere_deeper(self):
        _, _, plain = self.plan("plain", [])
        _, _, dry = self.plan("dry", [(r"(?m)^programs: ", "program_options: {dry_run_offset_mm: 25}\nprograms: ")])
        self.assertEqual(header(dry)["dry_run"], "cuts are lifted by 25.000 mm along the tool axis")
        self.assertNotIn("dry_run", header(plain))
        lines, lifted = straight(plain), straight(dry)
        self.assertEqual(len(lines), len(lifted))
        # The part's surface is z = 0 of the base, the tool stands on it: only retracts (at 50 mm) stay.
        self.assertEqual({round(z[2], 3) for z in lines}, {0, 5, 50})
        for line, up in zip(lines, lifted):
            self.assertLess(max(abs(a - b) for a, b in zip(line[:2] + line[3:], up[:2] + up[3:])), 1e-3)
            self.assertAlmostEqual(up[2] - line[2], 0 if line[2] > 49 else 25, 3)

    def test_numbered_frames_are_confirmed_with_the_values_that_they_must_hold(self):
        numbered = cell("numbered", ["base_number: 3", "tool_number: 2", "max_motions: 15"])
        job, folder, text = self.plan("numbered", [("kr500_r2830", "numbered"), EVERY_POINT], "-v")
        self.assertIn("\nkrl, before a first run (docs/krl.md):\n"
                      "  [ ] tool: TOOL_DATA[2] at the controller: the values of tool_pose in the head\n"
                      "  [ ] base: BASE_DATA[3] at the controller: the values of base_pose in the head\n", self.told)
        self.assertRegex(self.told, r"\nsize       krl: \d+ kB in \d+ files, of 4000 kB \(program_memory_kbytes\)\n")
        self.assertIn("\nBAS (#BASE,3 )\nBAS (#TOOL,2 )\n", text)
        self.assertNotIn("$BASE = {FRAME", text)
        head = header(text)
        self.assertEqual(head["base"], "BASE_DATA[3] must hold: workpiece in $WORLD")
        self.assertEqual(head["base_pose"], "X 2076.000 Y 0.000 Z 1006.000, A 0.0000 B -90.0000 C 0.0000 (Z Y' X'')")
        self.assertEqual(head["tool"], "TOOL_DATA[2] must hold: spindle_d20 in the flange")
        self.assertEqual(head["tool_pose"], "X -250.000 Y 0.000 Z 250.000, A 180.0000 B 0.0000 C 90.0000 (Z Y' X'')")
        parts = sorted((folder / "programs/krl").glob("support_pad_*.src"))
        self.assertGreaterEqual(len(parts), 2)
        # Split over files, without its plan: the header stands for what the controller holds, and that is reported.
        main = folder / "programs/krl/support_pad.src"
        result = BENCH.run("verify", main, "--cell", numbered)
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        self.assertIn("assumed: the controller's base is as the header's base_pose says: X 2076.000", result.stdout)
        main.write_text(text.replace("X 2076.000", "X 4076.000"), encoding="ascii")
        result = BENCH.run("verify", main, "--cell", numbered)
        self.assertEqual(result.returncode, 1)
        self.assertRegex(result.stdout, r"support_pad_001\.src:\d+: the pose cannot be reached")
        # A comment, but one that says where the controller's base must be.
        result = BENCH.run("verify", folder, "--job", job)
        self.assertEqual(result.returncode, 1, result.stderr)
        self.assertIn('the header\'s line base_pose says "X 4076.000', result.stdout)
        main.write_text(re.sub("; base_pose.*\n", "", text), encoding="ascii")
        result = BENCH.run("verify", main, "--cell", numbered)
        self.assertEqual(result.returncode, 2)
        self.assertIn("support_pad.src:1: the base is a frame that the controller holds", result.stderr)
        main.write_text(text.replace("(#BASE,3 )", "(#BASE,4 )"), encoding="ascii")
        result = BENCH.run("verify", main, "--cell", numbered)
        self.assertEqual(result.returncode, 2)
        self.assertRegex(result.stderr, r"support_pad\.src:\d+:\d+: .*3 expected, as in the cell")

    def test_a_program_that_is_not_confirmed_withholds_no_other(self):
        # $VEL.ORI so low that motions which turn the tool a little fall far below their feed, in KRL alone.
        cell("slow", ["orientation_speed_deg_s: 0.0001"])
        job = BENCH.job("support_pad", CUT_DOWN + [("kr500_r2830", "slow"), EVERY_POINT], "slow")
        result, folder = BENCH.plan(job, "slow")
        self.assertEqual(result.returncode, 1, result.stdout + result.stderr)
        self.assertEqual(sorted(path.name for path in (folder / "programs").iterdir()), ["linuxcnc", "sinumerik"])
        summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
        self.assertRegex(summary["findings"][0], r"^no krl program is written, its read-back does not confirm it: \d+ "
                                                 r"motions? whose feed is not the planned one")
        self.assertRegex(summary["findings"][1], r"^krl: \d+ motions? whose feed .*; what helps: .*orientation_speed_deg_s")
        # A cause is reported once, with a few places: not every finding.
        self.assertLess(len(summary["findings"]), 10)
        self.assertRegex(summary["findings"][2], r"^krl support_pad\.src:\d+: .* runs at .* mm/min, planned are")
        self.assertEqual({p["controller"]: p["verified"] for p in summary["programs"]},
                         {"krl": False, "linuxcnc": True, "sinumerik": True})
        self.assertEqual({p["withheld"] for p in summary["programs"] if p["controller"] == "krl"},
                         {summary["findings"][0]})
        self.assertEqual(BENCH.run("verify", folder, "--job", job).returncode, 0)

    def test_every_piece_starts_by_itself(self):
        job, folder, text = self.plan("single", [])
        summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
        pieces = summary["pieces"]
        self.assertGreater(pieces, 1)
        starts = sorted((folder / "programs/krl/starts").glob("*.src"))
        self.assertEqual(len(starts), pieces)
        home = re.search(r"(?m)^PTP \{A1 .*$", text)[0]
        cuts = []
        for start in starts:
            single = start.read_text(encoding="ascii")
            motions = re.findall(r"(?m)^(?:PTP|LIN) .*$", single)
            self.assertEqual((motions[0], motions[-1]), (home, home))
            self.assertIn("\n$BASE = ", single)  # nothing is left to what ran before
            cuts += straight(single)
        # Together they cut what the whole program cuts, no more.
        self.assertEqual(sorted(cuts), sorted(straight(text)))
        for name, ending in (("sinumerik", "mpf"), ("linuxcnc", "ngc")):
            programs = list((folder / f"programs/{name}/starts").glob("*." + ending))
            self.assertEqual(len(programs), pieces)
            for program in programs:  # the spindle turns before the approach
                single = program.read_text(encoding="ascii")
                self.assertLess(single.index(" M3"), single.index("G1 "))
        result = BENCH.run("verify", folder, "--job", job)
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        self.assertEqual(result.stdout.count("  confirmed"), 3 * (pieces + 1), result.stdout)
        # One that was changed is found.
        damaged = starts[-1].read_text(encoding="ascii").replace("\nLIN {X ", "\nLIN {X 1", 1)
        starts[-1].write_text(damaged, encoding="ascii")
        result = BENCH.run("verify", folder, "--job", job)
        self.assertEqual(result.returncode, 1, result.stdout + result.stderr)
        self.assertIn("changed since they were written: " + starts[-1].name, result.stdout)
        # Wherever it is, it is held against the piece of its name.
        single = BENCH.run("verify", starts[-1], "--plan", folder, "--job", job)
        self.assertEqual(single.returncode, 1, single.stdout + single.stderr)
        single = BENCH.run("verify", starts[0], "--plan", folder, "--job", job)
        self.assertEqual(single.returncode, 0, single.stdout + single.stderr)

    def test_a_measured_part_gets_a_window_for_its_base(self):
        # Four targets measured where A 0.02, B -90.03 puts them, with residuals of some hundredths.
        turn, place = matrix(0.02, -90.03, 0), (2076.3, 0.2, 1006.1)
        targets = "targets:"
        for i, (x, y) in enumerate(((-40, -40), (40, -40), (40, 40), (-40, 40))):
            at = [row[0] * x + row[1] * y + p + (0.01, -0.01, 0.02)[k] * (-1) ** i
                  for k, (row, p) in enumerate(zip(turn, place))]
            targets += "\n    - {nominal_mm: [%g, %g, 0], measured_mm: [%.3f, %.3f, %.3f]}" % (x, y, *at)
        measured = [(r"pose: \{xyz_mm: \[2076, 0, 1006\].*", targets)]
        _, folder, text = self.plan("measured", measured)
        found = re.fullmatch(rf"\+-{NUMBER} mm along and \+-{NUMBER} deg about X, Y, Z, reach and clearance verified",
                             header(text)["base_window"])
        window = json.loads((folder / "summary.json").read_text(encoding="utf-8"))["base_window"]
        self.assertAlmostEqual(float(found[1]), window["shift_mm"], 3)
        self.assertAlmostEqual(float(found[2]), window["turn_deg"], 4)
        self.assertGreater(window["shift_mm"], 0)
        # More is asked than the gaps allow: the window shrinks, and what stands in the way is named.
        wide = (r"(?m)^programs: ", "program_options: {base_window: {shift_mm: 1000, turn_deg: 1}}\nprograms: ")
        _, folder, text = self.plan("wide", measured + [wide])
        self.assertIn("must not be shifted", header(text)["base_window"])
        window = json.loads((folder / "summary.json").read_text(encoding="utf-8"))["base_window"]
        self.assertEqual((window["shift_mm"], window["turn_deg"]), (0, 0))
        self.assertTrue(window["obstacle"])
        # A part that was not measured has none.
        _, folder, text = self.plan("unmeasured", [])
        self.assertNotIn("base_window", header(text))
        self.assertIsNone(json.loads((folder / "summary.json").read_text(encoding="utf-8"))["base_window"])


if __name__ == "__main__":
    BENCH = Bench(sys.argv[1], None, sys.argv[2])
    unittest.main(argv=[sys.argv[0]] + sys.argv[3:])
