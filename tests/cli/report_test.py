#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The real millpose's setup sheet of plans with one operation, with several, with a rail. Usage: report_test.py MILLPOSE TOP"""
import html.parser
import json
import os
import re
import shutil
import unittest
import xml.etree.ElementTree as Xml
from pathlib import Path

from cli_fixture import JOB, TOP, InFolder, plan, run
import operations_sample


class Page(html.parser.HTMLParser):
    """What stands under each heading, and whether tags are closed as they were opened."""
    VOID = {"meta", "br"}

    def __init__(self, text):
        super().__init__()
        self.open, self.sections, self.cells = [], {}, []
        self.feed(text)
        assert not self.open, self.open

    def handle_starttag(self, tag, attrs):
        if tag not in self.VOID:
            self.open.append(tag)
        if tag == "h2":
            self.title = ""
        if tag == "tr":
            self.cells.append([])
        if tag in ("td", "th"):
            self.cells[-1].append("")

    def handle_endtag(self, tag):
        assert self.open.pop() == tag, tag
        if tag == "h2":
            self.sections[self.title] = ""

    def handle_data(self, data):
        if "h2" in self.open:
            self.title += data
        elif self.sections and "svg" not in self.open:
            self.sections[self.title] += data
        if "td" in self.open or "th" in self.open:
            self.cells[-1][-1] += data


def page_of(text):
    return Page(re.sub(r"<(\w+)([^<>]*)/>", r"<\1\2></\1>", text))


