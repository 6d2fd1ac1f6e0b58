#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Walks of people through a day, typed into a real terminal: the newcomer, the daily edit, the one who keeps CI, the one with a calibrated
arm, the one who hands out paper (slow). Usage: walks_test.py MILLPOSE TOP"""
import csv
import json
import re
import shutil
import subprocess
import tempfile
import unittest
import xml.etree.ElementTree as Xml

import stiffness_test
from cli_fixture import MILLPOSE, TOP, InFolder
from terminal import Terminal

tempfile.tempdir = "/tmp"  # paths that messages name must fit into 80 columns
NEEDED = ("tmux", "weasyprint", "pdfinfo", "pdftotext")
# The sample's face in a few points, for walks in which the plan is not what is looked at.
FEW = ("--set", "toolpath.stepover_mm=30", "--set", "toolpath.spacing_mm=20")
MOST_LINES = 12


def words(lines):
    """All of it with single blanks: as it reads, wherever the program broke it."""
    return " ".join(" ".join(lines).split())


def sentences(lines):
    """What the program broke at the terminal's width, put together again: what goes on is indented to the eleventh column."""
    return re.sub(r"\n {11}(?! )", " ", "\n".join(lines)).split("\n")


class Walk(InFolder):
    def setUp(self):
        super().setUp()
        self.assertEqual([name for name in NEEDED if shutil.which(name) is None], [], "install packages-slow.txt")
        for name in ("cells", "toolpaths"):
            shutil.copytree(TOP / name, self.folder / name)
        self.terminal = self.terminal_of(80)

    def terminal_of(self, columns):
        terminal = Terminal(columns, self.folder / f"tmux{columns}")
        self.addCleanup(terminal.close)
        return terminal

    def types(self, status, *words, terminal=None):
        """Types a command; its lines, which must fit the terminal and leave no bar behind, and its exit status as it must be."""
        terminal = terminal or self.terminal
        lines, found = terminal.type(MILLPOSE, *words)
        told = "\n".join(lines)
        self.assertEqual(found, status, told)
        self.assertEqual([line for line in lines if len(line) > terminal.columns], [], "broken by the terminal")
        self.assertNotRegex(told, r"\[#*\.*\]", "a bar was left behind")
        return lines

    def edit(self, name, before, after):
        path = self.folder / name
        text = path.read_text()
        self.assertEqual(text.count(before), 1, before)
        path.write_text(text.replace(before, after))


class Newcomer(Walk):
    def write_block(self):
        text = (TOP / "docs/tutorial.md").read_text()
        (self.folder / "block.obj").write_text(re.search(r"(?ms)^v -60 -40 -20$.*?^f 4 1 5 8$", text)[0] + "\n")

    def assert_brief(self, lines, begin="done"):
        """The last lines say in twelve what there is to know, and all lines before them are stages."""
        first = next(i for i, line in enumerate(lines) if line.startswith(begin + " "))
        for line in lines[:first]:
            self.assertRegex(line, r"^([a-z]+(?: [a-z]+)* +[\d.]+ s  | {11,})", "no stage")
        brief = sentences(lines[first:])
        self.assertLessEqual(len(brief), MOST_LINES)
        kinds = [line.split()[0] for line in brief]
        self.assertEqual([kinds[0], kinds[-1]], [begin, "report"])
        self.assertLessEqual({"programs", "cycle", "clearance", "face"}, set(kinds))
        self.assertNotIn("`", "\n".join(brief))
        return brief

    def test_the_first_ten_minutes(self):
        self.write_block()
        for terminal in (self.terminal, self.terminal_of(120)):
            out = f"first{terminal.columns}"
            with self.subTest(terminal.columns):
                self.assertIn("plan", "\n".join(self.types(0, "--help", terminal=terminal)))
                lines = self.types(0, "init", "block.obj", "--arm", "kr500_r2830", "--out", out, terminal=terminal)
                self.assertTrue(any(line.startswith("next ") and f"millpose plan {out}/job.yaml" in line for line in sentences(lines)))
                self.types(0, "check", f"{out}/job.yaml", terminal=terminal)
                brief = self.assert_brief(self.types(0, "plan", f"{out}/job.yaml", terminal=terminal))
                self.assertTrue((self.folder / brief[-1].split()[-1]).is_file(), "the report stands where the last line says")

    def test_a_sample_as_the_readme_has_it(self):
        for terminal in (self.terminal, self.terminal_of(120)):
            out = f"panel{terminal.columns}"
            with self.subTest(terminal.columns):
                brief = self.assert_brief(self.types(0, "plan", "toolpaths/cabin_panel/job.yaml", "-o", out, terminal=terminal))
                self.assertIn("2386 of 2386 points", brief[0])
                self.assertEqual(brief[-1].split(), ["report", f"{out}/report.html"])

    def test_points_out_of_reach_are_told_first(self):
        self.edit("toolpaths/support_pad/job.yaml", "xyz_mm: [2076, 0, 1006]", "xyz_mm: [2950, 0, 1006]")
        lines = self.types(1, "plan", "toolpaths/support_pad/job.yaml", "-o", "far", *FEW)
        brief = sentences(lines[next(i for i, line in enumerate(lines) if line.startswith("INCOMPLETE ")):])
        self.assertLessEqual(len(brief), MOST_LINES)
        self.assertRegex(brief[1], r"^skipped +\d+ \w+, .*first point \d+ \(pass \d+\): ")


