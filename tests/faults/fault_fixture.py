# SPDX-License-Identifier: GPL-3.0-or-later
"""What the tests of faults share. Their arguments: MILLPOSE TOP FAULTS DRIVER"""
import json
import os
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

MILLPOSE, TOP, FAULTS, DRIVER = (Path(word).resolve() for word in sys.argv[1:5])
ALL = os.environ.get("MILLPOSE_FAULT_PLACES") == "all"
CAUSES = {"ENOSPC": "No space left on device", "EACCES": "Permission denied", "EROFS": "Read-only file system"}


def run(command, root, at=0, fault="kill", stays=False, count=None, more=None):
    """The command with a fault at the at-th operation on files below `root`; 0: none, they are only counted. `more`: of the
    environment."""
    env = dict(os.environ, **(more or {}), LD_PRELOAD=str(FAULTS), MILLPOSE_FAULT_ROOT=str(root), MILLPOSE_FAULT_AT=str(at),
               MILLPOSE_FAULT=fault, MILLPOSE_FAULT_STAYS="1" if stays else "",
               MILLPOSE_FAULT_COUNT=str(count) if count else "")
    return subprocess.run([str(word) for word in command], capture_output=True, text=True, timeout=600, env=env)


def results(folder):
    """Bytes of the files of the set that stands in the folder, by name, but for what differs between runs."""
    return {str(path.relative_to(folder)): path.read_bytes() for path in sorted(Path(folder).rglob("*"))
            if path.is_file() and path.name != "run.json"
            and path.relative_to(folder).parts[0] != "checkpoints" and path.relative_to(folder).parts[0][0] != "."}


def is_clean(folder):
    """Whether nothing of a swap, a lock or an unfinished file stands in the folder."""
    return sorted({path.name for path in Path(folder).rglob("*") if path.name[0] == "." or path.suffix == ".tmp"}) == [
        ".lock", ".millpose"]


def programs(files):
    return {name: content for name, content in files.items() if "programs" in name.split("/")[:3]}


def of_one_plan(found, *plans):
    """Whether programs are all of one plan: those of the folder, and those of its operations, whole or absent."""
    groups = [{name: content for name, content in found.items() if name.startswith(top)} for top in ("programs/", "operations/")]
    for plan in plans:
        whole = [{name: content for name, content in plan.items() if name.startswith(top)} for top in ("programs/", "operations/")]
        if all(group in ({}, of_plan) for group, of_plan in zip(groups, whole)):
            return True
    return False


def copied(source, target):
    shutil.rmtree(target, ignore_errors=True)
    shutil.copytree(source, target)
    return target


def places(count, wanted):
    """`wanted` of the numbers 1..count, evenly spread; all in the slow tier."""
    if ALL or wanted >= count:
        return range(1, count + 1)
    return sorted({1 + round(i * (count - 1) / (wanted - 1)) for i in range(wanted)})


class Faults(unittest.TestCase):
    """Goes from set A to set B under faults. Subclasses say how a set is written."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="millpose-faults.")
        self.addCleanup(folder.cleanup)
        self.top = Path(folder.name).resolve()
        self.out, self.a, self.b = self.top / "out", self.top / "a", self.top / "b"

    def prepare(self):
        """Both sets undisturbed, and how many operations lead from A to B."""
        for folder, letter in ((self.a, "A"), (self.b, "B")):
            done = run(self.write(folder, letter), self.top)
            self.assertLess(done.returncode, 2, done.stderr)
        # Written over A, B is the same as alone.
        copied(self.a, self.out)
        done = run(self.write(self.out, "B"), self.out, count=self.top / "count")
        self.assertLess(done.returncode, 2, done.stderr)
        self.old, self.new = results(self.a), results(self.b)
        self.assertNotEqual(programs(self.old), programs(self.new))
        self.assertEqual(results(self.out), self.new)
        return int((self.top / "count").read_text())

    def check_between(self, where):
        """Right after a fault: programs are of one plan or absent, and repairing gives a whole set."""
        found = programs(results(self.out))
        self.assertTrue(of_one_plan(found, programs(self.old), programs(self.new)), where)
        is_open = (self.out / ".journal").exists()
        if is_open:
            self.read_open(where)
            repaired = subprocess.run([DRIVER, self.out, "-"], capture_output=True, text=True, timeout=600)
            self.assertEqual(repaired.returncode, 0, f"{where}: {repaired.stderr}")
        self.assertIn(results(self.out), (self.old, self.new), where)
        return is_open

    def read_open(self, where):
        """What a reader says of a folder whose swap was not ended."""

    def kill_at(self, numbers, again):
        repaired = 0
        for at in numbers:
            with self.subTest(killed_at=at):
                copied(self.a, self.out)
                killed = run(self.write(self.out, "B"), self.out, at)
                self.assertEqual(killed.returncode, -9, killed.stderr)
                repaired += self.check_between(at)
                if again(at):
                    done = run(self.write(self.out, "B"), self.top)
                    self.assertLess(done.returncode, 2, done.stderr)
                    self.assertEqual(results(self.out), self.new)
                    self.assertTrue(is_clean(self.out))
        return repaired

    def fail_at(self, numbers, fault, stays):
        for at in numbers:
            with self.subTest(fault=fault, at=at, stays=stays):
                copied(self.a, self.out)
                failed = run(self.write(self.out, "B"), self.out, at, fault, stays)
                self.check_between((fault, at, stays))
                if failed.returncode < 2:  # what failed was only clearing up
                    self.assertEqual(results(self.out), self.new)
                    continue
                self.assertEqual(failed.returncode, 2, failed.stderr)
                self.assertIn(CAUSES[fault], failed.stderr)
                self.assertIn(str(self.out), failed.stderr)
                # An error leaves the old set; only where not even that can be put back the next start decides.
                if not stays:
                    self.assertEqual(results(self.out), self.old, failed.stderr)
                    self.assertEqual(list(self.out.rglob("*.tmp")), [], failed.stderr)


def main():
    unittest.main(argv=[sys.argv[0], *sys.argv[5:]])