class SetupSheet(InFolder):
    def sheet(self, *arguments):
        path = self.folder / "sheet.html"
        result = run("report", *arguments, "--html", path)
        self.assertEqual((result.returncode, result.stdout), (0, ""), result.stderr)
        return path.read_text()

    def test_one_plan(self):
        out = self.folder / "out"
        self.assertEqual(plan(out).returncode, 0)
        text = self.sheet(out, "--job", JOB)
        page, summary = page_of(text), json.loads((out / "summary.json").read_text())
        self.assertNotIn("<script", text)
        self.assertEqual([title for title in page.sections if "Before" not in title],
                         ["Summary", "What the face may be off by", "Setup", "Datum", "Tools", "What stands around the part",
                          "Programs, in the order of the work", "job.yaml", "cell.yaml"])
        for program in summary["programs"]:
            self.assertIn([summary["job"], program["controller"], program["path"], "confirmed"], page.cells)
            self.assertIn(f"Before a first run: {program['controller']}", page.sections)
        for row in summary["budget"]["rows"]:
            self.assertIn([summary["job"], row["source"].replace("_", " "), "not stated" if row["um"] is None else f"{row['um']:.3g}", row["basis"]], page.cells)
        self.assertEqual(page.sections["job.yaml"].strip(), (out / "job.yaml").read_text().strip())
        self.assertIn("nobody has measured it", page.sections["Datum"])
        # The same bytes, wherever it is written to.
        self.assertEqual(self.sheet(out, "--job", JOB), text)

    def test_picture_shows_every_cut_point_once(self):
        out = self.folder / "out"
        self.assertEqual(plan(out).returncode, 0)
        svg = Xml.fromstring(re.search(r"<svg.*?</svg>", self.sheet(out, "--job", JOB), re.S)[0])
        (cut,) = [path for path in svg.iter("path") if path.get("class") == "cut"]
        drawn = re.findall(r"[ML]([-\d.]+),([-\d.]+)", cut.get("d"))
        summary = json.loads((out / "summary.json").read_text())
        self.assertEqual(len(drawn), summary["points"]["planned"])
        self.assertEqual(cut.get("d").count("M"), summary["pieces"])
        width, height = map(float, svg.get("viewBox").split()[2:])
        for x, y in drawn:
            self.assertTrue(0 <= float(x) <= width and 0 <= float(y) <= height)
        # A parallel projection: rows of equal points stay in line. Three points of a pass, evenly laid.
        first = [tuple(map(float, p)) for p in re.findall(r"[ML]([-\d.]+),([-\d.]+)", cut.get("d").split("M")[1])]
        for a, b, c in zip(first, first[1:], first[2:]):
            area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
            self.assertLess(abs(area), 20)  # px²

    def test_skipped_points_and_findings_are_told(self):
        out = self.folder / "out"
        result = plan(out, changes=("toolpath.stepover_mm=40", "toolpath.spacing_mm=40", "workpiece.pose.xyz_mm=[2900, 0, 900]"))
        self.assertEqual(result.returncode, 1, result.stderr)
        text = self.sheet(out, "--job", JOB)
        summary = json.loads((out / "summary.json").read_text())
        self.assertGreater(summary["points"]["skipped"], 0)
        self.assertEqual(text.count('class="skipped"'), summary["points"]["skipped"])
        self.assertIn("Findings", page_of(text).sections)

    def test_operations_share_one_sheet(self):
        job, out = self.folder / "job.yaml", self.folder / "out"
        job.write_text(operations_sample.small())
        (self.folder / "cell.yaml").write_text(operations_sample.CELL)
        result = run("plan", job, "-o", out)
        self.assertEqual(result.returncode, 0, result.stderr)
        page = page_of(self.sheet(out, "--job", job))
        summary = json.loads((out / "summary.json").read_text())
        names = [one["name"] for one in summary["operations"]]
        self.assertGreater(len(names), 1)
        for name in names:
            self.assertIn(f"{name}/job.yaml", page.sections)
        for program in summary["programs"]:
            self.assertIn(["all", program["controller"], program["path"], "confirmed"], page.cells)
        for one in summary["operations"]:
            for program in one["summary"]["programs"]:
                path = f"{one['folder']}/{program['path']}"
                self.assertIn([one["name"], program["controller"], path, "confirmed"], page.cells)
                self.assertTrue((out / path).is_file(), path)
        tools = [row[0] for row in page.cells if row[0] in {one["tool"] for one in summary["operations"]}]
        self.assertEqual(len(tools), len(set(tools)))

    def test_pdf_is_of_weasyprint_and_its_absence_is_told(self):
        out = self.folder / "out"
        self.assertEqual(plan(out).returncode, 0)
        pdf, page = self.folder / "sheet.pdf", self.folder / "sheet.html"
        nowhere = self.folder / "bin"
        nowhere.mkdir()
        result = run("report", out, "--job", JOB, "--pdf", pdf, "--html", page, env={**os.environ, "PATH": str(nowhere)})
        self.assertEqual(result.returncode, 2)
        self.assertIn("apt-get install weasyprint", result.stderr)
        # A program of its name: what it gets is the page, what it prints is the file.
        fake = nowhere / "weasyprint"
        fake.write_text("#!/bin/sh\n/bin/echo '%PDF-1.7'\nexec /bin/cat\n")
        fake.chmod(0o755)
        self.assertFalse(page.exists() or pdf.exists())
        result = run("report", out, "--job", JOB, "--pdf", pdf, "--html", page, env={**os.environ, "PATH": str(nowhere)})
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(pdf.read_text(), "%PDF-1.7\n" + page.read_text())
        fake.write_text("#!/bin/sh\n/bin/echo no fonts >&2\nexit 3\n")
        pdf.unlink()
        result = run("report", out, "--job", JOB, "--pdf", pdf, env={**os.environ, "PATH": str(nowhere)})
        self.assertEqual((result.returncode, pdf.exists()), (2, False))
        self.assertIn("weasyprint ended with 3: no fonts", result.stderr)

    def test_bad_input(self):
        out = self.folder / "out"
        self.assertEqual(plan(out).returncode, 0)
        shutil.copytree(out, self.folder / "strange")
        for words, *arguments in (("at least one of them", out), ("has no .millpose", TOP / "cells", "--html", "x.html")):
            result = run("report", *arguments, cwd=self.folder)
            self.assertEqual((result.returncode, result.stdout), (2, ""))
            self.assertIn(words, result.stderr)
        (self.folder / "strange" / "summary.json").write_text('{"points": 3}')
        result = run("report", self.folder / "strange", "--job", JOB, "--html", self.folder / "x.html")
        self.assertEqual(result.returncode, 2, result.stdout)
        self.assertIn("summary.json", result.stderr)
        self.assertFalse(Path(self.folder, "x.html").exists())


if __name__ == "__main__":
    unittest.main(argv=["report_test.py"])