class DailyEdit(Walk):
    JOB = "toolpaths/support_pad/job.yaml"

    def test_a_feed_is_changed_and_looked_at(self):
        self.types(0, "plan", self.JOB, "-o", "monday", *FEW)
        self.edit(self.JOB, "feed_mm_min: 80", "feed_mm_min: 60")
        self.types(0, "plan", self.JOB, "-o", "tuesday", *FEW)
        lines = self.types(0, "diff", "monday", "tuesday", "--html", "diff.html")
        self.assertEqual(lines[0], "settings   process.feed_mm_min: 80 -> 60")
        sections = {line.split()[0] for line in lines if line and not line.startswith(" ")}
        self.assertLessEqual({"points", "programs"}, sections)
        self.assertNotIn("poses", sections)
        self.assertIn("process.feed_mm_min", (self.folder / "diff.html").read_text())
        for rule, status in (("any", 1), ("programs", 1), ("poses", 0), ("cycle_times.krl.total_s:10", 1), ("cycle_times.krl.total_s:90", 0)):
            lines = self.types(status, "diff", "monday", "tuesday", "--fail-on", rule)
            self.assertEqual(any(line.startswith("fails ") and f"--fail-on {rule}" in line for line in lines), status == 1, rule)
        self.types(0, "diff", "monday", "monday", "--fail-on", "any")
        told = words(self.types(2, "diff", "monday", "tuesday", "--fail-on", "clearence_min_mm:5"))
        self.assertRegex(told, r'no figure "clearence_min_mm"; known: .*did you mean "clearance_min_mm"')

    def test_slips_are_named_where_they_stand(self):
        self.edit(self.JOB, "stepover_mm:", "stepver_mm:")
        told = words(self.types(2, "plan", self.JOB, "-o", "slip"))
        self.assertRegex(told, r"job\.yaml:\d+:3: toolpath\.stepver_mm: unknown key; nearest known key: stepover_mm")
        self.edit(self.JOB, "stepver_mm:", "stepover_mm:")
        self.edit(self.JOB, "name: support_pad\n", 'name: "support_pad\n')
        told = words(self.types(2, "plan", self.JOB, "-o", "slip"))
        self.assertRegex(told, r'job\.yaml:4:7: " is opened here and not closed')
        self.assertFalse((self.folder / "slip").exists(), "nothing is left of a job that cannot be read")


class KeepsCi(Walk):
    NAMES = ("support_curve", "support_cam")
    CURVE = "toolpaths/support_curve/job.yaml"

    def cases(self, out):
        return {case.get("name"): case for case in Xml.parse(self.folder / out / "junit.xml").getroot().iter("testcase")}

    def test_a_batch_with_a_baseline(self):
        jobs = "".join(f"  - {{job: toolpaths/{name}/job.yaml}}\n" for name in self.NAMES)
        (self.folder / "jobs.yaml").write_text("millpose_batch: 1\njobs:\n" + jobs)
        self.types(0, "batch", "jobs.yaml", "-o", "agreed")
        self.edit(self.CURVE, "feed_mm_min: 600\n  plunge", "feed_mm_min: 60\n  plunge")
        self.types(0, "batch", "jobs.yaml", "-o", "now", "--baseline", "agreed")
        told = {name: "".join(case.itertext()) for name, case in self.cases("now").items()}
        self.assertEqual(set(told), set(self.NAMES))
        self.assertIn("process.feed_mm_min: 600 -> 60", told["support_curve"])
        self.assertNotIn("feed_mm_min", told["support_cam"])
        self.assertIn("process.feed_mm_min: 600 -&gt; 60", (self.folder / "now/index.html").read_text())
        lines = self.types(1, "diff", "agreed", "now", "--fail-on", "any")
        self.assertIn("process.feed_mm_min: 600 -> 60", words(lines))
        self.types(0, "diff", "agreed", "agreed", "--fail-on", "any")
        # A bracket, then a quote is forgotten: the place where it opens, and the other job all the same.
        for before, after, place in (("linuxcnc]", "linuxcnc", r"job\.yaml:\d+:11: not YAML: \[ is opened here and not closed"),
                                     ("linuxcnc\n", '"linuxcnc]\n', r'job\.yaml:\d+:28: " is opened here and not closed')):
            self.edit(self.CURVE, before, after)
            self.types(2, "batch", "jobs.yaml", "-o", "broken")
            cases = self.cases("broken")
            failed = {name: case[0] for name, case in cases.items() if len(case) > 0 and case[0].tag in ("error", "failure")}
            self.assertEqual((set(cases), set(failed)), (set(self.NAMES), {"support_curve"}))
            self.assertRegex((failed["support_curve"].get("message") or "") + (failed["support_curve"].text or ""), place)
            self.assertTrue((self.folder / "broken/support_cam/report.html").is_file())


