#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The output folder: whose it is, who writes it, what is taken for one plan. Usage: folder_test.py MILLPOSE TOP"""
import fcntl
import json
import os
import resource
import shutil
import struct
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree as xml
from pathlib import Path

from cli_fixture import FEW, JOB, MILLPOSE, TOP, InFolder, plan, run, schema_problems, tree

SETS = [word for change in FEW for word in ("--set", change)]
PAIRS = int(os.environ.get("MILLPOSE_PAIRS", "1"))


def hold(folder, kind):
    """A lock on an output folder as another run has it; it ends when the file is closed."""
    file = open(folder / ".lock", "r+b")
    fcntl.fcntl(file, fcntl.F_OFD_SETLK, struct.pack("hhqqi4x", kind, os.SEEK_SET, 0, 0, 0))
    return file


class Folder(InFolder):
    def planned_once(self):
        """A folder with a plan; planned for the first test that asks, copied for the others."""
        if not hasattr(Folder, "kept"):
            Folder.kept = tempfile.TemporaryDirectory()
            self.assertEqual(plan(Folder.kept.name + "/out").returncode, 0)
        return shutil.copytree(Folder.kept.name + "/out", self.folder / "out")

    def test_a_name_leads_nowhere_else(self):
        for name in ("../a/good", "a/b", "..", ".hidden", "-rf", '"a\\nb"', '"a\\tb"', "a\\b", "x" * 101, '""'):
            result = run("plan", JOB, "--set", f"name={name}", "-o", self.folder / "out")
            self.assertEqual(result.returncode, 2, name)
            self.assertIn("name: ", result.stderr)
            self.assertFalse((self.folder / "out").exists(), name)
        (self.folder / "batch.yaml").write_text(f"millpose_batch: 1\njobs:\n  - {{job: {JOB}, name: ../x}}\n")
        self.assertEqual(run("batch", self.folder / "batch.yaml", cwd=self.folder).returncode, 2)

    def test_two_jobs_of_one_name_are_not_each_others_results(self):
        out = self.planned_once()
        run_file = json.loads((out / "run.json").read_text())
        text = JOB.read_text().replace("../../cells", str(TOP / "cells")).replace("mesh: ", f"mesh: {JOB.parent}/")
        for name in ("a", "b"):
            (self.folder / f"{name}.yaml").write_text(text)
        run_file["job"]["file"] = "../a.yaml"
        (out / "run.json").write_text(json.dumps(run_file))
        before = tree(out)
        refused = run("plan", self.folder / "b.yaml", "-o", out, *SETS)
        self.assertEqual(refused.returncode, 2)
        self.assertIn("is also the name of", refused.stderr)
        self.assertEqual(tree(out), before)
        (self.folder / "a.yaml").unlink()  # renamed or removed: nobody else's
        self.assertEqual(run("plan", self.folder / "b.yaml", "-o", out, *SETS).returncode, 0)
        self.assertEqual(json.loads((out / "run.json").read_text())["job"], {"name": "support_pad", "file": "../b.yaml"})

    def test_a_second_run_is_told_who_has_the_folder(self):
        out = self.planned_once()
        before = tree(out)
        owner = {"host": "milling-cell", "process": 4711, "since": "2026-01-02T03:04:05Z", "alone": True}
        (out / ".owner.milling-cell.4711").write_text(json.dumps(owner))
        with hold(out, fcntl.F_WRLCK):
            for arguments in ((), ("--share", "1/2")):
                refused = plan(out, *arguments)
                self.assertEqual(refused.returncode, 2)
                self.assertIn("process 4711 on milling-cell since 2026-01-02T03:04:05Z", refused.stderr)
        with hold(out, fcntl.F_RDLCK):
            self.assertEqual(plan(out).returncode, 2, "results are written by one who is alone")
            self.assertEqual(plan(out, "--share", "1/2").returncode, 0, "shares only add checkpoints")
        (out / ".owner.milling-cell.4711").rename(out / ".owner.milling-cell.4712")  # left by one who was killed
        self.assertEqual({name: text for name, text in tree(out).items() if not name.startswith(".owner")}, before)
        self.assertEqual(plan(out).returncode, 0)
        self.assertFalse(list(out.glob(".owner.*")), "what a killed run left is removed")

    def test_of_two_runs_at_once_one_plans_and_the_other_says_why_not(self):
        out = self.planned_once()
        first, second = ((*SETS,), (*SETS, "--set", "process.spindle_rpm=100"))
        sets = [tree(out), None]
        self.assertEqual(plan(self.folder / "b", *second).returncode, 0)
        sets[1] = tree(self.folder / "b")
        for pair in range(PAIRS):
            command = [MILLPOSE, "plan", JOB, "-o", out, "-q"]
            runs = [subprocess.Popen([*map(str, command), *more], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
                    for more in (first, second)]
            errors = [process.communicate(timeout=300)[1] for process in runs]
            statuses = [process.returncode for process in runs]
            self.assertIn(sorted(statuses), ([0, 0], [0, 2]), errors)
            for status, error in zip(statuses, errors):
                if status == 2:
                    self.assertIn("another run works in this folder: ", error)
            self.assertIn(tree(out), [sets[i] for i in range(2) if statuses[i] == 0], f"pair {pair}")
            self.assertEqual(run("verify", out, "-q").returncode if pair == 0 else 0, 0)

    def test_shares_at_once_leave_the_checkpoints_of_all(self):
        changes = ("toolpath.stepover_mm=20", "toolpath.spacing_mm=40")
        sets = [word for change in changes for word in ("--set", change)]
        shares = [subprocess.Popen([MILLPOSE, "plan", JOB, "-o", self.folder / "new", *sets, "--share", f"{i}/3", "-q"],
                                   stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True) for i in (1, 2, 3)]
        for share in shares:
            self.assertEqual((share.communicate(timeout=300)[1], share.returncode), ("", 0))
        self.assertEqual(plan(self.folder / "new", changes=changes).returncode, 0)
        figures = json.loads((self.folder / "new" / "run.json").read_text())
        summary = json.loads((self.folder / "new" / "summary.json").read_text())
        self.assertEqual(figures["resumed_passes"], summary["passes"])

    def test_the_manifest_names_every_file(self):
        out = self.planned_once()
        manifest = json.loads((out / "manifest.json").read_text())
        self.assertEqual(schema_problems("manifest", manifest), [])
        files = {str(path.relative_to(out)): path.stat().st_size for path in out.rglob("*") if path.is_file()}
        own = {".millpose", ".lock", "manifest.json", "run.json"}
        self.assertEqual({file["path"]: file["bytes"] for file in manifest["files"]},
                         {name: size for name, size in files.items() if name not in own and "checkpoints" not in name})
        self.assertEqual(manifest["key"], json.loads((out / "summary.json").read_text())["input_hash"])

    def test_a_set_that_its_manifest_does_not_match_is_refused(self):
        def damage(name, change):
            out = shutil.copytree(Folder.kept.name + "/out", self.folder / "damaged", dirs_exist_ok=True)
            change(out / name)
            result = run("verify", out)
            self.assertEqual(result.returncode, 2, name)
            self.assertIn(name, result.stderr)
            shutil.rmtree(out)

        self.planned_once()
        damage("programs/krl/support_pad.dat", lambda path: path.unlink())
        damage("programs/krl/other.src", lambda path: path.write_text("DEF other()\nEND\n"))
        damage("summary.json", lambda path: path.write_text(path.read_text().replace("0", "1", 1)))
        damage("run.json", lambda path: path.write_text(path.read_text().replace('"manifest": "', '"manifest": "0')))
        damage("manifest.json", lambda path: path.unlink())

    def test_damage_locks_nobody_out(self):
        self.planned_once()
        for name, damage, *more in (("manifest.json", "", "--fresh"), ("manifest.json", "{"), (".journal", "", "--fresh"),
                                    (".journal", '{"new": [1]}'), ("run.json", "{")):
            with self.subTest(name=name, damage=damage, more=more):
                out = self.folder / "damaged"
                shutil.rmtree(out, ignore_errors=True)
                shutil.copytree(Folder.kept.name + "/out", out)
                (out / name).write_text(damage)
                (out / "note.txt").write_text("the user's")
                planned = plan(out, *more)
                self.assertEqual(planned.returncode, 0, planned.stderr)
                if name == "manifest.json":
                    self.assertIn("is no manifest of millpose", planned.stdout)
                    self.assertIn("not millpose's and left: note.txt", planned.stdout)
                self.assertEqual((out / "note.txt").read_text(), "the user's")
                self.assertEqual(run("verify", out).returncode, 0)
                (out / "note.txt").unlink()
                self.assertEqual(tree(out), tree(Path(Folder.kept.name) / "out"))

    def test_readers_write_nothing(self):
        out = self.planned_once()
        (out / "note.txt").write_text("the user's")
        (out / ".journal").write_text('{"new": [], "old": ["note.txt"]}')
        before = {path: path.lstat() for path in [out, *out.rglob("*")]}
        for reader in ("verify", "inspect"):
            self.assertEqual(run(reader, out).returncode, 0)
            self.assertEqual({path: path.lstat().st_mtime_ns for path in [out, *out.rglob("*")]},
                             {path: info.st_mtime_ns for path, info in before.items()})
        (out / "manifest.json").rename(out / ".replaced.json")  # as a run leaves it that was killed
        for reader in ("verify", "inspect"):
            read = run(reader, out)
            self.assertEqual(read.returncode, 2)
            self.assertIn("is being replaced by another run, or was when that was ended", read.stderr)

    def test_batch_plans_again_what_its_manifest_does_not_match(self):
        (self.folder / "batch.yaml").write_text(
            f"millpose_batch: 1\njobs:\n  - {{job: {JOB}, name: a, set: {{{', '.join(c.replace('=', ': ') for c in FEW)}}}}}\n")
        self.assertEqual(run("batch", "batch.yaml", cwd=self.folder).returncode, 0)
        program = self.folder / "batch.out" / "a" / "programs" / "krl" / "a.src"
        content = program.read_bytes()
        program.write_bytes(content[:-10])
        again = run("batch", "batch.yaml", cwd=self.folder)
        self.assertEqual(again.returncode, 0, again.stdout)
        self.assertNotIn("up to date", again.stdout)
        self.assertEqual(program.read_bytes(), content)
        self.assertIn("up to date", run("batch", "batch.yaml", cwd=self.folder).stdout)

    def test_a_checkpoint_under_another_name_is_not_used(self):
        out = self.planned_once()
        before = tree(out)
        checkpoints = sorted((out / "checkpoints").iterdir())
        content = max(checkpoints, key=lambda path: path.stat().st_size).read_bytes()
        for path in checkpoints:
            path.write_bytes(content)
        self.assertEqual(plan(out).returncode, 0)
        self.assertEqual(tree(out), before)

    def test_stderr_that_nobody_reads_ends_nothing(self):
        out = self.planned_once()
        reader, writer = os.pipe()
        os.close(reader)
        with open("/dev/full", "w") as full, os.fdopen(writer, "w") as closed:
            for stderr in (full, closed):
                for more, status in (((), 0), (("--json-progress",), 0), (("--set", "seed=x"), 2)):
                    result = subprocess.run([MILLPOSE, "plan", JOB, "-o", out, *SETS, *more], stdout=subprocess.DEVNULL,
                                            stderr=stderr, timeout=300)
                    self.assertEqual(result.returncode, status, more)
            for words in (("plam",), ("plan", "--sed", "1"), ("plan", "no.yaml")):
                self.assertEqual(subprocess.run([MILLPOSE, *words], stdout=subprocess.DEVNULL, stderr=full).returncode, 2)
            result = subprocess.run([MILLPOSE, "schema", "job"], stdout=full, stderr=subprocess.PIPE, text=True)
            self.assertEqual((result.returncode, result.stderr), (2, "millpose: cannot write to standard output\n"))

    def test_a_folder_of_an_earlier_version_is_said_to_be_one(self):
        out = self.planned_once()
        (out / "plan.cbor.gz").rename(out / "plan.cbor")
        for words in (("verify", out), ("face", out), ("report", out, "--html", self.folder / "sheet.html"), ("diff", out, out)):
            result = run(*words)
            self.assertEqual(result.returncode, 2, words)
            self.assertIn("plan.cbor: is of an earlier version; allowed: the folder planned again by this one", result.stderr, words)

    def test_memory_that_runs_out_is_said_plainly(self):
        fine = ("check", TOP / "toolpaths/cabin_pocket/job.yaml", "--set", "workpiece.stock.resolution_mm=0.1")
        result = subprocess.run([MILLPOSE, *fine], capture_output=True, text=True,
                                preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (64 << 20, 64 << 20)))
        self.assertEqual((result.returncode, result.stderr.splitlines()[-1][:24]), (3, "millpose: out of memory:"), result.stderr)

    def test_a_folder_name_that_is_no_utf_8_ends_no_batch(self):
        folder = os.fsencode(self.folder) + b"/gro\xdf"
        os.mkdir(folder)
        text = JOB.read_text().replace("../../cells", str(TOP / "cells")).replace("mesh: ", f"mesh: {JOB.parent}/")
        for old, new in (("spacing_mm: 4", "spacing_mm: 40"), ("stepover_mm: 8", "stepover_mm: 40")):
            text = text.replace(old, new)
        for name, content in ((b"good.yaml", text), (b"bad.yaml", text.replace("name: support_pad", "nam: x"))):
            with open(folder + b"/" + name, "w") as file:
                file.write(content)
        result = subprocess.run([MILLPOSE, "batch", ".", "-o", b"out"], cwd=folder, capture_output=True, timeout=300)
        self.assertEqual(result.returncode, 2, result.stderr)
        with open(folder + b"/out/batch.json", encoding="utf-8") as file:
            self.assertEqual(sorted(job["status"] for job in json.load(file)["jobs"]), [0, 2])
        with open(folder + b"/out/junit.xml", encoding="utf-8") as file:
            xml.parse(file)


