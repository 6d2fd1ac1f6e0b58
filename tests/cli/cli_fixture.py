# SPDX-License-Identifier: GPL-3.0-or-later
"""What the tests of the command line share. Their arguments: MILLPOSE TOP"""
import json
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import json_schema

MILLPOSE, TOP = Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve()
JOB = TOP / "toolpaths" / "support_pad" / "job.yaml"
# A few points of the sample: enough to go the whole way.
FEW = ("toolpath.stepover_mm=40", "toolpath.spacing_mm=40")


def without_force():
    """The sample's job without a cutting force, which CAM paths would need their stock for."""
    lines = JOB.read_text().replace("../../cells", str(TOP / "cells")).splitlines(keepends=True)
    return "".join(line for line in lines if "cutting:" not in line and "objective:" not in line)


def run(*arguments, cwd=None, env=None, timeout=300):
    return subprocess.run([MILLPOSE, *map(str, arguments)], capture_output=True, text=True, timeout=timeout, cwd=cwd,
                          env=env)


def plan(folder, *arguments, changes=FEW):
    sets = [word for change in changes for word in ("--set", change)]
    return run("plan", JOB, "-o", folder, "-v", *sets, *arguments)


def tree(folder):
    """All results of a plan but what may differ between runs."""
    return {str(path.relative_to(folder)): path.read_bytes() for path in sorted(Path(folder).rglob("*"))
            if path.is_file() and path.name != "run.json" and "checkpoints" not in path.parts}


def schema_problems(name, value):
    schema = json.loads((TOP / "docs" / "schema" / f"{name}.schema.json").read_text())
    return list(json_schema.problems(value, schema))


class InFolder(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
