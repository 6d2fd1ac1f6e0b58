# SPDX-License-Identifier: GPL-3.0-or-later
"""What a plant does with the programs of an ABB, a FANUC and a Universal Robots arm: a dry run, compensation, single starts, operations
with two tools. Arguments: MILLPOSE TOP"""
import json
import re
import unittest

from cli_fixture import TOP, InFolder, run
from operations_sample import CELL, small

CUTTING = "process.cutting={material: 5A06, teeth: 4, depth_mm: 1}"
# Sample, controller, the texts of its programs, its targets, what says that a program is compensated.
POSTS = [("irb6640_pad", "rapid", "*.mod", r"MoveL \[\[([-\d.,]+)\]", ["process.cutting={material: 5A06, teeth: 4, depth_mm: 1}"]),
         ("r2000ic_contours", "fanuc", "*.ls", r"X = +([-\d.]+) +mm, +Y = +([-\d.]+) +mm, +Z = +([-\d.]+) +mm", [CUTTING]),
         ("ur10e_pad", "urscript", "*.script", r"movep\(p\[([-\d., ]+)\]", [])]
LOAD = "    load: {mass_kg: 60, centre_in_flange_mm: [-90, 0, 180], inertia_kg_m2: [1.5, 1.8, 1.2]}\n"


def targets(text, pattern):
    """Places of straight motions, mm or m, as the program has them."""
    found = re.findall(pattern, text)
    return [[float(v) for v in (match if isinstance(match, tuple) else match.split(",")[:3])] for match in found]


class Posts(InFolder):
    def program(self, sample, controller, name, *changes):
        out = self.folder / name
        sets = [word for change in (f"programs=[{controller}]", "path.rotation_step_deg=10", *changes) for word in ("--set", change)]
        result = run("plan", TOP / "toolpaths" / sample / "job.yaml", "-o", out, "-q", *sets)
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        self.assertEqual(run("verify", out).returncode, 0)
        return out / "programs" / controller

    def test_dry_run_and_compensation_move_every_target(self):
        for sample, controller, files, pattern, cutting in POSTS:
            with self.subTest(controller=controller):
                told = {}
                for name, change in (("plain", []), ("dry", ["program_options.dry_run_offset_mm=5"]),
                                     ("compensated", ["compensation={deflection: full, shrink: 1}"])):
                    folder = self.program(sample, controller, f"{controller}_{name}", *cutting, *change, "program_options.point_economy={chord_mm: 0, angle_deg: 0, spacing_mm: 0}")
                    told[name] = "".join(path.read_text() for path in sorted(folder.glob(files)))
                scale = 1000 if controller == "urscript" else 1
                plain = targets(told["plain"], pattern)
                self.assertGreater(len(plain), 10)
                for name, low, high in (("dry", 4.99, 5.01), ("compensated", 1e-4, 0.101)):
                    moved = targets(told[name], pattern)
                    self.assertEqual(len(moved), len(plain))
                    ways = [scale * sum((a - b) ** 2 for a, b in zip(p, q)) ** 0.5 for p, q in zip(plain, moved)]
                    moved_by = max(ways) if name == "compensated" else sorted(ways)[len(ways) // 2]
                    self.assertTrue(low <= moved_by <= high, (name, moved_by))
                self.assertIn("COMPENSATED", told["compensated"].upper())
                self.assertNotIn("COMPENSATED", told["plain"].upper())

    def test_single_starts_of_every_pass(self):
        for sample, controller, files, pattern, _ in POSTS[1:]:
            with self.subTest(controller=controller):
                folder = self.program(sample, controller, controller)
                points = json.loads((folder.parents[1] / "summary.json").read_text())["passes"]
                starts = sorted((folder / "starts").glob(files))
                self.assertEqual(len(starts), points)
                whole = targets("".join(path.read_text() for path in folder.glob(files)), pattern)
                self.assertLess(len(targets(starts[-1].read_text(), pattern)), len(whole))

    def test_operations_change_the_tool(self):
        tools = CELL[CELL.index("tools:"):CELL.index("tool_change_deg")].replace("    stack:", LOAD + "    stack:")
        for sample, controller, call, expected in (
                ("irb6640_185_280", "rapid", "ToolChange;", r"(face_pads_\w*);[^;]*?\n(trim_window_\w*);[^;]*?\n(drill_holes_\w*);"),
                ("r2000ic_165f", "fanuc", "CALL TOOLCHG", r"CALL (face_pads\w*) ;[^/]*CALL (trim_window\w*) ;[^/]*CALL (drill_holes\w*) ;")):
            with self.subTest(controller=controller):
                cell = (TOP / "cells" / f"{sample}.yaml").read_text()
                begin, end = re.search(r"^tool:", cell, re.M).start(), re.search(r"^(#.*\n)*bodies:", cell, re.M).start()
                cell = cell[:begin] + tools + cell[end:]
                cell = cell.replace("  linuxcnc: {}\n", "")
                name = call.split()[-1].rstrip(";")
                cell = re.sub(rf"^  {controller}:.*\n", f"  {controller}:\n    calls: [{{name: {name}, moves: false}}]\n", cell, flags=re.M)
                cell = cell.replace("texts: {spindle_on", f'texts: {{tool_change: "{call}\\n", spindle_on')
                cell = re.sub(r"^    texts: .*#.*\n", f"    texts:\n      tool_change: |\n        {call}\n", cell, flags=re.M)
                (self.folder / "cell.yaml").write_text(cell)
                job = small().replace("programs: [krl, sinumerik, linuxcnc]", f"programs: [{controller}]")
                (self.folder / "job.yaml").write_text(job.replace("xyz_mm: [1850, 0, 1200]", "xyz_mm: [1700, 0, 1150]"))
                out = self.folder / controller
                result = run("plan", self.folder / "job.yaml", "-o", out, "-q")
                self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
                texts = {path.stem: path.read_text() for path in (out / "programs" / controller).iterdir()}
                main = next(text for stem, text in texts.items() if stem.startswith("cabin_window"))
                names = re.search(expected, main)
                self.assertTrue(names, main)
                self.assertEqual([call in texts[name] for name in names.groups()], [True, True, True])
                self.assertEqual(run("verify", out).returncode, 0)


if __name__ == "__main__":
    unittest.main(argv=["posts_test"])