class Clean(InFolder):
    def test_takes_the_checkpoints_and_leaves_what_verify_needs(self):
        out = self.folder / "out"
        self.assertEqual(run("plan", JOB, "-o", out, *SETS).returncode, 0)
        before = tree(out)
        told = run("clean", out, "--dry-run")
        self.assertRegex(told.stdout, r"^ +\d+\.\d MB in ")
        self.assertTrue(any((out / "checkpoints").iterdir()))
        told = run("clean", out)
        self.assertEqual((told.returncode, tree(out)), (0, before), told.stderr)
        self.assertFalse((out / "checkpoints").exists() and any((out / "checkpoints").iterdir()))
        self.assertEqual(run("verify", out).returncode, 0)
        self.assertIn("unchanged", run("plan", JOB, "-o", out, *SETS).stdout)
        self.check_passes_stay(out)
        refused = run("clean", out, self.folder)
        self.assertEqual(refused.returncode, 2)
        self.assertIn("is no output folder of millpose", refused.stderr)

    def check_passes_stay(self, out):
        again = ("--set", "process.spindle_rpm=6000")
        planned = run("plan", JOB, "-o", out, *SETS, *again)
        self.assertEqual(planned.returncode, 0, planned.stderr)
        kept = sorted(file for file in (out / "checkpoints").rglob("*") if file.suffix == ".kept")
        self.assertTrue(kept and list((out / "checkpoints").rglob("*.stage")))
        told = run("clean", out, "--keep", "passes")
        self.assertEqual(told.returncode, 0, told.stderr)
        self.assertEqual((sorted((out / "checkpoints").rglob("*.kept")), list((out / "checkpoints").rglob("*.stage"))), (kept, []))
        for file in kept:  # the hash of what follows, then a frame of zstd
            self.assertEqual(file.read_bytes()[32:36], b"\x28\xb5\x2f\xfd", file)
        wrong = run("clean", out, "--keep", "pass")
        self.assertEqual(wrong.returncode, 2)
        self.assertIn("passes", wrong.stderr)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
