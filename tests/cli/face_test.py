#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The real millpose's face: of a folder, with `plan --face`, as measured points. Usage: face_test.py MILLPOSE TOP"""
import json
import re
import sys
import tempfile
import unittest
from pathlib import Path

from cli_fixture import TOP, plan, run

# Few points on a quarter of the pad, but passes that overlap, so that nothing stays between them.
PASSES = ("toolpath.stepover_mm=12", "toolpath.spacing_mm=20", "programs=[]",
          "toolpath.region={facing: {direction: [0, 0, 1], within_deg: 1}, box: {lower_mm: [-40, -40, -1], upper_mm: [0, 0, 1]}}")
FACE = ("--spacing-mm", 2, "--draws", 8, "--lost-motion-arcmin", 0.3)


class Face(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.out, cls.csv = Path(folder.name, "out"), Path(folder.name, "face.csv")
        result = plan(cls.out, "--face", changes=PASSES)
        if result.returncode != 0:
            raise AssertionError(result.stdout + result.stderr)
        cls.told = result.stdout
        cls.face = json.loads(run("face", cls.out, *FACE, "--json", "--csv", cls.csv).stdout)

    def test_csv_is_read_as_measured_points(self):
        measured = json.loads(run("flatness", self.csv, "--json").stdout)
        expected = self.face["plan"]["expected"]
        self.assertEqual(measured["points"], expected["places"])
        self.assertAlmostEqual(1000 * measured["flatness_mm"], expected["flatness_um"], 6)
        self.assertAlmostEqual(1000 * measured["minimum_zone_mm"], expected["minimum_zone_um"], 6)
        self.assertLessEqual(expected["minimum_zone_um"], expected["flatness_um"])
        self.assertGreater(expected["flatness_um"], 0.1)
        result = run("calibrate", self.csv, "--plan", self.out, "--job", TOP / "toolpaths/support_pad/job.yaml", "--json")
        self.assertIn(result.returncode, (0, 1), result.stderr)
        self.assertEqual(json.loads(result.stdout)["readings"], expected["places"])

    def test_sources_and_bounds(self):
        of = self.face["plan"]
        self.assertAlmostEqual(of["without_error"]["flatness_um"], 0, 4)
        self.assertGreater(of["lost_motion"]["flatness_um"], of["force"]["flatness_um"])
        self.assertEqual(self.face["stated"]["force"], {"uncertainty_percent": 30, "direction_deg": 20})
        self.assertEqual(of["drawn"]["draws"], 8)
        self.assertLess(of["drawn"]["flatness_um"][0], of["drawn"]["flatness_um"][1])
        self.assertIn("gear error", self.face["not_in_it"])
        fixed = self.face["fixed_rotation"]
        summary = json.loads((self.out / "summary.json").read_text())
        self.assertEqual(fixed["rotation_deg"], summary["fixed_rotation"]["job"]["rotation_deg"])
        self.assertEqual(fixed["expected"]["places"], of["expected"]["places"])

    def test_same_bytes_for_any_threads(self):
        texts = {run("face", self.out, *FACE, "--json", "--threads", threads).stdout for threads in (1, 2, 3)}
        self.assertEqual(len(texts), 1)
        self.assertEqual(json.loads(texts.pop()), self.face)

    def test_plan_writes_it_too(self):
        summary = json.loads((self.out / "summary.json").read_text())
        again = json.loads(run("face", self.out, "--json").stdout)
        self.assertEqual(summary["face"], again)
        self.assertIn("face of support_pad", self.told)
        self.assertEqual((self.out / "face.csv").read_text().splitlines()[0], "x_mm,y_mm,z_mm,error_um")
        self.assertIn("The face before it is milled", (self.out / "report.html").read_text())

    def test_languages_say_the_same_with_the_same_figures(self):
        def figures(text):
            return sorted(re.findall(r"-?[\d.]*\d", text))
        english = run("face", self.out, *FACE).stdout
        self.assertEqual(run("face", self.out, *FACE, "--lang", "en").stdout, english)
        for language, words in (("de", ("Ebenheit", "nur Umkehrspanne", "nicht darin: Getriebefehler, ")), ("zh", ("平面度", "仅空程", "未计入："))):
            said = run("face", self.out, *FACE, "--lang", language).stdout
            for word in words:
                self.assertIn(word, said)
            self.assertEqual(figures(said), figures(english))
            self.assertEqual(re.findall(r"\b(?:the|of|at|is|not|alone|places|known)\b", said), [], language)
            self.assertEqual(len(said.splitlines()), len(english.splitlines()))
        refused = run("face", self.out, "--lang", "fr")
        self.assertEqual((refused.returncode, refused.stdout), (2, ""))
        self.assertIn("known: en, de, zh", refused.stderr)
        # The report has the text in all of them.
        page = (self.out / "report.html").read_text()
        for word in ("nur Umkehrspanne", "仅空程"):
            self.assertIn(word, page)

    def test_refusals(self):
        for arguments, words in ((("--spacing-mm", 0.01), "allowed: "), (("--rotation-deg", 400), "400")):
            result = run("face", self.out, *arguments)
            self.assertEqual(result.returncode, 2)
            self.assertIn(words, result.stderr)
        trim = run("plan", TOP / "toolpaths/cabin_trim/job.yaml", "--face", "-o", self.out.parent / "trim")
        self.assertEqual(trim.returncode, 2)
        self.assertIn("mills no face", trim.stderr)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
