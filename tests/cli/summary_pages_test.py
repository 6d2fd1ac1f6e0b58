#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The summary that is signed has two pages, whatever the job is: `pdfinfo` counts them. Usage: summary_pages_test.py MILLPOSE TOP
Of two samples; with MILLPOSE_SLOW=1 of every sample as it is. MILLPOSE_PDFS names a folder that keeps the files."""
import os
import pathlib
import re
import shutil
import subprocess
import unittest

from cli_fixture import TOP, InFolder, run

SLOW = os.environ.get("MILLPOSE_SLOW") == "1"
NEEDED = ("weasyprint", "pdfinfo")
SAMPLES = sorted(path.parent.name for path in TOP.glob("toolpaths/*/job.yaml")) if SLOW else ["irb6640_rail", "support_curve"]


def pages_of(pdf):
    """(number of pages, size of the first, points) as pdfinfo has them."""
    told = subprocess.run(["pdfinfo", pdf], capture_output=True, text=True, check=True).stdout
    width, height = map(float, re.search(r"^Page size: +([\d.]+) x ([\d.]+) pts", told, re.M).groups())
    return int(re.search(r"^Pages: +(\d+)$", told, re.M)[1]), (width, height)


class SummaryPages(InFolder):
    def setUp(self):
        super().setUp()
        missing = [name for name in NEEDED if shutil.which(name) is None]
        if missing and not SLOW:
            self.skipTest(f"not installed: {', '.join(missing)}")
        self.assertEqual(missing, [], "install packages-slow.txt")

    def test_every_sample_has_two(self):
        self.assertGreaterEqual(len(SAMPLES), 16 if SLOW else 2)
        kept = os.environ.get("MILLPOSE_PDFS")
        for name in SAMPLES:
            with self.subTest(name):
                job, out = TOP / "toolpaths" / name / "job.yaml", self.folder / name
                planned = run("plan", job, "-o", out, "-q", timeout=3600)
                self.assertIn(planned.returncode, (0, 1), planned.stderr)
                for language in ("en", "de", "zh") if SLOW else ("en",):
                    pdf = pathlib.Path(kept or self.folder) / f"{name}_{language}.pdf"
                    printed = run("report", out, "--job", job, "--summary", "--lang", language, "--pdf", pdf)
                    self.assertEqual(printed.returncode, 0, printed.stderr)
                    pages, (width, height) = pages_of(pdf)
                    self.assertEqual(pages, 2, language)
                    self.assertAlmostEqual(width, 595.3, delta=1)  # A4
                    self.assertAlmostEqual(height, 841.9, delta=1)


if __name__ == "__main__":
    unittest.main(argv=["summary_pages_test.py"])
