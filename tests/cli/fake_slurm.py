#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Stands in for sbatch and squeue in the quick test. As sbatch it runs the tasks of an array here, one after the other.

What sbatch was given goes into sbatch.log in FAKE_SLURM_FOLDER; the task FAKE_SLURM_FAIL dies once without a trace. As
squeue it lists what stands in the file `queue` there, whose first line it removes at every call."""
import os
import re
import subprocess
import sys
from pathlib import Path

folder = Path(os.environ["FAKE_SLURM_FOLDER"])
if Path(sys.argv[0]).name == "squeue":
    queue = folder / "queue"
    if queue.exists():
        first, _, rest = queue.read_text(encoding="utf-8").partition("\n")
        print(first, end="")
        queue.write_text(rest, encoding="utf-8")
    sys.exit(0)

with open(folder / "sbatch.log", "a", encoding="utf-8") as log:
    log.write(" ".join(sys.argv[1:]) + "\n")
array = next(re.fullmatch(r"--array=([\d,]+)", word).group(1) for word in sys.argv if word.startswith("--array"))
for task in array.split(","):
    died = folder / "died"
    if task == os.environ.get("FAKE_SLURM_FAIL") and not died.exists():
        died.touch()
        continue
    subprocess.run(["sh", *sys.argv[-2:]], env={**os.environ, "SLURM_ARRAY_TASK_ID": task}, check=False)
print(len((folder / "sbatch.log").read_text(encoding="utf-8").splitlines()))
