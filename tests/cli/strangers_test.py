#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Jobs of strangers and slips of the keyboard: nothing outside of --root, nothing beyond a budget, no text to a shell.
Usage: strangers_test.py MILLPOSE TOP"""
import os
import re
import shutil
import subprocess
import unittest

from cli_fixture import JOB, MILLPOSE, TOP, InFolder, plan, run

CPU_SECONDS, MEMORY_MB = 5, 1024  # that a refusal may take


def measured(*arguments):
    """(status, stderr, CPU seconds, MB) of a run."""
    process = subprocess.Popen([MILLPOSE, *map(str, arguments)], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    errors = process.stderr.read()
    process.stderr.close()
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    return process.returncode, errors, usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024


class Slips(InFolder):
    def test_what_asks_for_too_much_is_refused_by_its_key_before_the_work(self):
        for changes, word in (
                (["toolpath.stepover_mm=1e-8"], "toolpath.stepover_mm: given 1e-8; allowed: number 0.001…10000, mm"),
                (["toolpath.stepover_mm=0.001", "toolpath.spacing_mm=0.01"], "toolpath.stepover_mm: given 0.001; the tool path"),
                (["toolpath.spacing_mm=0.001", "toolpath.stepover_mm=1"], "toolpath.spacing_mm: given 0.001; the tool path"),
                (["toolpath.depth={total_mm: 1000, per_layer_mm: 0.001}"], "toolpath.depth.per_layer_mm: given 0.001"),
                (["toolpath.ends={overrun_mm: 1e9}"], "toolpath.ends.overrun_mm: given 1e9; allowed: number 0…1000, mm"),
                (["toolpath.ends={overrun_mm: 1000}", "toolpath.spacing_mm=0.01"], "toolpath.ends.overrun_mm: given 1000"),
                (["workpiece.unit=m"], "workpiece.unit: the part is"),
                (["process.spindle_rpm=1e300"], "process.spindle_rpm: given 1e300; allowed: number 0…500000, rev/min"),
                (["seed=-1"], "seed: given -1; allowed")):
            with self.subTest(changes):
                sets = [text for change in changes for text in ("--set", change)]
                status, errors, seconds, memory = measured("plan", JOB, "-o", self.folder / "out", *sets)
                self.assertEqual(status, 2, errors)
                self.assertIn(word, errors)
                self.assertLess(seconds, CPU_SECONDS)
                self.assertLess(memory, MEMORY_MB)

    def test_a_larger_budget_is_the_users_to_give(self):
        few = plan(self.folder / "few", "--max-points", 10, changes=("toolpath.stepover_mm=20", "toolpath.spacing_mm=20"))
        self.assertEqual(few.returncode, 2)
        self.assertRegex(few.stderr, r"toolpath\.(stepover|spacing)_mm: given 20; .*allowed: at most 10 points \(--max-points\)")
        self.assertEqual(run("check", JOB, "--max-points", 5).returncode, 2)
        self.assertEqual(run("plan", JOB, "--seed", -1).returncode, 2)

    def test_a_file_that_is_no_cell_is_not_printed(self):
        secret = self.folder / "secret"
        secret.write_text("".join(f"root{i}:x:0:0: word {i} :/root\n" for i in range(2000)))
        result = plan(self.folder / "out", "--set", f"cell={secret}")
        self.assertEqual(result.returncode, 2)
        self.assertLess(len(result.stderr), 20000)
        self.assertNotIn("word", result.stderr)
        self.assertNotIn("root99", result.stderr)


class Strangers(InFolder):
    def setUp(self):
        super().setUp()
        self.root = self.folder / "theirs"
        shutil.copytree(JOB.parent, self.root)
        shutil.copy(TOP / "cells/kr500_r2830.yaml", self.root / "cell.yaml")
        (self.folder / "outside").mkdir()
        for name in ("support_pad.stl", "cell.yaml"):
            shutil.copy(self.root / name, self.folder / "outside" / name)
        shutil.copy(TOP / "tests/machine/robot/turned_about.urdf", self.root / "arm.urdf")
        text = JOB.read_text().replace("../../cells/kr500_r2830.yaml", "cell.yaml")
        self.text = re.sub(r"(stepover|spacing)_mm: [\d.]+", r"\1_mm: 40", text)

    def job(self, *changes):
        text = self.text
        for old, new in changes:
            self.assertIn(old, text)
            text = text.replace(old, new)
        path = self.root / "job.yaml"
        path.write_text(text)
        return path

    def assert_kept_in(self, *arguments, word="lies outside of"):
        before = sorted(self.folder.rglob("*"))
        result = run(*arguments, "--root", self.root)
        self.assertEqual(result.returncode, 2, result.stdout + result.stderr)
        self.assertIn(word, result.stderr)
        self.assertEqual(sorted(path for path in self.folder.rglob("*") if self.root not in path.parents), [
            path for path in before if self.root not in path.parents])

    def test_what_lies_within_is_planned(self):
        result = run("plan", self.job(), "--root", self.root)
        self.assertEqual(result.returncode, 0, result.stderr)
        out = self.root / "support_pad.out"
        self.assertEqual(run("verify", out, "--root", self.root).returncode, 0)
        # One program becomes a link to the same program elsewhere.
        program = next((out / "programs/krl").glob("*.src"))
        shutil.copy(program, self.folder / "outside" / program.name)
        program.unlink()
        program.symlink_to(self.folder / "outside" / program.name)
        self.assert_kept_in("verify", out, word="is a symbolic link")

    def test_no_path_of_a_job_leads_out(self):
        outside = self.folder / "outside"
        (self.root / "link.stl").symlink_to(outside / "support_pad.stl")
        (self.root / "folder").symlink_to(outside)
        mesh = "mesh: support_pad.stl"
        for change in ((mesh, f"mesh: {outside}/support_pad.stl"), (mesh, "mesh: ../outside/support_pad.stl"),
                       (mesh, "mesh: link.stl"), (mesh, "mesh: folder/support_pad.stl"),
                       ("cell: cell.yaml", "cell: ../outside/cell.yaml"),
                       ("cell: cell.yaml", f"cell: {outside}/cell.yaml"),
                       (mesh, mesh + "\n  stock: {mesh: ../outside/support_pad.stl, unit: mm}")):
            with self.subTest(change):
                self.assertLess(run("check", self.job(change)).returncode, 2)  # without a root all is as ever
                self.assert_kept_in("check", self.job(change))
        self.assert_kept_in("plan", self.job((mesh, "mesh: link.stl")))

    def test_no_path_of_a_cell_or_a_urdf_leads_out(self):
        cell = (TOP / "cells/kr500_r2830.yaml").read_text()
        body = "  - {name: foreign, class: fixture, mount: world, shape: {mesh: {file: ../outside/support_pad.stl, unit: mm}}}\n"
        (self.root / "cell.yaml").write_text(cell.replace("bodies:\n", "bodies:\n" + body))
        self.assert_kept_in("check", self.job())
        keys = ("lengths_mm", "axis_signs", "zero_offsets_deg", "limits_deg", "speeds_deg_s", "limits_source")
        bare = re.sub(rf"^  (?:{'|'.join(keys)}):.*\n(?:   +.*\n)*", "", cell, flags=re.MULTILINE)
        urdf = (self.root / "arm.urdf").read_text()
        for file, packages, name in (("../outside/arm.urdf", "", None), ("arm.urdf", "", f"file://{self.folder}/outside/support_pad.stl"),
                                     ("arm.urdf", ", packages: {own: .}", "package://own/../outside/support_pad.stl"),
                                     ("arm.urdf", ", packages: {own: ../outside}", "package://own/support_pad.stl")):
            with self.subTest(name or file):
                arm = f"  urdf: {{file: {file}, base_link: base_link, flange_link: tool0{packages}}}\n"
                (self.root / "cell.yaml").write_text(bare.replace("arm:\n", "arm:\n" + arm, 1))
                changed = urdf if name is None else re.sub(r"<box [^>]*/>", f'<mesh filename="{name}" scale="0.001 0.001 0.001"/>', urdf, count=1)
                for folder in (self.root, self.folder / "outside"):
                    (folder / "arm.urdf").write_text(changed)
                self.assert_kept_in("check", self.job())

    def test_results_go_through_no_link(self):
        (self.root / "support_pad.out").symlink_to(self.folder / "outside")
        self.assert_kept_in("plan", self.job())

    def test_no_journal_of_a_stranger_moves_anything(self):
        out, kept, batch = self.root / "support_pad.out", self.folder / "kept", self.root / "batch.out"
        self.assertEqual(run("plan", self.job(), "--root", self.root, "-q").returncode, 0)
        shutil.copytree(out, kept)
        (self.root / "batch.yaml").write_text("millpose_batch: 1\nuntrusted: true\njobs: [{job: job.yaml}]\n")
        self.assertEqual(run("batch", self.root / "batch.yaml", "-o", batch).returncode, 0)
        victim = self.folder / "outside" / "victim.txt"
        for journal in ('{"new":[],"old":["../../outside/victim.txt"]}', '{"new":["../../outside/victim.txt"],"old":[]}', "{"):
            for command in (("plan", self.root / "job.yaml", "--root", self.root), ("plan", out / "job.yaml", "--root", self.root),
                            ("verify", out, "--root", self.root), ("batch", self.root / "batch.yaml", "-o", batch)):
                with self.subTest(journal=journal, command=command[:2]):
                    victim.write_text("years of work")
                    (self.root / "outside").mkdir(exist_ok=True)  # where the same names lead from a folder below
                    (self.root / "outside" / "victim.txt").write_text("a stranger's")
                    shutil.rmtree(out)
                    shutil.copytree(kept, out)
                    for folder in (out, batch / "support_pad"):
                        self.assertTrue((folder / ".millpose").exists())
                        (folder / ".journal").write_text(journal)
                        for begun in (".replaced", ".staging"):
                            (folder / begun).mkdir(exist_ok=True)
                    result = run(*command)
                    self.assertEqual(victim.read_text(), "years of work")
                    self.assertEqual(result.returncode, 0, result.stderr)
                    self.assertEqual(run("verify", out, "--root", self.root).returncode, 0)

    def test_an_untrusted_folder_is_its_jobs_world(self):
        self.job(("mesh: support_pad.stl", "mesh: ../outside/support_pad.stl"))
        manifest = self.root / "batch.yaml"
        jobs = "jobs: [{job: job.yaml}]\n"
        manifest.write_text("millpose_batch: 1\nuntrusted: true\n" + jobs)
        for given in (manifest, self.root):
            result = run("batch", given, "-o", self.folder / "out", "--fresh")
            self.assertEqual(result.returncode, 2, result.stdout + result.stderr)
            self.assertIn("lies outside of", (self.folder / "out/batch.json").read_text())
        self.assertIn("lies outside of", run("batch", self.root, "-o", self.folder / "out2", "--root", self.folder / "outside").stderr)
        manifest.write_text("millpose_batch: 1\nuntrusted: true\njobs: [{job: ../outside/job.yaml}]\n")
        self.assert_kept_in("batch", manifest, "-o", self.folder / "out")

    def test_no_text_of_a_job_reaches_a_shell(self):
        name = "a\ntouch hit\n"
        shutil.copytree(self.root, self.folder / name)
        (self.folder / name / "job.yaml").write_text(self.text)
        result = subprocess.run([MILLPOSE, "batch", self.folder / name / "job.yaml", "-o", self.folder / "out", "--slurm"],
                                cwd=self.folder, capture_output=True, text=True, timeout=60)
        self.assertEqual(result.returncode, 2, result.stdout + result.stderr)
        self.assertIn("control character", result.stderr)
        self.assertEqual(list(self.folder.rglob("hit")), [])


if __name__ == "__main__":
    unittest.main(argv=["strangers_test.py"])
