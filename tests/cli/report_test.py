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

from cli_fixture import FEW, JOB, TOP, InFolder, plan, run
import operations_sample
from pdf_pages import pages_of


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


def brief(out, language):
    """A plan of few points that ends with the summary of twelve lines."""
    return run("plan", JOB, "-o", out, *(word for change in FEW for word in ("--set", change)), "--lang", language)


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
        (tool,) = [row for row in page.cells if row[0] == "spindle_d20"]
        self.assertEqual(tool[3], "60, 60, 320")
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
        signed = page_of(self.summary(out, "--job", job))
        self.assertEqual([row[0] for row in signed.cells if row[0] in names], names)
        manifest = {one["path"]: one["hash"] for one in json.loads((out / "manifest.json").read_text())["files"]}
        for program in summary["programs"]:
            self.assertIn([program["controller"], program["path"], "confirmed", manifest[program["path"]]], signed.cells)
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

    def test_languages_say_the_same_with_the_same_figures(self):
        out = self.folder / "out"
        self.assertEqual(plan(out).returncode, 0)
        english = page_of(self.sheet(out, "--job", JOB))
        files = [title for title in english.sections if title.endswith(".yaml")]
        for language, titles, milled, step in (
                ("de", ["Zusammenfassung", "Aufspannung", "Bezug", "Werkzeuge"], r"\d+ von \d+ Punkten in \d+ Bahnen", "Trockenlauf"),
                ("zh", ["概要", "装夹", "基准", "刀具"], r"\d+ 点中的 \d+ 点，\d+ 次走刀", "空运行")):
            text = self.sheet(out, "--job", JOB, "--lang", language)
            self.assertIn(f'<html lang="{language}">', text)
            page = page_of(text)
            for title in titles:
                self.assertIn(title, page.sections)
            self.assertRegex(text, milled)
            self.assertIn(step, text)
            # The platform of the cell is a name, its kind a word.
            self.assertIn("platform", [row[0] for row in page.cells])
            self.assertNotIn("platform", [row[1] for row in page.cells if len(row) > 1])
            self.assertEqual([page.sections[file] for file in files], [english.sections[file] for file in files])
            self.assertEqual([[sorted(re.findall(r"[\d.]*\d", cell)) for cell in row] for row in page.cells],
                             [[sorted(re.findall(r"[\d.]*\d", cell)) for cell in row] for row in english.cells])
            # No sentence is left in English: its little words would tell.
            said = " ".join(section for title, section in page.sections.items() if title not in files)
            self.assertEqual(re.findall(r"\b(?:the|which|with|are|what|and|is not)\b", said), [], language)

    def test_plan_says_its_summary_in_the_language(self):
        said = {}
        for language in ("en", "de", "zh"):
            out = self.folder / language
            result = brief(out, language)
            self.assertEqual(result.returncode, 0, result.stderr)
            said[language] = result.stdout.replace(str(out), "OUT")
            page = (out / "report.html").read_text()
            self.assertIn(f'<html lang="{language}">', page)
            # Only the page differs, and in nothing but the language that it opens in.
            self.assertEqual(page.replace(f'<html lang="{language}">', '<html lang="en">'), (self.folder / "en" / "report.html").read_text())
            for name in ("summary.json", "points.csv", "path.vtp", "job.yaml"):
                self.assertEqual((out / name).read_bytes(), (self.folder / "en" / name).read_bytes(), name)
            again = brief(out, language).stdout.replace(str(out), "OUT").splitlines()
            self.assertEqual(again[:-1], said[language].splitlines())
        self.assertTrue(said["en"].startswith("done       "))
        self.assertRegex(said["de"], r"^fertig     .*: \d+ von \d+ Punkten in \d+ Bahnen\n")
        self.assertRegex(said["zh"], r"^完成       .*：\d+ 点中的 \d+ 点，\d+ 次走刀\n")
        self.assertIn("\nBericht    OUT/report.html\n", said["de"])
        for text in said.values():
            self.assertLessEqual(text.count("\n"), 12)
            self.assertEqual(sorted(re.findall(r"[\d.]*\d", text)), sorted(re.findall(r"[\d.]*\d", said["en"])))
        for language in ("de", "zh"):
            self.assertEqual(re.findall(r"\b(?:confirmed|files?|with|the|and|not|assumed|more)\b", said[language]), [], language)

    def test_an_unknown_language_is_refused_with_those_there_are(self):
        for arguments in (("report", self.folder, "--html", "x.html"), ("plan", JOB, "-o", self.folder / "out")):
            result = run(*arguments, "--lang", "zhe", env={**os.environ, "LANG": "de_DE.UTF-8", "LC_ALL": "de_DE.UTF-8"})
            self.assertEqual((result.returncode, result.stdout), (2, ""))
            for part in ("--lang", "zhe", "known: en, de, zh", 'did you mean "zh"?'):
                self.assertIn(part, result.stderr)
        self.assertFalse((self.folder / "out").exists())

    def summary(self, *arguments):
        """The two pages, as HTML."""
        text = self.sheet(*arguments, "--summary")
        self.assertEqual(text.count('<section class="page">'), 2)
        self.assertNotIn("<script", text)
        return text

    def test_the_summary_says_what_is_signed(self):
        out = self.folder / "out"
        self.assertEqual(plan(out).returncode, 0)
        text = self.summary(out, "--job", JOB)
        page, summary = page_of(text), json.loads((out / "summary.json").read_text())
        manifest = {one["path"]: one["hash"] for one in json.loads((out / "manifest.json").read_text())["files"]}
        self.assertIn('<div class="verdict"><b>done</b>', text)
        for program in summary["programs"]:
            self.assertIn([program["controller"], program["path"], "confirmed", manifest[program["path"]]], page.cells)
        self.assertIn(json.loads((out / "run.json").read_text())["manifest"], text)
        self.assertIn(f"<b>{summary['points']['planned']} / {summary['points']['total']}</b>", text)
        self.assertIn(f"<b>{summary['clearance_min_mm']:.1f}</b>", text)
        self.assertIn(f"<b>{summary['budget']['sum_um']:.3g}</b>", text)
        bars = {row[0]: row[2] for row in page.cells if len(row) == 3 and row[2].endswith(" µm")}
        self.assertEqual(bars, {**{row["source"].replace("_", " "): f"{row['um']:.3g} µm" for row in summary["budget"]["rows"] if row["um"] is not None},
                                "sum of what is stated": f"{summary['budget']['sum_um']:.3g} µm"})
        self.assertEqual(len(re.findall('class="course"', text)), 3)  # compliance; displacement by force and by lost motion
        self.assertEqual(self.summary(out, "--job", JOB), text)
        for language, verdict in (("de", "fertig"), ("zh", "完成")):
            said = self.summary(out, "--job", JOB, "--lang", language)
            self.assertIn(f'<div class="verdict"><b>{verdict}</b>', said)
            read = re.sub(r"(?s)<style>.*?</style>|<code>.*?</code>|<[^>]*>", " ", said)
            self.assertEqual(re.findall(r"\b(?:the|with|are|is|and|of|not|confirmed|by)\b", read), [], language)
            self.assertEqual(re.findall(r'class="course" d="[^"]*"', said), re.findall(r'class="course" d="[^"]*"', text))
        if shutil.which("weasyprint"):
            pdf = self.folder / "summary.pdf"
            self.assertEqual(run("report", out, "--job", JOB, "--summary", "--pdf", pdf).returncode, 0)
            self.assertEqual(pages_of(pdf.read_bytes()), 2)
        # What was changed since is not signed.
        program = out / summary["programs"][0]["path"]
        program.write_bytes(program.read_bytes() + b"\n")
        refused = run("report", out, "--job", JOB, "--summary", "--html", self.folder / "x.html")
        self.assertEqual(refused.returncode, 2)
        self.assertIn(program.name, refused.stderr)

    def test_the_summary_says_why_a_plan_is_not_done(self):
        out = self.folder / "out"
        result = plan(out, changes=("toolpath.stepover_mm=40", "toolpath.spacing_mm=40", "workpiece.pose.xyz_mm=[2900, 0, 900]"))
        self.assertEqual(result.returncode, 1, result.stderr)
        text, summary = self.summary(out, "--job", JOB), json.loads((out / "summary.json").read_text())
        self.assertIn("<b>INCOMPLETE</b>", text)
        self.assertIn(f"{summary['job']}: {summary['points']['skipped']} of {summary['points']['total']} points are left out: ", text)
        self.assertIn(summary["skipped"][0]["detail"][:60], text)

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
