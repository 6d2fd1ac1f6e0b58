#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Folders of strangers: whatever stands under the names that millpose itself uses, nothing outside is touched, nothing hangs and
every command ends with a plain status. A sample of the matrix name x kind x command; all of it with MILLPOSE_SLOW=1.
Usage: hostile_test.py MILLPOSE TOP"""
import json
import os
import re
import shutil
import socket
import stat
import subprocess
import tempfile
import unittest
from pathlib import Path

from cli_fixture import FEW, JOB, MILLPOSE, TOP

SLOW = os.environ.get("MILLPOSE_SLOW") == "1"
SECRET = "not-for-strangers-4711"
NOBODY = 65534

# Every name in an output folder that millpose writes, reads or removes, of plans, places and batches.
NAMES = (".millpose", ".lock", ".journal", ".staging", ".staging/manifest.json", ".replaced", ".owner.host.1.1", ".job.yaml.host.1.1.0.tmp",
         "manifest.json", "run.json", "plan.cbor.gz", "job.yaml", "summary.json", "points.csv", "deflection.csv", "report.html", "path.vtp",
         "checkpoints", "checkpoints/programs.stage", "programs", "programs/krl", "programs/krl/support_pad.src", "operations",
         "operations/01_a", "plans", "plans/00_job", "plans/07", "placement.json", "placement.html", "places.csv", "map.csv", "map.vtk",
         "batch.json", "batch.csv", "index.html", "junit.xml", "slurm", "slurm/jobs", "slurm/jobs/submitted", "support_pad")


def link_to(target):
    return lambda path, outside: path.symlink_to(target(outside))


def a_folder(path, outside):
    path.mkdir()
    (path / "foreign.txt").write_text("kept\n")


def a_socket(path, outside):
    here = os.getcwd()
    os.chdir(path.parent)  # a socket's path has 108 bytes
    try:
        with socket.socket(socket.AF_UNIX) as own:
            own.bind(path.name)
    finally:
        os.chdir(here)


KINDS = {"link to a file": link_to(lambda outside: outside / "victim.txt"), "link to a folder": link_to(lambda outside: outside / "folder"),
         "link to nothing": link_to(lambda outside: outside / "new"), "link out by ..": link_to(lambda outside: "../../outside/folder"),
         "link to itself": lambda path, outside: path.symlink_to(path.name), "link to a device": link_to(lambda outside: "/dev/zero"),
         "pipe": lambda path, outside: os.mkfifo(path), "link to a pipe": link_to(lambda outside: outside / "pipe"), "socket": a_socket,
         "folder": a_folder, "empty file": lambda path, outside: path.write_bytes(b""),
         "garbage": lambda path, outside: path.write_bytes(bytes(range(256)) * 40)}

OUT_BY_NAMES = ("../../outside/victim.txt", "../outside", "/etc/hostname", "..", ".", "", "programs/../../../outside/victim.txt", "x/../..", "\x00", "a\nb")
JOURNALS = [json.dumps({"new": new, "old": old}) for name in OUT_BY_NAMES for new, old in (([], [name]), ([name], []), ([name], [name]))] + [
    "", "{", "null", "[]", '{"new": 1, "old": {}}', '{"new": [1], "old": [null]}', "[" * 100000, '{"new": ["' + "x" * 100000 + '"], "old": []}']
MANIFESTS = [json.dumps({"schema_version": 1, "key": "k", "files": [{"path": name, "bytes": 7, "hash": "0" * 32}]}) for name in OUT_BY_NAMES] + [
    "", "{", "null", "[" * 100000, '{"schema_version": 1, "key": 3, "files": {}}']


def snapshot(folder):
    """Names, kinds, modes, times and bytes of all that a folder holds."""
    found = {}
    for path in sorted([folder, *folder.rglob("*")]):
        info = path.lstat()
        content = os.readlink(path) if path.is_symlink() else path.read_bytes() if stat.S_ISREG(info.st_mode) else None
        found[str(path)] = (info.st_mode, info.st_uid, info.st_ino, info.st_mtime_ns, content)
    return found


def remove(path):
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path)
    else:
        path.unlink(missing_ok=True)


class Hostile(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.kept = tempfile.TemporaryDirectory(prefix="millpose-hostile.")
        cls.addClassCleanup(cls.kept.cleanup)
        cls.top = Path(cls.kept.name).resolve()
        cls.theirs, cls.outside, cls.good = cls.top / "theirs", cls.top / "outside", cls.top / "good"
        cls.theirs.mkdir()
        shutil.copy(JOB.parent / "support_pad.stl", cls.theirs)
        shutil.copy(TOP / "cells/kr500_r2830.yaml", cls.theirs / "cell.yaml")
        text = re.sub(r"(stepover|spacing)_mm: [\d.]+", r"\1_mm: 60", JOB.read_text().replace("../../cells/kr500_r2830.yaml", "cell.yaml"))
        text = text.replace("programs: [krl, sinumerik, linuxcnc]", "programs: [krl]")
        (cls.theirs / "job.yaml").write_text(text + "placement:\n  x_mm: {from: 1990, to: 2000}\n  points: 1\n  places: 2\n  plans: 1\n  map_points: 2\n")
        (cls.top / "measured.csv").write_text("x_mm,y_mm,z_mm,error_um\n0,0,0,1\n1,1,0,2\n")
        cls.outside.mkdir()
        (cls.outside / "victim.txt").write_text(SECRET + "\n")
        (cls.outside / "folder").mkdir()
        (cls.outside / "folder" / "foreign.txt").write_text(SECRET + "\n")
        for name in ("manifest.json", "0.err", "submitted"):
            (cls.outside / "folder" / name).write_text(SECRET + "\n")
        os.mkfifo(cls.outside / "pipe")
        done = subprocess.run([MILLPOSE, "plan", cls.theirs / "job.yaml", "-o", cls.good, "--threads", "1", "-q"], capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        cls.before = snapshot(cls.outside)

    # What a command is called with, and the folder that it finds.
    def commands(self):
        theirs, job, root = self.theirs, self.theirs / "job.yaml", ("--root", self.theirs)
        out = theirs / "support_pad.out"
        return {"plan --root": (out, ("plan", job, *root)), "plan": (out, ("plan", job)), "plan --fresh": (out, ("plan", job, "--fresh", *root)),
                "verify": (out, ("verify", out, *root)), "batch": (out, ("batch", job, "-o", out, *root)),
                "place": (theirs / "support_pad.places", ("place", job, *root)), "inspect": (out, ("inspect", out)),
                "clean": (out, ("clean", out)), "export": (out, ("export", out, "--ros", self.theirs / "ros", *root)), "diff": (out, ("diff", out, self.good)),
                "calibrate": (out, ("calibrate", self.top / "measured.csv", "--plan", out, "--job", job)), "check": (out, ("check", out / "job.yaml", *root)),
                "check --view": (out, ("check", job, "--view", out / "report.html", *root))}

    def run_on(self, command, plant, more=None):
        """Runs the command on a good folder in which `plant` has been."""
        out, words = self.commands()[command]
        for path in list(self.theirs.iterdir()):
            if path.name not in ("job.yaml", "cell.yaml", "support_pad.stl"):
                remove(path)
        shutil.copytree(self.good, out)
        plant(out)
        job = (self.theirs / "job.yaml").read_bytes()
        done = subprocess.run([MILLPOSE, *map(str, words), "-q"], capture_output=True, text=True, errors="replace", timeout=60, **(more or {}))
        self.assertIn(done.returncode, (0, 1, 2), done.stderr)
        self.assertEqual(snapshot(self.outside), self.before, done.stderr)
        self.assertEqual((self.theirs / "job.yaml").read_bytes(), job)
        self.assertEqual(sorted(path.name for path in self.top.iterdir()), ["good", "measured.csv", "outside", "theirs"])
        self.assertNotIn(SECRET, done.stdout + done.stderr)
        if "--root" in words:
            for path in self.theirs.rglob("*"):
                if path.is_file() and not path.is_symlink() and path.name != "0.err":
                    self.assertNotIn(SECRET.encode(), path.read_bytes(), path)
        return done

    def plant(self, name, kind):
        def put(out):
            path = out / name
            for parent in reversed(path.relative_to(out).parents[:-1]):
                (out / parent).mkdir(exist_ok=True)
            remove(path)
            KINDS[kind](path, self.outside)
        return put

    def matrix(self, rows, every):
        """(row, command): all of them, or of every so many rows one with the commands in turn."""
        commands = list(self.commands())
        for i, row in enumerate(rows):
            if SLOW:
                yield from ((row, command) for command in commands)
            elif i % every == 0:
                yield row, commands[i // every % len(commands)]

    def test_whatever_stands_under_the_names_that_millpose_uses(self):
        kinds = list(KINDS)
        if SLOW:
            rows = [[(name, kind)] for name in NAMES for kind in kinds]
        else:  # three of them at once
            rows = [[(name, kinds[(5 * i + k) % len(kinds)]) for k, name in enumerate(NAMES[i::13])] for i in range(13)]
        for row, command in self.matrix(rows, 1):
            with self.subTest(row=row, command=command):
                def plant(out):
                    for name, kind in row:
                        if not (out / name).parent.is_symlink():
                            self.plant(name, kind)(out)
                self.run_on(command, plant)

    def test_every_journal(self):
        for text, command in self.matrix(JOURNALS, 9):
            with self.subTest(journal=text[:60], command=command):
                def plant(out):
                    (out / ".journal").write_text(text)
                    for name in (".staging", ".replaced"):
                        (out / name).mkdir()
                        (out / name / "victim.txt").write_text("other\n")
                    for folder in (out / "outside", self.theirs / "outside"):  # where names with ".." would be moved to
                        folder.mkdir()
                done = self.run_on(command, plant)
                if command.startswith("plan"):
                    self.assertEqual(done.returncode, 0, done.stderr)

    def test_every_manifest(self):
        for text, command in self.matrix(MANIFESTS, 5):
            with self.subTest(manifest=text[:90], command=command):
                done = self.run_on(command, lambda out: (out / "manifest.json").write_text(text))
                if command.startswith("plan"):
                    self.assertEqual(done.returncode, 0, done.stderr)

    def test_what_stands_in_the_place_of_the_job_that_place_writes(self):
        names = ("job.placed.yaml", "job.placed.1.yaml", "job.placed.2.yaml")
        for kind in KINDS:
            if SLOW or kind == "pipe":
                with self.subTest(kind=kind):
                    def plant(out):
                        for name, other in zip(names, (kind, "link to a file", "link to nothing")):
                            KINDS[other](self.theirs / name, self.outside)
                    self.assertEqual(self.run_on("place", plant).returncode, 0)

    @unittest.skipUnless(os.geteuid() == 0, "only root can leave files to others")
    def test_odd_owners_and_modes(self):
        if subprocess.run([MILLPOSE, "--version"], user=NOBODY, capture_output=True).returncode != 0:
            self.skipTest("the program is not for everybody here")
        for path in (self.top, self.theirs, self.outside):
            path.chmod(0o777)
        self.addCleanup(self.top.chmod, 0o700)
        type(self).before = snapshot(self.outside)
        names = (".", "checkpoints", "programs", ".lock", "manifest.json", "plan.cbor.gz", ".millpose", "run.json", "programs/krl")
        for (name, mode), command in self.matrix([(name, mode) for name in names for mode in (0, 0o444, 0o555, 0o1777)], 11):
            with self.subTest(name=name, mode=oct(mode), command=command):
                def plant(out):
                    for path in [out, *out.rglob("*")]:
                        os.chown(path, NOBODY, NOBODY)
                    os.chown(out / name, 0, 0)
                    (out / name).chmod(mode)
                self.run_on(command, plant, {"user": NOBODY, "group": NOBODY, "extra_groups": []})


if __name__ == "__main__":
    unittest.main(argv=["hostile_test"])
