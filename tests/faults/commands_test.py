#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Every command of the program's own table at failing file operations: killed, no space, no permission, a broken disk. A command
without a row here fails the test. A few places of each; with MILLPOSE_FAULT_PLACES=all every place is killed at and fails in one of
the ways, in turn.
Usage: commands_test.py MILLPOSE TOP FAULTS DRIVER"""
import csv
import errno
import importlib.util
import json
import os
import re
import shutil
import subprocess
import tempfile
import time
import unittest
from pathlib import Path

from fault_fixture import ALL, MILLPOSE, TOP, main, places, run

FAULTS = ("kill", "ENOSPC", "EACCES", "EIO")
FEW = (("stepover_mm: 8", "stepover_mm: 60"), ("spacing_mm: 4", "spacing_mm: 60"), ("programs: [krl, sinumerik, linuxcnc]", "programs: [krl]"))
OWN_HIDDEN = {".millpose", ".lock"}  # what an output folder always holds

spec = importlib.util.spec_from_file_location("make_meshes", TOP / "toolpaths" / "make_meshes.py")
make_meshes = importlib.util.module_from_spec(spec)
spec.loader.exec_module(make_meshes)


def changed(text, *changes):
    for old, new in changes:
        assert old in text, old
        text = text.replace(old, new)
    return text


def masked(name, content):
    """A report of a batch tells times and what was up to date, which differ from run to run: of it counts which jobs it is of."""
    if name == "out/manifest.json":
        return b""
    if name.split("/")[-1] in ("batch.json", "batch.csv", "index.html", "junit.xml"):
        return b"second" if b"second" in content else b"first"
    return content


class Row:
    """A command that writes: how its folder is prepared, what turns the old results into the new ones, which files of them
    belong together."""
    quick = 4  # places
    adds = False  # only what later runs use: results stay

    def __init__(self, top):
        self.top = top
        self.text = changed((TOP / "toolpaths/support_pad/job.yaml").read_text(), *FEW, ("../../cells", str(TOP / "cells")),
                            ("mesh: support_pad", f"mesh: {TOP}/toolpaths/support_pad/support_pad"))
        top.mkdir()
        self.prepare()

    def prepare(self):
        """Leaves old results, and what the command reads."""

    def command(self):
        raise NotImplementedError

    def environment(self):
        return {}

    @staticmethod
    def part(name):
        """What a file is to be old or new together with."""
        return name

    def is_open(self, part):
        """Whether a swap was begun there and not ended: until the next run it is neither."""
        return any((folder / ".journal").exists() for folder in (self.top / part, self.top / part.split("/")[0]))

    def millpose(self, *words):
        done = subprocess.run([MILLPOSE, *map(str, words), "-q"], capture_output=True, text=True, timeout=600,
                              env={**os.environ, **self.environment()})
        assert done.returncode < 2, done.stderr
        return done

    def results(self):
        """The files that count, by name, in the parts that stand or fall together."""
        found = {}
        for path in sorted(self.top.rglob("*")):
            name = str(path.relative_to(self.top))
            if path.is_file() and path.name != "run.json" and path.suffix != ".tmp" and not any(
                    word[0] == "." or word in ("checkpoints", "slurm") for word in name.split("/")):
                found.setdefault(self.part(name), {})[name] = masked(name, path.read_bytes())
        return found

    def litter(self):
        return [str(path.relative_to(self.top)) for path in self.top.rglob("*")
                if (path.name[0] == "." and path.name not in OWN_HIDDEN) or path.suffix == ".tmp"]

    def half_done(self, part):
        """Whether a part may stand as it does after a kill, until the next run."""
        return False

    def is_done(self, again):
        """Whether the same command again ended as it should."""
        return again.returncode < 2


def of_folder(name):
    return name.split("/")[0]


class Plan(Row):
    quick = 4
    part = staticmethod(of_folder)

    def prepare(self):
        self.job = self.top / "job.yaml"
        self.job.write_text(self.text)
        self.millpose(*self.command()[1:-2])

    def command(self):
        return MILLPOSE, "plan", self.job, "--threads", 1, "-o", self.top / "out", "--set", "process.spindle_rpm=6000"


class PlanOfOperations(Plan):
    quick = 3
    OPERATIONS = "operations:\n  - {{name: a}}\n  - {{name: b, process: {{spindle_rpm: {}}}}}\n"

    def prepare(self):
        self.job = self.top / "job.yaml"
        head, rest = self.text.split("toolpath:", 1)
        toolpath = re.search(r"(?:\n  .*)+", rest).group(0)
        indented = toolpath.replace("\n", "\n    ")
        rest = rest[len(toolpath):]
        self.job.write_text(head + "operations:\n" + "".join(
            f"  - name: {name}\n    toolpath:{indented}\n" for name in ("a", "b")) + rest.lstrip("\n"))
        self.millpose(*self.command()[1:-2])


class Share(Row):
    quick = 3
    adds = True

    def prepare(self):
        self.job = self.top / "job.yaml"
        self.job.write_text(self.text)

    def command(self):
        return MILLPOSE, "plan", self.job, "--threads", 1, "-o", self.top / "out", "--share", "1/1"


class Batch(Row):
    quick = 3

    def prepare(self):
        (self.top / "job.yaml").write_text(self.text)
        self.manifest(7000)
        self.millpose(*self.command()[1:])
        self.manifest(6000, "  - {job: job.yaml, name: second}\n")

    def manifest(self, rpm, more=""):
        (self.top / "batch.yaml").write_text(
            f"millpose_batch: 1\njobs:\n  - {{job: job.yaml, name: first, set: {{process.spindle_rpm: {rpm}}}}}\n{more}")

    def command(self):
        return MILLPOSE, "batch", self.top / "batch.yaml", "--threads", 1, "--parallel", 1, "-o", self.top / "out"

    @staticmethod
    def part(name):
        return "/".join(name.split("/")[:2]) if name.count("/") > 1 else "reports" if name.startswith("out/") else name

    def is_open(self, part):
        return super().is_open("out" if part == "reports" else part)


class BatchOnSlurm(Batch):
    """Submitted and not waited for: what is written is what the tasks are to read."""
    quick = 3
    adds = True

    def environment(self):
        fakes = self.top.with_name("fakes")
        fakes.mkdir(exist_ok=True)
        for name, answer in (("sbatch", "echo 17"), ("squeue", "true")):
            (fakes / name).write_text(f"#!/bin/sh\n{answer}\n")
            (fakes / name).chmod(0o755)
        return {"PATH": f"{fakes}:{os.environ['PATH']}"}

    def command(self):
        return MILLPOSE, "batch", self.top / "batch.yaml", "--threads", 1, "--slurm", "--detach", "-o", self.top / "out"


class Place(Row):
    quick = 3
    RANGES = ("placement:\n  x_mm: {from: 1900, to: %d}\n  z_mm: {from: 800, to: 1300}\n"
              "  points: 2\n  places: 6\n  plans: 1\n  map_points: 2\n")

    def prepare(self):
        self.job = self.top / "job.yaml"
        self.job.write_text(self.text + self.RANGES % 2000)
        self.millpose(*self.command()[1:])
        self.job.write_text(self.text + self.RANGES % 2300)

    def command(self):
        return MILLPOSE, "place", self.job, "--threads", 1, "-o", self.top / "out"

    @staticmethod
    def part(name):
        return "/".join(name.split("/")[:3]) if name.startswith("out/plans/") else of_folder(name)


class Init(Row):
    quick = 2

    def prepare(self):
        block = self.top / "block.stl"
        block.write_bytes(make_meshes.stl("block", make_meshes.support_pad()))

    def command(self):
        return MILLPOSE, "init", self.top / "block.stl", "--arm", "kr500_r2830", "--threads", 1, "-o", self.top / "deep" / "block"

    def half_done(self, part):
        return part == "deep/block/cell.yaml"  # the job is next; without it init takes the cell back and goes on

    def is_done(self, again):
        return again.returncode == 0 or "exists already" in again.stderr  # where it was killed as it tidied up


class Identify(Row):
    quick = 10

    def prepare(self):
        self.cell, measured = self.top / "cell.yaml", self.top / "m.yaml"
        shutil.copy(TOP / "cells" / "quantec_r2700.yaml", self.cell)
        text = "millpose_measurements: 1\nload_point_mm: [0, 0, 0]\nmeasured_point_mm: [0, 0, 0]\nmeasurements:\n"
        for joints in ((0, -68.8, 85.8, -34.3, -106.9, 61.2), (-12, -70, 90, -35, 103, 67), (29, -99, 130, -17, -61, 29)):
            pose = json.loads(self.millpose("stiffness", self.cell, "--joints-deg", *joints, "--normal", 1, 0, 0, "--at", "flange", "--json").stdout)
            for force in ((0, 0, -737.8), (737.8, 0, 0)):
                moved = [0.9 * sum(pose["C"][i][j] * force[j] for j in range(3)) for i in range(3)]
                text += f"  - {{joints_deg: {list(joints)}, force_N: {list(force)}, displacement_mm: [{', '.join('%.9f' % x for x in moved)}]}}\n"
        measured.write_text(text)

    def command(self):
        return MILLPOSE, "identify", self.top / "m.yaml", "--cell", self.cell, "--write-cell", self.cell


class Calibrate(Row):
    quick = 6
    part = staticmethod(of_folder)

    def prepare(self):
        self.job = self.top / "job.yaml"
        self.job.write_text(changed(self.text, ("stepover_mm: 60", "stepover_mm: 16"), ("spacing_mm: 60", "spacing_mm: 16")))
        self.millpose("plan", self.job, "-o", self.top / "out", "--threads", 1)
        X_WP = json.loads((self.top / "out" / "summary.json").read_text())["cell"]["X_WP"]
        read = lambda name: list(csv.DictReader((self.top / "out" / name).read_text().splitlines()))
        points = read("points.csv")
        lines = ["x_mm,y_mm,z_mm,error_um"]
        for i, row in enumerate(row for row in read("deflection.csv") if row["side"] != "air"):
            away = [float(points[int(row["point"])][f"{c}_mm"]) - X_WP[k][3] for k, c in enumerate("xyz")]
            place = [sum(X_WP[k][j] * away[k] for k in range(3)) for j in range(3)]
            lines.append(",".join(f"{v:.6f}" for v in [*place, 12 + 1.3 * float(row["normal_um"]) + 1e-3 * (i % 3)]))
        (self.top / "measured.csv").write_text("\n".join(lines) + "\n")

    def command(self):
        return MILLPOSE, "calibrate", self.top / "measured.csv", "--plan", self.top / "out", "--job", self.job, "--write-job", self.job


class Face(Row):
    quick = 4
    part = staticmethod(of_folder)

    def prepare(self):
        self.job = self.top / "job.yaml"
        self.job.write_text(self.text)
        self.millpose("plan", self.job, "-o", self.top / "out", "--threads", 1)
        (self.top / "face.csv").write_text("an older face")

    def command(self):
        return (MILLPOSE, "face", self.top / "out", "--job", self.job, "--threads", 1, "--draws", 0, "--spacing-mm", 4,
                "--csv", self.top / "face.csv")


class Report(Row):
    quick = 4
    part = staticmethod(of_folder)

    def prepare(self):
        self.job = self.top / "job.yaml"
        self.job.write_text(self.text)
        self.millpose("plan", self.job, "-o", self.top / "out", "--threads", 1)
        (self.top / "sheet.html").write_text("an older sheet")

    def command(self):
        return MILLPOSE, "report", self.top / "out", "--job", self.job, "--html", self.top / "sheet.html"


class Export(Row):
    quick = 5
    part = staticmethod(of_folder)

    def prepare(self):
        self.job = self.top / "job.yaml"
        self.job.write_text(self.text)
        self.millpose("plan", self.job, "-o", self.top / "out", "--threads", 1)
        self.millpose("export", self.top / "out", "--ros", self.top / "ros", "--package", "before")

    def command(self):
        return MILLPOSE, "export", self.top / "out", "--ros", self.top / "ros"


class Check(Row):
    quick = 5

    def prepare(self):
        (self.top / "job.yaml").write_text(self.text)
        (self.top / "page.html").write_text("an older page")

    def command(self):
        return MILLPOSE, "check", self.top / "job.yaml", "--threads", 1, "--view", self.top / "page.html"


class Map(Row):
    quick = 8

    def prepare(self):
        (self.top / "map.csv").write_text("an older map")

    def command(self):
        return (MILLPOSE, "stiffness", TOP / "cells/kr500_r2830.yaml", "--map", "dexterity", "--plane", 1500, -500, 800, 2200, -500, 800,
                1500, 500, 800, "--steps", 2, 2, "--tool-axis", -1, 0, 0, "-o", self.top / "map")


class Register(Row):
    quick = 4

    def prepare(self):
        self.job = self.top / "job.yaml"
        self.job.write_text(self.text)
        # Balls of 3 mm radius on five faces of the block, which stands 0.5 mm higher than the job says.
        rows = ["x_mm,y_mm,z_mm"]
        for along in (-25, 0, 25):
            low = -18 + 0.3 * abs(along)  # no three of a face in a line
            for x, y, z in ((along, low, 3), (43, along, low), (-43, along, low), (along, 43, low), (along, -43, low)):
                rows.append(f"{2076 - z},{y},{1006 + x + 0.5}")
        (self.top / "points.csv").write_text("\n".join(rows) + "\n")

    def command(self):
        return (MILLPOSE, "register", self.job, "--probe", self.top / "points.csv", "--sd-mm", 0.02, "--tool-radius-mm", 3,
                "--propose", 0, "--threads", 1, "--write-job", self.job)


class Clean(Row):
    adds = True
    quick = 3

    def prepare(self):
        (self.top / "job.yaml").write_text(self.text)
        self.millpose("plan", self.top / "job.yaml", "-o", self.top / "out", "--threads", 1)

    def command(self):
        return MILLPOSE, "clean", self.top / "out"


class Reads(Row):
    """A command that writes no file: not one operation is counted."""

    def prepare(self):
        (self.top / "job.yaml").write_text(self.text)
        self.millpose("plan", self.top / "job.yaml", "-o", self.top / "out", "--threads", 1)


def reading(*words):
    return type("Reads" + words[0].title(), (Reads,), {"command": lambda self: (MILLPOSE, *(str(self.top / word[1:]) if word[0] == "@" else word for word in words))})


def without_folder(*words):
    return type("Prints" + words[0].title(), (Row,), {"command": lambda self: (MILLPOSE, *words)})


class Flatness(Row):
    def prepare(self):
        (self.top / "points.csv").write_text("x_mm,y_mm,z_mm\n0,0,0\n1,0,0\n0,1,0\n1,1,0.01\n")

    def command(self):
        return MILLPOSE, "flatness", self.top / "points.csv"


# What every command of the program's table writes with; what it only reads with, where it writes nothing.
WRITERS = {"plan": (Plan, PlanOfOperations, Share), "batch": (Batch, BatchOnSlurm), "place": (Place,), "init": (Init,),
           "identify": (Identify,), "calibrate": (Calibrate,), "register": (Register,), "clean": (Clean,), "face": (Face,), "report": (Report,), "export": (Export,),
           "check": (Check,), "stiffness": (Map,)}
READERS = {"verify": reading("verify", "@out"), "inspect": reading("inspect", "@out"), "diff": reading("diff", "@out", "@out"), "flatness": Flatness,
           "schema": without_folder("schema", "job"), "cells": without_folder("cells"), "man": without_folder("man"), "completion": without_folder("completion")}


def commands():
    """The program's own table."""
    text = subprocess.run([MILLPOSE, "completion"], capture_output=True, text=True, check=True).stdout
    return re.search(r'"\) flags="[^"]*" words="([^"]*) help"', text.replace('""', '"')).group(1).split()


