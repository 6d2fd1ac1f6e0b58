# SPDX-License-Identifier: GPL-3.0-or-later
"""usage: ci_example_test.py MILLPOSE TOP: runs the steps of the example workflow in a repository of two small parts."""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import textwrap
import unittest

MILLPOSE, TOP = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
EXAMPLE = TOP / "docs/examples/ci"


def step(name):
    """The script of a step of the workflow."""
    text = (EXAMPLE / "plan-parts.yml").read_text(encoding="utf-8")
    found = re.search(rf"- name: {name}\n(?: +if: .*\n)? +run: \|\n((?: {{10}}.*\n)+)", text)
    assert found, f"the workflow has no step {name}"
    return textwrap.dedent(found.group(1))


class Workflow(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="millpose-ci-test.")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        (self.folder / "agreed").mkdir()
        (self.folder / "bin").mkdir()
        (self.folder / "bin/millpose").symlink_to(MILLPOSE)
        shutil.copytree(TOP / "cells", self.folder / "cells")
        for name in ("left", "right"):
            shutil.copytree(TOP / "toolpaths/support_pad", self.folder / "parts" / name)
            job = self.folder / "parts" / name / "job.yaml"
            text = job.read_text(encoding="utf-8").replace("name: support_pad", f"name: {name}")
            job.write_text(text.replace("spacing_mm: 4", "spacing_mm: 40").replace("stepover_mm: 8", "stepover_mm: 40"),
                           encoding="utf-8")

    def run_step(self, name):
        environment = {**os.environ, "PATH": f"{self.folder}/bin:{os.environ['PATH']}"}
        return subprocess.run(["sh", "-e", "-c", step(name)], cwd=self.folder, env=environment, text=True,
                              capture_output=True, timeout=300, check=False)

    def change(self, file, pattern, replacement):
        path = self.folder / file
        text, count = re.subn(pattern, replacement, path.read_text(encoding="utf-8"))
        self.assertEqual(count, 1, pattern)
        path.write_text(text, encoding="utf-8")

    def test_agreed_plans_pass_and_whatever_changes_fails(self):
        planned = self.run_step("plan")
        self.assertEqual(planned.returncode, 0, planned.stderr)
        for name in ("left", "right"):
            shutil.copytree(self.folder / "out" / name, self.folder / "agreed" / name)
            subprocess.run([MILLPOSE, "clean", self.folder / "agreed" / name], check=True, capture_output=True)
        compared = self.run_step("compare")
        self.assertEqual(compared.returncode, 0, compared.stdout + compared.stderr)
        job, cell = "parts/left/job.yaml", "cells/kr500_r2830.yaml"
        before = {file: (self.folder / file).read_bytes() for file in (job, cell)}
        for file, pattern, replacement, parts in (
                (cell, r"(joint_stiffness\w*: \[)[\d.e+]+", r"\g<1>7.1e6", ("left", "right")),
                (job, r"( feed_mm_min: )\d+", r"\g<1>60", ("left",)),
                (job, r"(retract_mm: )50", r"\g<1>5", ("left",))):
            with self.subTest(changed=pattern):
                self.change(file, pattern, replacement)
                self.assertEqual(self.run_step("plan").returncode, 0)
                changed = self.run_step("compare")
                self.assertEqual(changed.returncode, 1, changed.stdout)
                told = dict(zip(("left", "right"), changed.stdout.split("== ")[1:]))
                for name in ("left", "right"):  # the first difference does not hide the second part
                    self.assertEqual("settings" in told[name] and "no difference" not in told[name], name in parts, changed.stdout)
                (self.folder / file).write_bytes(before[file])

    def test_a_part_that_cannot_be_planned_fails(self):
        job = self.folder / "parts/left/job.yaml"
        job.write_text(job.read_text(encoding="utf-8").replace("unit: mm", "unit: furlong"), encoding="utf-8")
        self.assertEqual(self.run_step("plan").returncode, 2)
        self.assertTrue((self.folder / "out/right/summary.json").is_file())


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
