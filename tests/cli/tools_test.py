#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Several tools in one cell: what a job takes, and how programs change it. Usage: tools_test.py MILLPOSE TOP"""
import re
import shutil
import subprocess
import unittest

from cli_fixture import TOP, InFolder, run

CELL = (TOP / "cells" / "kr500_two_tools.yaml").read_text()
HOLES = (TOP / "toolpaths" / "cabin_holes" / "job.yaml").read_text()
BIG = "{name: big, class: holder, length_mm: 400, diameter_mm: 3000}"
MAINS = {"krl": "cabin_holes.src", "sinumerik": "cabin_holes.mpf", "linuxcnc": "cabin_holes.ngc"}


class Tools(InFolder):
    def plan(self, tool="tool: drill_d5\n", cell=CELL, *arguments):
        """One hole of the sample, by a cell of its own."""
        job = HOLES.replace("cell: ../../cells/kr500_r2830.yaml\n", "cell: cell.yaml\n" + tool)
        job = re.sub(r"(      - \{at_mm: .*\n){7}", "", job, count=1).replace("../cabin_panel", str(TOP / "toolpaths" / "cabin_panel"))
        (self.folder / "job.yaml").write_text(job)
        (self.folder / "cell.yaml").write_text(cell)
        return run("plan", self.folder / "job.yaml", "-o", self.folder / "out", "-q", "-v", *arguments)

    def program(self, controller):
        return self.folder / "out" / "programs" / controller / MAINS[controller]

    def verify(self, controller):
        return run("verify", self.program(controller), "--cell", self.folder / "cell.yaml", "--tool", "drill_d5")

    def test_programs_go_to_change_the_tool_and_wait_for_it(self):
        planned = self.plan()
        self.assertEqual(planned.returncode, 0, planned.stderr)
        expected = {
            "krl": r"PTP \{A1 60,.*\n; TOOL drill_d5: put it in, then start again\nHALT\n",
            "sinumerik": r'RA1=60\.0.*\nT="drill_d5" D1\nM6\nMP_TOOL:\nSTOPRE\nIF \$TC_TP2\[\$TC_MPP6\[9998,1\]\]=="drill_d5" GOTOF MP_TOOL_IN\n',
            "linuxcnc": r"G0 X60\.0.*\nT2 M6\nO9001 WHILE \[#5400 NE 2\]\n",
        }
        for controller, text in expected.items():
            program = self.program(controller).read_text()
            self.assertRegex(program, text)
            self.assertLess(re.search(r"(A1 |RA1=|X)60\b", program).start(), re.search(r"(?m)^[^;(\n]*\bM3\b|OUT\[1\]=TRUE", program).start(), "before the spindle starts")
        verified = run("verify", self.folder / "out")
        self.assertEqual(verified.returncode, 0, verified.stdout)

    def test_the_plants_variable_is_asked_where_it_has_one(self):
        cell = CELL.replace("  krl:\n", "  krl:\n    tool_in_spindle: SPINDLE_TOOL\n")
        self.assertEqual(self.plan(cell=cell).returncode, 0)
        self.assertIn("HALT\nWAIT SEC 0\nWHILE SPINDLE_TOOL<>2\n; TOOL 2 drill_d5 EXPECTED\nHALT\nENDWHILE\n", self.program("krl").read_text())

    def shared(self):
        """The cell with its tools in a file of their own, and that file."""
        begin, end = CELL.index("tools: "), CELL.index("tool_change_deg:")
        return CELL[:begin] + "tools_file: shop/tools.yaml\n" + CELL[end:], "millpose_tools: 1\n" + CELL[begin:end]

    def test_tools_of_a_file_are_those_of_the_cell(self):
        cell, tools = self.shared()
        (self.folder / "shop").mkdir()
        (self.folder / "shop" / "tools.yaml").write_text(tools)
        self.assertEqual(self.plan().returncode, 0)
        results = lambda: {name: (self.folder / "out" / name).read_bytes() for name in ("cell.yaml", "points.csv", *(f"programs/{c}/{main}" for c, main in MAINS.items()))}
        own = results()
        planned = self.plan(cell=cell)
        self.assertEqual(planned.returncode, 0, planned.stderr)
        self.assertEqual(results(), own)
        self.assertEqual(run("verify", self.folder / "out").returncode, 0)
        self.assertIn("unchanged", self.plan(cell=cell).stdout)
        (self.folder / "shop" / "tools.yaml").write_text(tools.replace("diameter_mm: 50", "diameter_mm: 51"))
        self.assertNotIn("unchanged", self.plan(cell=cell).stdout)

    def test_what_is_wrong_with_a_tools_file_is_told_with_its_place(self):
        cell, tools = self.shared()
        (self.folder / "shop").mkdir()
        line = lambda text, word: text[:text.index(word)].count("\n") + 1
        for given, own, said in (
            (tools.replace("drill_d5", "mill_d20"), cell, rf"shop/tools\.yaml:{line(tools, '- name: drill_d5')}:\d+: tools\[1\]\.name: given mill_d20 twice"),
            (tools.replace("diameter_mm: 5,", "diametre_mm: 5,"), cell, r"shop/tools\.yaml:\d+:\d+: .*diametre_mm.*diameter_mm"),
            ("millpose_tools: 1\ntools: []\n", cell, r"shop/tools\.yaml:2:\d+: tools: given no tool; allowed: at least one"),
            (CELL, cell, r"shop/tools\.yaml:\d+:\d+: this is a cell file; a tools file is expected here"),
            (tools, cell.replace("tools_file:", "tools: []\ntools_file:"), r"cell\.yaml:\d+:\d+: tools: given together with tools_file; allowed: one of the two"),
            (tools, cell.replace("shop/tools.yaml", "shop/tool.yaml"), r"cell\.yaml:\d+.*tools_file: there is no file .*shop/tool\.yaml"),
        ):
            with self.subTest(said):
                (self.folder / "shop" / "tools.yaml").write_text(given)
                planned = self.plan(cell=own)
                self.assertEqual(planned.returncode, 2, planned.stdout)
                self.assertRegex(planned.stderr, said)

    def test_a_tools_file_outside_of_the_root_is_not_read(self):
        cell, tools = self.shared()
        (self.folder / "shop").mkdir()
        (self.folder / "shop" / "tools.yaml").write_text(tools)
        (self.folder / "inner").mkdir()
        (self.folder / "inner" / "cell.yaml").write_text(cell.replace("shop/", "../shop/"))
        refused = run("check", self.folder / "inner" / "cell.yaml", "--root", self.folder / "inner")
        self.assertEqual(refused.returncode, 2, refused.stdout)
        self.assertIn("shop/tools.yaml", refused.stderr)

    def test_without_a_place_the_tool_is_changed_at_home(self):
        cell = re.sub(r"tool_change_deg:.*\n", "", CELL)
        self.assertEqual(self.plan(cell=cell).returncode, 0)
        text = self.program("krl").read_text()
        self.assertLess(text.index("; TOOL drill_d5"), text.index("PTP {"))

    def test_a_cell_with_one_tool_changes_nothing(self):
        one = (TOP / "cells" / "kr500_r2830.yaml").read_text()
        self.assertEqual(self.plan(tool="", cell=one).returncode, 0)
        for controller in MAINS:
            self.assertNotRegex(self.program(controller).read_text(), "TOOL_IN|5400|put it in")

    @unittest.skipUnless(shutil.which("rs274"), "LinuxCNC's interpreter is not installed")
    def test_the_interpreter_waits_for_no_other_tool(self):
        self.assertEqual(self.plan().returncode, 0)
        program = self.program("linuxcnc")
        run_it = ["rs274", "-g", program.name]
        result = subprocess.run(run_it, cwd=program.parent, capture_output=True, text=True, timeout=60, env={"HOME": str(self.folder)})
        self.assertEqual(result.returncode, 0, result.stdout[-300:])
        self.assertIn("CHANGE_TOOL(2)", result.stdout)
        self.assertNotIn("PROGRAM_STOP", result.stdout, "the check does not stop for the right tool")

    def test_damage_to_the_change_is_seen(self):
        self.assertEqual(self.plan().returncode, 0)
        damage = {
            "the check is gone": ("linuxcnc", r"O9001 WHILE .*\n(.*\n)*?O9001 ENDWHILE\n", ""),
            "another tool is checked": ("linuxcnc", "#5400 NE 2", "#5400 NE 1"),
            "another tool is put in": ("linuxcnc", "T2 M6", "T1 M6"),
            "another tool of the magazine": ("sinumerik", 'T="drill_d5"', 'T="mill_d20"'),
            "another name is checked": ("sinumerik", '=="drill_d5"', '=="mill_d20"'),
            "the change stands elsewhere": ("krl", r"(PTP \{A1 60.*\n)(; TOOL .*\nHALT\n)", r"\2\1"),
            "the arm does not go there": ("krl", r"PTP \{A1 60.*\n", ""),
        }
        told = lambda seen: set(re.findall(r"^.*cabin_holes\.\w+:\d+.*$", seen.stdout + seen.stderr, re.M))
        before = {controller: told(self.verify(controller)) for controller in MAINS}
        for name, (controller, pattern, replacement) in damage.items():
            with self.subTest(name):
                path = self.program(controller)
                text = path.read_text()
                changed, count = re.subn(pattern, replacement, text, count=1)
                self.assertEqual(count, 1)
                path.write_text(changed)
                seen = self.verify(controller)
                path.write_text(text)
                self.assertIn(seen.returncode, (1, 2), seen.stdout)
                self.assertTrue(told(seen) - before[controller], seen.stdout + seen.stderr)

    def test_the_way_to_the_change_is_free_with_any_tool(self):
        thick = CELL.replace("      - {name: spindle, class: spindle, length_mm: 320, diameter_mm: 160}\n  - name", f"      - {BIG}\n  - name", 1)
        planned = self.plan(cell=thick)
        self.assertEqual(planned.returncode, 1, planned.stderr)
        self.assertIn("the way between home and the call of the change of tool could not be planned", planned.stdout + planned.stderr)
        self.assertFalse((self.folder / "out" / "programs").exists())

    def test_what_a_tool_gives_way_counts(self):
        stiff = self.plan()
        self.assertEqual(stiff.returncode, 0)
        rows = (self.folder / "out" / "points.csv").read_text()
        soft = CELL.replace("    number: 2\n", "    number: 2\n    compliances: [{name: collet, mount: link6, translational_mm_N: [1.0e-4, 1.0e-4, 1.0e-4]}]\n")
        self.assertEqual(self.plan(cell=soft).returncode, 0)
        worse = (self.folder / "out" / "points.csv").read_text()
        column = rows.splitlines()[0].split(",").index("lambda_n_mm_N")
        first = [float(text.splitlines()[1].split(",")[column]) for text in (rows, worse)]
        self.assertAlmostEqual(first[1] - first[0], 1e-4, delta=3e-5)

    def test_a_pair_may_name_a_part_of_a_tool_that_is_away(self):
        cell = CELL.replace("{name: holder, class: holder, length_mm: 60, diameter_mm: 63}", "{name: chuck, class: holder, length_mm: 60, diameter_mm: 63}")
        cell, count = re.subn(r"excluded_pairs: \[\]", "excluded_pairs: [[chuck, link5]]", cell)
        self.assertEqual(count, 1)
        planned = self.plan(cell=cell)
        self.assertEqual(planned.returncode, 0, planned.stdout[-3000:])

    def test_what_is_wrong_with_tools_is_told(self):
        one = (TOP / "cells" / "kr500_r2830.yaml").read_text()
        second = CELL[CELL.index("  - name: drill_d5"):CELL.index("tool_change_deg")]
        for tool, cell, said in (
            ("", CELL, r"tool: missing; cell kr500_two_tools has several, allowed: mill_d20, drill_d5"),
            ("tool: dril_d5\n", CELL, r"job\.yaml:\d+:\d+: tool: given dril_d5; .*did you mean drill_d5\?"),
            ("tool: other\n", one, r"tool: given other; allowed, the tools of cell kr500_r2830: spindle_d20"),
            ("tool: a\n", CELL[:CELL.index("tools:")] + "tools: []\n" + CELL[CELL.index("tool_change_deg"):], r"tools: given no tool"),
            ("tool: drill_d5\n", CELL + "tool:\n" + second.replace("  - name", "  name").replace("\n    ", "\n  "), r"cell\.yaml:\d+:\d+: tool: given together with tools"),
            ("tool: drill_d5\n", CELL.replace("number: 2", "number: 1"), r"tools\[1\]\.number: given 1 twice"),
            ("tool: drill_d5\n", CELL.replace("name: drill_d5", "name: mill_d20"), r"tools\[1\]\.name: given mill_d20 twice"),
            ("tool: drill_d5\n", CELL.replace("    number: 2\n", "").replace("  linuxcnc: {m6_moves: false}", "  linuxcnc: {m6_moves: false, texts: {tool_change: 'T{number} M6'}}"),
             r"controllers\.linuxcnc\.texts\.tool_change.*\{number\}: tool drill_d5 has none"),
            ("tool: drill_d5\n", CELL.replace("  krl:\n", "  krl:\n    tool_number: 3\n"), r"controllers\.krl\.tool_number: has one number for all"),
            ("", one.replace("tool:\n", "tool:\n  number: 4\n"), r"cell\.yaml:\d+:3: tool\.number: has no effect here"),
            ("", one.replace("  krl:\n", "  krl:\n    tool_in_spindle: X\n"), r"tool_in_spindle.*has no effect"),
            ("tool: drill_d5\n", CELL.replace("  krl:\n", "  krl:\n    tool_in_spindle: 3 x\n"), r"tool_in_spindle.*letters, digits"),
            ("tool: drill_d5\n", CELL.replace("    number: 2\n", "    number: 2\n    compliances: [{name: arm, mount: link5}]\n"),
             r"compliances\[0\]\.mount: of a tool; allowed: link6"),
        ):
            with self.subTest(said):
                planned = self.plan(tool, cell)
                self.assertEqual(planned.returncode, 2, planned.stdout)
                self.assertRegex(planned.stderr, said)


if __name__ == "__main__":
    unittest.main(argv=[__file__], verbosity=2)
