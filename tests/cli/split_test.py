# SPDX-License-Identifier: GPL-3.0-or-later
"""A CAM file for several tools as operations: `check --split`, and `init` of such a file. Arguments: MILLPOSE TOP"""
import os
import re
import unittest

from cli_fixture import TOP, InFolder, run


def path(cutters, speeds=None):
    """CLDATA with a straight cut for each cutter, 40 mm beside the one before."""
    lines = ["PARTNO/SPLIT", "UNITS/MM"]
    for i, (number, diameter) in enumerate(cutters):
        x = 40 * i
        lines += [f"CUTTER/{diameter}", f"LOADTL/{number}", f"SPINDL/{speeds[i] if speeds else 7000},RPM,CLW", "RAPID", f"GOTO/{x},0,50",
                  "FEDRAT/600.,MMPM", f"GOTO/{x},0,0", f"GOTO/{x},60,0", "RAPID", f"GOTO/{x},60,50"]
    return "\n".join([*lines, "FINI", ""])


JOB = """millpose_job: 1   # ours
name: two_tools
cell: {cell}
{tool}seed: 1
# Measured on Monday.
workpiece:
  unit: mm
  frame: robot_base
  pose: {{xyz_mm: [1900, 0, 900], abc_deg: [0, 0, 0]}}
toolpath:
  strategy: cam
  cam: {{file: two.apt}}
  spacing_mm: 10
  chord_tolerance_mm: 0.01
  rotation_reference: [1, 0, 0]

# Of the shop.
process: {{feed_mm_min: 600, plunge_feed_mm_min: 200, spindle_rpm: 7000}}
programs: [krl]
"""


