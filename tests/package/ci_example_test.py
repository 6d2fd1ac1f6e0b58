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
        (self.folder / "tools").mkdir()
        shutil.copy(EXAMPLE / "compare_stiffness.py", self.folder / "tools")
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

    def test_agreed_plans_pass_and_changed_stiffness_fails(self):
        planned = self.run_step("plan")
        self.assertEqual(planned.returncode, 0, planned.stderr)
        for name in ("left", "right"):
            shutil.copy(self.folder / f"out/{name}/summary.json", self.folder / f"parts/{name}/expected_summary.json")
        compared = self.run_step("compare")
        self.assertEqual(compared.returncode, 0, compared.stdout + compared.stderr)

        cell = self.folder / "cells/kr500_r2830.yaml"
        text = cell.read_text(encoding="utf-8")
        softer, count = re.subn(r"(joint_stiffness\w*: \[)([\d.e+]+)", lambda found: f"{found[1]}{0.8 * float(found[2])}", text)
        self.assertEqual(count, 1)
        cell.write_text(softer, encoding="utf-8")
        self.assertEqual(self.run_step("plan").returncode, 0)
        changed = self.run_step("compare")
        self.assertEqual(changed.returncode, 1, changed.stdout)
        self.assertIn("== right", changed.stdout, "the first difference does not hide the second part")

    def test_a_part_that_cannot_be_planned_fails(self):
        job = self.folder / "parts/left/job.yaml"
        job.write_text(job.read_text(encoding="utf-8").replace("unit: mm", "unit: furlong"), encoding="utf-8")
        self.assertEqual(self.run_step("plan").returncode, 2)
        self.assertTrue((self.folder / "out/right/summary.json").is_file())


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