class CalibratedArm(Walk):
    """A tracker has seen an arm that errs by millimetres; the cell learns it, and programs take it out."""
    JOB, CELL = "toolpaths/support_pad/job.yaml", "cells/kr500_r2830.yaml"
    TAKEN_OUT = ("--set", "compensation.deviations=true", "--set", "compensation.max_deviation_mm=20")

    def test_from_readings_to_programs(self):
        arm = stiffness_test.Geometry("reading")
        arm.LENGTHS = (1045, 500, 1300, 1025, -55, 290)
        arm.readings(self.folder / "seen.csv", 60, 2, 0.03, arm.drawn(1))
        lines = self.types(0, "identify", "seen.csv", "--geometry", "--cell", self.CELL, "--write-cell", self.CELL, "--serial", "882134",
                           "--date", "2026-11-29")
        nominal, fitted = map(float, re.search(r"mm RMS: ([\d.]+) by the nominal arm, ([\d.]+) fitted", words(lines)).groups())
        self.assertGreater(nominal, 10 * fitted)
        self.assertIn('serial: "882134"', (self.folder / self.CELL).read_text())
        self.types(0, "check", self.CELL)
        self.types(0, "plan", self.JOB, "-o", "nominal", *FEW)
        self.types(0, "plan", self.JOB, "-o", "corrected", *FEW, *self.TAKEN_OUT)
        (program,) = (self.folder / "corrected/programs/linuxcnc").glob("*.ngc")
        self.assertIn("corrected_for_arm: 882134, measured on 2026-11-29", program.read_text())
        with open(self.folder / "corrected/compensation.csv", newline="", encoding="utf-8") as file:
            self.assertGreater(len(list(csv.DictReader(file))), 10)
        self.types(0, "verify", "corrected", "--job", self.JOB)
        lines = self.types(0, "diff", "nominal", "corrected")
        self.assertTrue(any(line.startswith("settings") and "compensation" in line for line in lines), lines)
        self.assertTrue(any(line.startswith("programs") for line in lines), lines)


class HandsOutPaper(Walk):
    def pages(self, name):
        told = subprocess.run(["pdfinfo", self.folder / name], capture_output=True, text=True, check=True).stdout
        self.assertRegex(told, r"(?m)^Page size: +595\.\d+ x 841\.\d+ pts \(A4\)")
        return int(re.search(r"(?m)^Pages: +(\d+)$", told)[1])

    def text(self, name, page):
        return subprocess.run(["pdftotext", "-f", str(page), "-l", str(page), "-layout", self.folder / name, "-"], capture_output=True, text=True,
                              check=True).stdout

    def test_sheets_of_a_job_of_three_operations(self):
        job = "toolpaths/cabin_window/job.yaml"
        self.types(0, "plan", job, "-o", "window")
        summary = json.loads((self.folder / "window/summary.json").read_text())
        self.types(0, "report", "window", "--job", job, "--summary", "--pdf", "summary.pdf")
        self.assertEqual(self.pages("summary.pdf"), 2)
        self.types(0, "report", "window", "--job", job, "--html", "setup.html", "--pdf", "setup.pdf")
        count = self.pages("setup.pdf")
        self.assertLessEqual(count, 16)
        for page in range(1, count + 1):
            self.assertRegex(self.text("setup.pdf", page), rf"\b{page} / {count}\b", "a page without its number")
        whole = "".join(self.text("setup.pdf", page) for page in range(1, count + 1))
        for operation in summary["operations"]:
            self.assertIn(operation["name"], whole)
        self.types(0, "report", "window", "--job", job, "--summary", "--lang", "de", "--pdf", "de.pdf")
        self.assertEqual(self.pages("de.pdf"), 2)
        self.assertNotEqual(self.text("de.pdf", 2), self.text("summary.pdf", 2))


if __name__ == "__main__":
    unittest.main(argv=["walks_test.py"])
