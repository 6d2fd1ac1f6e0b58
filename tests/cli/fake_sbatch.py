#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Stands in for sbatch in the quick test: runs the tasks of an array here, one after the other.

What it was given goes into sbatch.log in FAKE_SBATCH_FOLDER; the task FAKE_SBATCH_FAIL dies once without a trace."""
import os
import re
import subprocess
import sys
from pathlib import Path

folder = Path(os.environ["FAKE_SBATCH_FOLDER"])
with open(folder / "sbatch.log", "a", encoding="utf-8") as log:
    log.write(" ".join(sys.argv[1:]) + "\n")
print(len((folder / "sbatch.log").read_text().splitlines()))
array = next(re.fullmatch(r"--array=([\d,]+)", word).group(1) for word in sys.argv if word.startswith("--array"))
for task in array.split(","):
    died = folder / "died"
    if task == os.environ.get("FAKE_SBATCH_FAIL") and not died.exists():
        died.touch()
        continue
    subprocess.run(["sh", sys.argv[-1]], env={**os.environ, "SLURM_ARRAY_TASK_ID": task}, check=False)