class Commands(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="millpose-commands.")
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name).resolve()

    def test_every_command_has_a_row(self):
        self.assertEqual(sorted(commands()), sorted([*WRITERS, *READERS]))

    def test_what_only_reads_writes_nothing(self):
        for name, kind in READERS.items():
            with self.subTest(name):
                row = kind(self.folder / name)
                done = run(row.command(), self.folder / name, count=self.folder / "count")
                self.assertLess(done.returncode, 2, done.stderr)
                self.assertFalse((self.folder / "count").exists())  # nothing was counted


    @unittest.skipUnless(ALL, "slow")
    def test_init_goes_on_from_where_it_was_killed(self):
        row = Init(self.folder / "now")
        self.assertEqual(run(row.command(), row.top, count=self.folder / "count").returncode, 0)
        whole, wanted = int((self.folder / "count").read_text()), row.results()
        shutil.rmtree(row.top / "deep")

        def kept():
            files = (row.top / "deep" / ".block.init" / "trial_1" / "checkpoints").glob("*")
            return {path.name: (path.stat().st_ino, path.stat().st_mtime_ns) for path in files}

        self.assertEqual(run(row.command(), row.top, at=whole // 2).returncode, -9)
        before = kept()
        self.assertNotEqual(before, {})
        self.assertEqual(run(row.command(), row.top, at=whole // 4).returncode, -9)
        self.assertEqual({name: kept().get(name) for name in before}, before, "what was planned is planned again")
        again = run(row.command(), row.top)
        self.assertEqual((again.returncode, row.results(), row.litter()), (0, wanted, []), again.stderr)


class Matrix:
    """Of one row: at each place what stands is old or new, part by part, and the same command again makes it new and leaves
    nothing else."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="millpose-commands.")
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name).resolve()

    def test_old_or_new_at_every_operation(self):
        row = self.kind(self.folder / "now")
        kept = self.folder / "kept"
        shutil.copytree(row.top, kept, symlinks=True)
        done = self.run_row(row, count=self.folder / "count")
        self.assertLess(done.returncode, 2, done.stderr)
        count = int((self.folder / "count").read_text())
        self.assertGreater(count, 3)
        self.new = row.results()
        shutil.rmtree(row.top)
        shutil.copytree(kept, row.top, symlinks=True)
        self.old = row.results()
        self.assertEqual(self.old == self.new, row.adds)
        for turn, at in enumerate(places(count, row.quick)):
            for fault in ("kill", FAULTS[1 + turn % 3]) if ALL else [FAULTS[(0, 1, 0, 2, 0, 3)[turn % 6]]]:
                with self.subTest(fault=fault, at=at, of=count):
                    shutil.rmtree(row.top)
                    shutil.copytree(kept, row.top, symlinks=True)
                    # After the last operation a command finds what it has made itself.
                    self.try_at(row, at, fault, again=ALL or turn % 4 == 2 or at == count)

    @staticmethod
    def run_row(row, **fault):
        return run([*row.command(), "-q"], row.top, more={**row.environment(), "MILLPOSE_FAULT_OWN": "1"}, **fault)

    def try_at(self, row, at, fault, again):
        failed = self.run_row(row, at=at, fault=fault)
        self.wait_for_children(row)
        if fault == "kill":
            self.assertEqual(failed.returncode, -9, failed.stderr)
        elif failed.returncode > 1:
            self.assertEqual(failed.returncode, 2, failed.stderr)
            self.assertIn(os.strerror(getattr(errno, fault)), failed.stderr + failed.stdout)
            self.assertIn(str(row.top), failed.stderr + failed.stdout)
            self.assertEqual([name for name in row.litter() if name.endswith(".tmp")], [])
        self.check_parts(row, fault)
        if failed.returncode in (0, 1):
            self.assertEqual(row.results(), self.new, "only clearing up failed")
        if not again:
            return
        done = self.run_row(row)
        self.assertTrue(row.is_done(done), done.stderr)
        self.assertEqual(row.results(), self.new)
        self.assertEqual(row.litter(), [])

    def check_parts(self, row, fault):
        found = row.results()
        for part in {*self.old, *self.new, *found}:
            stands, old, new = (files.get(part, {}) for files in (found, self.old, self.new))
            if stands in (old, new) or row.is_open(part) or (fault == "kill" and row.half_done(part)):
                continue
            state = {name: "old" if stands.get(name) == old.get(name) else "new" if stands.get(name) == new.get(name) else "other"
                     for name in {*stands, *old, *new}}
            self.fail(f"{part} is of two runs: {state}")

    @staticmethod
    def wait_for_children(row):
        """A job of a batch that was killed ends with it, a moment later."""
        for _ in range(100):
            if not any(str(row.top).encode() in line for line in map(command_line, Path("/proc").glob("[0-9]*"))):
                return
            time.sleep(0.02)


def command_line(process):
    try:
        return (process / "cmdline").read_bytes()
    except OSError:
        return b""


for own in [kind for kinds in WRITERS.values() for kind in kinds]:
    globals()[f"Of{own.__name__}"] = type(f"Of{own.__name__}", (Matrix, unittest.TestCase), {"kind": own})
del own


if __name__ == "__main__":
    main()
