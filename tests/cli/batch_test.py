#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""A batch of fourteen small jobs (thirty in the slow tier), five of them broken in different ways.

Usage: batch_test.py MILLPOSE TOP
"""
import csv
import html.parser
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree as xml

import json_schema

MILLPOSE, TOP = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
SAMPLE = TOP / "toolpaths" / "support_pad"
JOBS = 30 if "MILLPOSE_SLOW" in os.environ else 14
# How a job is broken: (text of the job, its replacement, what the cause must say).
BROKEN = {
    3: ("stepover_mm", "stepovr_mm", "nearest known key: stepover_mm"),
    8: ("spacing_mm: 80", "spacing_mm: -80", "spacing_mm: given -80"),
    5: ("support_pad.stl", "none.stl", "none.stl: cannot open"),
    10: ("support_pad.stl", "empty.stl", "empty.stl"),
    12: ("millpose_job: 1", "millpose_job: [", "part12/job.yaml:"),
}


def write_jobs(folder):
    text = (SAMPLE / "job.yaml").read_text(encoding="utf-8")
    for old, new in (("../../cells", str(TOP / "cells")), ("stepover_mm: 8", "stepover_mm: 70"),
                     ("spacing_mm: 4", "spacing_mm: 80"), ("mesh: ", f"mesh: {SAMPLE}/"),
                     ("exhaustive_step_deg: 0.05", "exhaustive_step_deg: 1"), ("[krl, sinumerik, linuxcnc]", "[krl]")):
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    for i in range(JOBS):
        job = text.replace("name: support_pad", f"name: part{i}").replace("seed: 1", f"seed: {i}")
        if i in BROKEN:
            old, new, _ = BROKEN[i]
            if new == "empty.stl":
                (folder / "empty.stl").write_bytes(b"solid x\nendsolid x\n")
                old, new = f"{SAMPLE}/{old}", f"{folder}/{new}"
            assert job.count(old) == 1, old
            job = job.replace(old, new)
        (folder / f"parts/part{i}").mkdir(parents=True)
        (folder / f"parts/part{i}/job.yaml").write_text(job, encoding="utf-8")


class Page(html.parser.HTMLParser):
    """What a page leads to and what it loads."""

    def __init__(self):
        super().__init__()
        self.links, self.loads = [], []

    def handle_starttag(self, tag, attrs):
        for name, value in attrs:
            if name == "href":
                (self.links if tag == "a" else self.loads).append(value)
            elif name == "src":
                self.loads.append(value)


class Many(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory(prefix="millpose-batch-test.")
        cls.addClassCleanup(folder.cleanup)
        cls.folder = pathlib.Path(folder.name)
        write_jobs(cls.folder)
        cls.result, cls.report, cls.suite = cls.run_batch()
        cls.tables = cls.read_tables()

    @classmethod
    def run_batch(cls):
        result = subprocess.run([MILLPOSE, "batch", "parts/part*/job.yaml", "--memory-MB", "400", "-q"], cwd=cls.folder,
                                capture_output=True, text=True, timeout=600, check=False)
        report = json.loads((cls.folder / "batch.out/batch.json").read_text(encoding="utf-8"))
        return result, report, xml.parse(cls.folder / "batch.out/junit.xml").getroot()

    @classmethod
    def read_tables(cls):
        return {name: (cls.folder / "batch.out" / name).read_bytes() for name in ("index.html", "batch.csv")}

    def test_figures_are_those_of_the_summaries(self):
        rows = {row["name"]: row for row in csv.DictReader(self.tables["batch.csv"].decode().splitlines(keepends=True))}
        self.assertEqual(list(rows), [job["name"] for job in self.report["jobs"]])
        for job in self.report["jobs"]:
            row = rows[job["name"]]
            if job["status"] == 2:
                self.assertIsNone(job["figures"])
                self.assertEqual((row["outcome"], row["cause"], row["cycle_s"]), ("bad input", job["cause"], ""))
                continue
            summary = json.loads((self.folder / "batch.out" / job["folder"] / "summary.json").read_text())
            stiffness = summary["stiffness"]
            figures = {
                "objective": summary["objective"], "objective_unit": stiffness["units"]["objective"],
                "objective_median": stiffness["objective"]["median"],
                "objective_worst": stiffness["objective"]["worst"],
                **{f"{index}_worst_mm_N": stiffness[index]["worst"] for index in ("lambda_t1", "lambda_t2", "lambda_n")},
                "clearance_min_mm": summary["clearance_min_mm"],
                "deflection_level_mm": summary["deflection"]["level_mm"],
                "deflection_variation_mm": summary["deflection"]["variation_mm"],
                "cycle_s": max(times["total_s"] for times in summary["cycle_times"])}
            self.assertEqual(job["figures"], figures)
            for name, value in figures.items():
                shown = row[name] if isinstance(value, str) else float(row[name]) if row[name] else None
                self.assertEqual(shown, value, name)
            self.assertEqual([int(row["points"]), int(row["planned"])], [job["points"], job["planned"]])

    def test_the_index_leads_to_every_report_and_loads_nothing(self):
        text = self.tables["index.html"].decode()
        page = Page()
        page.feed(text)
        reports = [f"part{i}/report.html" for i in range(JOBS) if i not in BROKEN]
        self.assertEqual(sorted(page.links), sorted(reports + ["batch.csv", "batch.json"]))
        for link in reports:
            self.assertTrue((self.folder / "batch.out" / link).is_file(), link)
        self.assertEqual(page.loads, [])
        self.assertNotIn("http", text)
        self.assertEqual(text.count("<tr><td>"), JOBS)
        for job in self.report["jobs"]:
            self.assertIn(f">{job['name']}<", text)

    def test_all_but_the_broken_are_done(self):
        self.assertEqual(self.result.returncode, 2, "the worst of all")
        self.assertIn(f"{JOBS} jobs: {JOBS - 5} done, 0 with findings, 5 failed", self.result.stdout)
        self.assertEqual([self.report[key] for key in ("total", "done", "findings", "failed")], [JOBS, JOBS - 5, 0, 5])
        schema = json.loads((TOP / "docs/schema/batch-result.schema.json").read_text(encoding="utf-8"))
        self.assertEqual(list(json_schema.problems(self.report, schema)), [])
        for job in self.report["jobs"]:
            broken = int(job["name"].removeprefix("part")) in BROKEN
            self.assertEqual(job["status"], 2 if broken else 0, job)
            programs = self.folder / "batch.out" / job["folder"] / "programs/krl"
            self.assertEqual(programs.is_dir(), not broken, job)

    def test_every_failure_has_its_cause(self):
        causes = {job["name"]: job["cause"] for job in self.report["jobs"]}
        for i, (_, _, words) in BROKEN.items():
            self.assertIn(words, causes[f"part{i}"])
            self.assertIn(causes[f"part{i}"].splitlines()[0], self.result.stdout)

    def test_junit_says_the_same(self):
        self.assertEqual([self.suite.get(key) for key in ("tests", "failures", "errors")], [str(JOBS), "0", "5"])
        errors = {case.get("name"): case.find("error").text for case in self.suite if case.find("error") is not None}
        self.assertEqual(errors, {job["name"]: job["cause"] for job in self.report["jobs"] if job["status"] == 2})

    def test_zz_again_only_the_broken_are_tried(self):
        result, report, _ = self.run_batch()
        self.assertEqual(self.read_tables(), self.tables, "the same inputs, the same bytes")
        self.assertEqual(result.returncode, 2)
        self.assertEqual(sum(job["up_to_date"] for job in report["jobs"]), JOBS - 5)
        self.assertEqual([report[key] for key in ("done", "failed")], [JOBS - 5, 5])


class Manifest(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="millpose-batch-test.")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        (self.folder / "batch.yaml").write_text(
            "millpose_batch: 1\njobs:\n"
            f"  - job: {SAMPLE}/job.yaml\n    name: wrong\n    set:\n      toolpath.stepover_mm: -4\n"
            "      toolpath.stepovr_mm: 4\n      process.spindle_rpm: 'fast'\n"
            # A metre too far away: points are skipped.
            f"  - job: {SAMPLE}/job.yaml\n    name: short\n    set: {{toolpath.stepover_mm: 70, toolpath.spacing_mm: 80, programs: [],\n"
            "          workpiece.pose: {xyz_mm: [3076, 0, 1006], abc_deg: [0, -90, 0]}}\n", encoding="utf-8")
        self.result = subprocess.run([MILLPOSE, "batch", "batch.yaml", "-q"], cwd=self.folder, capture_output=True, text=True,
                                     timeout=300, check=False)
        self.jobs = {job["name"]: job for job in
                     json.loads((self.folder / "batch.out/batch.json").read_text(encoding="utf-8"))["jobs"]}
        self.suite = {case.get("name"): case for case in xml.parse(self.folder / "batch.out/junit.xml").getroot()}

    def test_errors_of_set_name_the_manifests_line(self):
        self.assertEqual(self.jobs["wrong"]["status"], 2)
        lines = self.jobs["wrong"]["cause"].splitlines()
        for place, key in (("batch.yaml:6:29", "toolpath.stepover_mm: given -4"), ("batch.yaml:7:28", "toolpath.stepovr_mm: unknown key"),
                           ("batch.yaml:8:28", "process.spindle_rpm: given fast")):
            self.assertTrue(any(line.startswith(f"{place}: set: ") and key in line for line in lines), (place, key, lines))

    def test_findings_are_told_one_by_one(self):
        job = self.jobs["short"]
        self.assertEqual(job["status"], 1, self.result.stdout + self.result.stderr)
        self.assertTrue(job["findings"])
        self.assertRegex(job["findings"][0], r"^\d+ points? skipped, unreachable: first point \d+ \(pass \d+\): ")
        failure = self.suite["short"].find("failure")
        self.assertEqual(failure.text.splitlines(), [job["cause"], *job["findings"]])
        self.assertEqual(failure.get("message"), f"{job['cause']}: {job['findings'][0]}")
        self.assertEqual(self.jobs["wrong"]["findings"], [])
        schema = json.loads((TOP / "docs/schema/batch-result.schema.json").read_text(encoding="utf-8"))
        report = json.loads((self.folder / "batch.out/batch.json").read_text(encoding="utf-8"))
        self.assertEqual(list(json_schema.problems(report, schema)), [])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
