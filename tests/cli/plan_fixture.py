# SPDX-License-Identifier: GPL-3.0-or-later
"""What the tests of `millpose plan` share: a copy of cells and samples to plan in, runs, comparisons."""
import contextlib
import json
import os
import pathlib
import re
import shutil
import signal
import subprocess
import tempfile
import time

POINT_COLUMNS = (
    "point,pass,piece,kind,status,s_mm,x_mm,y_mm,z_mm,nx,ny,nz,tx,ty,tz,a1_deg,a2_deg,a3_deg,a4_deg,a5_deg,a6_deg,"
    "rotation_deg,branch,lambda_t1_mm_N,lambda_t2_mm_N,lambda_n_mm_N,mu,dexterity,objective,clearance_mm"
).split(",")
# Changes of support_pad's job for Bench.job().
WITHOUT_FORCE = [(r"  # Alloy[^\n]*\n[^\n]*\n  cutting: .*\n", ""), (r"name: surface_error\}.*", "name: chen2021, w1: 0.5, w2: 0.5}")]
CUT_DOWN = [(r"stepover_mm: [\d.]+", "stepover_mm: 27"), (r"spacing_mm: [\d.]+", "spacing_mm: 20")]


class Bench:
    """A folder with cells/ and toolpaths/ as in the clone, removed at the end."""

    def __init__(self, millpose, audit, top):
        self.millpose, self.audit_program = millpose, audit
        self._folder = tempfile.TemporaryDirectory(prefix="millpose-plan-test.")
        self.top = pathlib.Path(self._folder.name)
        for name in ("cells", "toolpaths"):
            shutil.copytree(pathlib.Path(top, name), self.top / name)

    def job(self, name, changes=(), copy=None):
        """The path of a sample's job; with `changes` (regular expression, text) a changed copy beside it."""
        path = self.top / "toolpaths" / name / "job.yaml"
        text = path.read_text(encoding="utf-8")
        for pattern, replacement in changes:
            text, count = re.subn(pattern, replacement, text)
            assert count == 1, f"{pattern} occurs {count} times in {path}"
        if not copy:
            return path
        changed = path.with_name(copy + ".yaml")
        changed.write_text(text, encoding="utf-8")
        return changed

    @staticmethod
    def remove(folder):
        shutil.rmtree(folder)

    def run(self, *arguments, timeout=600):
        return subprocess.run([self.millpose, *map(str, arguments)], capture_output=True, text=True, timeout=timeout)

    def plan(self, job, out, *arguments, timeout=600):
        """Plans into the folder `out` of the bench; returns (finished process, folder)."""
        folder = self.top / out
        return self.run("plan", job, "-v", "-o", folder, *arguments, timeout=timeout), folder

    def audit(self, folder, job, *arguments, timeout=3600):
        """What the independent judge says: (status, its JSON)."""
        result = subprocess.run([self.audit_program, folder, "--inputs", pathlib.Path(job).parent, *arguments],
                                capture_output=True, text=True, timeout=timeout)
        assert result.returncode in (0, 1), result.stderr
        return result.returncode, json.loads(result.stdout)


def contents(folder):
    """Bytes of every file by name, apart from run.json, the only one that may differ between runs."""
    return {
        str(path.relative_to(folder)): path.read_bytes()
        for path in sorted(pathlib.Path(folder).rglob("*"))
        if path.is_file() and path.name != "run.json"
    }


def differences(a, b):
    """Names of the files that are not the same in two contents()."""
    return sorted(name for name in a.keys() | b.keys() if a.get(name) != b.get(name))


@contextlib.contextmanager
def started(*command):
    """A process in a group of its own, which is killed at the end whatever happens."""
    process = subprocess.Popen([str(c) for c in command], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                               start_new_session=True)
    try:
        yield process
    finally:
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGKILL)
        process.communicate()


def kill_after(process, seconds, with_signal):
    """Sends the signal after that time, if the process still runs; returns its status."""
    deadline = time.monotonic() + seconds
    while time.monotonic() < deadline and process.poll() is None:
        time.sleep(0.002)
    if process.poll() is None:
        process.send_signal(with_signal)
    return process.wait(timeout=60)