class Split(InFolder):
    def job(self, cutters, tool="", cell="kr500_two_tools", speeds=None):
        (self.folder / "two.apt").write_text(path(cutters, speeds))
        job = self.folder / "job.yaml"
        job.write_text(JOB.format(cell=TOP / "cells" / f"{cell}.yaml", tool=tool))
        return job

    def split(self, job, name="split.yaml"):
        return run("check", job, "--split", self.folder / name)

    def test_each_section_is_an_operation_with_its_tool_in_the_files_order(self):
        job = self.job([(7, 20), (2, 5), (7, 20)], speeds=[7000, 1500, 9000])
        unsplit = run("check", job)
        self.assertEqual(unsplit.returncode, 2)
        result = self.split(job)
        self.assertLess(result.returncode, 2, result.stderr)
        self.assertIn("split.yaml: mill_d20, drill_d5, mill_d20_2", result.stdout)
        text = (self.folder / "split.yaml").read_text()
        self.assertEqual(re.findall(r"name: (\w+)\n +tool: (\w+)", text), [("mill_d20", "mill_d20"), ("drill_d5", "drill_d5"), ("mill_d20_2", "mill_d20")])
        self.assertEqual(re.findall(r"section: (\d)", text), ["1", "2", "3"])
        self.assertEqual(re.findall(r"spindle_rpm: (\d+)", text), ["1500", "9000", "7000"])  # the first is the job's own
        for kept in ("millpose_job: 1   # ours", "# Measured on Monday.", "# Of the shop.", "programs: [krl]"):
            self.assertIn(kept, text)
        self.assertEqual(len(re.findall(r"^operation  ", result.stdout, re.M)), 3)
        self.assertIn("already", self.split(job).stderr)  # nothing is written over
        self.assertEqual(run("check", self.folder / "split.yaml").returncode, result.returncode)

    def test_what_no_tool_fits_is_refused_with_what_the_cell_has(self):
        for cutters, words in (([(1, 20), (2, 6)], "section 2 is for tool 2 D6 at 7,000/min clockwise, and cell kr500_two_tools has no tool with it; "
                                "given mill_d20 (number 1, 20 mm), drill_d5 (number 2, 5 mm)"),
                               ([(1, 20), (2, "5,1")], "with corners of 1 mm"),
                               ([(1, 20), (1, 20)], "nothing to split")):
            result = self.split(self.job(cutters))
            self.assertEqual(result.returncode, 2, result.stdout)
            self.assertIn(words, result.stderr)
            self.assertFalse((self.folder / "split.yaml").exists())

    def test_a_cell_with_one_tool_takes_speeds_alone(self):
        result = self.split(self.job([(1, 20), (1, 20)], cell="kr500_r2830", speeds=[7000, 9000]))
        self.assertLess(result.returncode, 2, result.stderr)
        self.assertNotIn("tool:", (self.folder / "split.yaml").read_text())
        self.assertIn("has no tool with it", self.split(self.job([(1, 20), (2, 6)], cell="kr500_r2830"), "other.yaml").stderr)

    def test_a_speed_that_no_section_has_goes(self):
        result = self.split(self.job([(1, 20), (2, 5)], speeds=[6000, 1500]))
        self.assertLess(result.returncode, 2, result.stderr)
        text = (self.folder / "split.yaml").read_text()
        self.assertEqual(re.findall(r"spindle_rpm: (\d+)", text), ["6000", "1500"])
        self.assertIn("plunge_feed_mm_min: 200", text)

    def test_it_stands_beside_a_job_of_one_toolpath(self):
        job = self.job([(1, 20), (2, 5)], tool="tool: mill_d20\n")
        (self.folder / "sub").mkdir()
        self.assertIn("its paths count from there", self.split(job, "sub/split.yaml").stderr)
        self.assertLess(self.split(job).returncode, 2)
        self.assertIn("the job has them already", self.split(self.folder / "split.yaml", "again.yaml").stderr)
        self.assertIn("needs a job", self.split(self.folder / "two.apt").stderr)
        self.assertNotIn("\ntool:", (self.folder / "split.yaml").read_text())

    def init(self, *arguments):
        return run("init", self.folder / "two.apt", *arguments, "-q", cwd=self.folder)

    def test_init_of_a_path_writes_operations_that_plan(self):
        (self.folder / "two.apt").write_text(path([(1, 20), (2, 5)]))
        own = self.init("--cell", TOP / "cells/kr500_two_tools.yaml", "--out", "own")
        self.assertEqual(own.returncode, 0, own.stderr)
        self.assertIn("path       2 operations: mill_d20, drill_d5", own.stdout)
        self.assertEqual([p.name for p in (self.folder / "own").iterdir()], ["job.yaml"])
        if "MILLPOSE_SLOW" in os.environ:
            planned = run("plan", self.folder / "own" / "job.yaml", "-q")
            self.assertEqual(planned.returncode, 0, planned.stdout + planned.stderr)

    def test_init_of_a_path_gives_a_sample_cell_its_cutters(self):
        (self.folder / "two.apt").write_text(path([(4, 20), (9, "6,3"), (4, 20)]))
        made = self.init("--arm", "kr500_r2830", "--out", "made")
        self.assertEqual(made.returncode, 0, made.stderr)
        cell, job = ((self.folder / "made" / name).read_text() for name in ("cell.yaml", "job.yaml"))
        self.assertIn("name: mill_d20\n", cell)
        self.assertIn("cutter: {shape: ball, diameter_mm: 6, ", cell)
        self.assertIn("class: cutter, length_mm: 60, diameter_mm: 6}", cell)
        self.assertEqual(re.findall(r"name: (\w+)\n +tool: (\w+)", job), [("mill_d20", "mill_d20"), ("mill_d6", "mill_d6"), ("mill_d20_2", "mill_d20")])
        if "MILLPOSE_SLOW" in os.environ:
            planned = run("plan", self.folder / "made" / "job.yaml", "-q")
            self.assertEqual(planned.returncode, 0, planned.stdout + planned.stderr)

    def test_init_of_a_path_refuses_what_it_cannot_know(self):
        (self.folder / "two.apt").write_text(path([(1, 20), (2, 6)]))
        self.assertIn("has no tool with it", self.init("--cell", TOP / "cells/kr500_two_tools.yaml").stderr)
        (self.folder / "two.apt").write_text(path([(1, 20)]).replace("GOTO/0,60,", "GOTO/0,60000,"))
        self.assertIn("is 60 m long", self.init("--arm", "kr500_r2830").stderr)
        (self.folder / "two.apt").write_text("PARTNO/X\nUNITS/MM\nRAPID\nGOTO/0,0,0\n")
        self.assertIn("holds no cut", self.init("--arm", "kr500_r2830").stderr)
        self.assertEqual(sorted(p.name for p in self.folder.iterdir()), ["two.apt"])


if __name__ == "__main__":
    unittest.main(argv=["split_test"], verbosity=1)
