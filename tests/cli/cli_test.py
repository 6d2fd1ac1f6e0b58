#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs the real millpose and looks at status, stdout, stderr and files. Usage: cli_test.py MILLPOSE TOP"""
import csv
import json
import os
import shutil
import signal
import re
import subprocess
import sys
import tempfile
import time
import unittest
import xml.etree.ElementTree as xml
from pathlib import Path

import json_schema

MILLPOSE, TOP = Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve()
JOB = TOP / "toolpaths" / "support_pad" / "job.yaml"
# A few points of the sample: enough to go the whole way.
FEW = ("toolpath.stepover_mm=40", "toolpath.spacing_mm=40")


def run(*arguments, cwd=None, env=None):
    return subprocess.run([MILLPOSE, *map(str, arguments)], capture_output=True, text=True, timeout=300, cwd=cwd,
                          env=env)


def plan(folder, *arguments, changes=FEW):
    sets = [word for change in changes for word in ("--set", change)]
    return run("plan", JOB, "-o", folder, *sets, *arguments)


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


class Frame(unittest.TestCase):
    def test_version_and_help_go_to_stdout_with_status_0(self):
        self.assertRegex(run("--version").stdout, r"^millpose \d+\.\d+\.\d+\n$")
        for arguments in (("--help",), ("plan", "--help"), ("batch", "--help"), ("inspect", "--help")):
            result = run(*arguments)
            self.assertEqual(result.returncode, 0)
            self.assertIn("Usage: millpose", result.stdout)
            self.assertEqual(result.stderr, "")
        self.assertIn("Exit status: 0 done", run("--help").stdout)

    def test_usage_errors_go_to_stderr_with_status_2(self):
        for arguments in ((), ("paln",), ("schema",), ("schema", "robot"), ("--no-such-option",), ("plan",),
                          ("plan", JOB, "--threads", "-1"), ("plan", JOB, "--set", "seed"), ("inspect",)):
            result = run(*arguments)
            self.assertEqual(result.returncode, 2, arguments)
            self.assertEqual(result.stdout, "", arguments)
            self.assertNotEqual(result.stderr, "", arguments)

    def test_mistyped_command_is_answered_with_the_nearest(self):
        self.assertIn("unknown command paln; nearest: plan", run("paln", "job").stderr)
        self.assertIn("what is required", run("schema").stderr)


class Schema(unittest.TestCase):
    def test_schemas_are_the_committed_ones(self):
        for what in ("job", "cell", "batch"):
            result = run("schema", what)
            self.assertEqual(result.returncode, 0)
            with open(f"{TOP}/docs/schema/{what}.schema.json", encoding="utf-8") as file:
                self.assertEqual(json.loads(result.stdout), json.load(file))


class Verify(InFolder):
    def test_confirms_what_plan_wrote_and_finds_what_was_changed(self):
        out = self.folder / "out"
        self.assertEqual(plan(out).returncode, 0)
        result = run("verify", out, "--job", JOB, "--json")
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        programs = json.loads(result.stdout)["programs"]
        self.assertEqual([p["controller"] for p in programs], ["krl", "linuxcnc", "sinumerik"])
        self.assertTrue(all(p["confirmed"] for p in programs))

        source = out / "programs" / "krl" / "support_pad.src"
        text = source.read_text()
        line = next(l for l in text.splitlines() if l.startswith("LIN "))
        source.write_text(text.replace(line, line.replace(",Z ", ",Z 1"), 1))
        result = run("verify", out, "--job", JOB)
        self.assertEqual(result.returncode, 1, result.stdout + result.stderr)
        self.assertRegex(result.stdout, r"support_pad\.src:\d+: ")
        source.write_text(text.replace(line, line.replace("LIN", "LINE"), 1))
        result = run("verify", out, "--job", JOB)
        self.assertEqual(result.returncode, 2)
        self.assertRegex(result.stderr, r"support_pad\.src:\d+:\d+: ")

        source.write_text(text)
        result = run("verify", source, "--cell", TOP / "cells" / "kr500_r2830.yaml")
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        self.assertEqual(run("verify", source).returncode, 2)


class Plan(InFolder):
    def test_whole_way_then_inspect(self):
        result = plan(self.folder / "out")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("planned of", result.stdout)
        self.assertNotIn("\x1b", result.stderr, "no terminal, no bar")
        for stage in ("read", "surface", "toolpath", "passes", "gaps", "programs"):
            self.assertRegex(result.stderr, rf"(?m)^{stage} ")
        for name in ("points.csv", "summary.json", "run.json", "job.yaml", "path.vtp", "report.html",
                     "programs/krl/support_pad.src"):
            self.assertTrue((self.folder / "out" / name).is_file(), name)
        summary = json.loads((self.folder / "out" / "summary.json").read_text())
        with (self.folder / "out" / "points.csv").open() as file:
            rows = list(csv.DictReader(file))
        self.assertEqual(summary["points"]["total"], len(rows))
        self.assertGreater(len(rows), 3)

        self.assertEqual(schema_problems("summary", summary), [])
        self.assertEqual(schema_problems("run", json.loads((self.folder / "out" / "run.json").read_text())), [])
        del summary["audit"]
        summary["points"]["total"] = "many"
        self.assertEqual(len(schema_problems("summary", summary)), 2, "the judge of schemas sees damage")

        shown = run("inspect", self.folder / "out", "--worst", 3)
        self.assertEqual(shown.returncode, 0, shown.stderr)
        self.assertIn("worst 3 by objective", shown.stdout)
        shown = json.loads(run("inspect", self.folder / "out", "--point", 1, "--json").stdout)
        self.assertEqual(shown["point"]["x_mm"], float(rows[1]["x_mm"]))
        chosen = min(shown["objective_over_rotation"], key=lambda sample: sample["objective"])
        self.assertLess(abs(chosen["objective"] / shown["point"]["objective"] - 1), 0.05)
        self.assertIn("digits: branch S, *: chosen", run("inspect", self.folder / "out", "--point", 1).stdout)
        self.assertEqual(run("inspect", self.folder / "out", "--point", len(rows)).returncode, 2)
        self.assertEqual(run("inspect", self.folder).returncode, 2)

    def test_quiet_and_threads_change_no_result(self):
        self.assertEqual(plan(self.folder / "a", "--threads", 1).returncode, 0)
        quiet = plan(self.folder / "b", "--threads", 4, "--quiet")
        self.assertEqual((quiet.returncode, quiet.stderr), (0, ""))
        self.assertEqual(tree(self.folder / "a"), tree(self.folder / "b"))
        again = plan(self.folder / "a", "--seed", 1)
        self.assertIn("from checkpoints", again.stderr)
        self.assertEqual(tree(self.folder / "a"), tree(self.folder / "b"))

    def test_damaged_checkpoint_is_found_and_redone(self):
        self.assertEqual(plan(self.folder / "a").returncode, 0)
        before = tree(self.folder / "a")
        for file in (self.folder / "a" / "checkpoints").iterdir():
            data = bytearray(file.read_bytes())
            data[len(data) // 2] ^= 1
            file.write_bytes(data)
        again = plan(self.folder / "a")
        self.assertRegex(again.stderr, r"passes .* 0 (of them )?from checkpoints")
        self.assertEqual(tree(self.folder / "a"), before)

    def test_changed_parameter_redoes_only_what_depends_on_it(self):
        changes = ("toolpath.stepover_mm=20", "toolpath.spacing_mm=40")

        def resumed(*more, program=MILLPOSE):
            out = self.folder / "kept"
            shutil.rmtree(out, ignore_errors=True)
            shutil.copytree(self.folder / "out", out)
            sets = [word for change in changes + more for word in ("--set", change)]
            result = subprocess.run([program, "plan", JOB, "-o", out, *sets, "-q"], capture_output=True, text=True, timeout=300)
            self.assertLessEqual(result.returncode, 1, result.stderr)
            figures = json.loads((out / "run.json").read_text())
            return figures["resumed_passes"], figures["resumed_gaps"]

        self.assertEqual(plan(self.folder / "out", changes=changes).returncode, 0)
        summary = json.loads((self.folder / "out" / "summary.json").read_text())
        passes, gaps = summary["passes"], summary["gaps"]["total"]
        self.assertGreater(passes, 2)
        for harmless in ("name=other", "programs=[krl]", "process.spindle_rpm=100"):
            self.assertEqual(resumed(harmless), (passes, gaps), harmless)
        self.assertEqual(resumed("gaps.max_iterations=30000"), (passes, 0))
        self.assertEqual(resumed("gaps.retract_mm=60"), (passes, 0))
        kept_passes, kept_gaps = resumed("toolpath.stepover_mm=40")
        self.assertLess(kept_passes, passes)
        self.assertLess(kept_gaps, gaps)
        for deep in ("seed=9", "pose.objective.w1=0.4", "limits.margin_deg=3.5", "workpiece.pose.xyz_mm=[2076, 1, 1006]"):
            self.assertEqual(resumed(deep)[0], 0, deep)
        program = MILLPOSE.read_bytes()
        build_id = program.index(b"\x04\0\0\0\x14\0\0\0\x03\0\0\0GNU\0") + 16
        other = self.folder / "other_build"
        other.write_bytes(program[:build_id] + bytes([program[build_id] ^ 1]) + program[build_id + 1:])
        other.chmod(0o755)
        self.assertEqual(resumed(program=other), (0, 0))

    def test_killed_runs_go_on_to_the_same_bytes(self):
        changes = ("toolpath.stepover_mm=20",)
        self.assertEqual(plan(self.folder / "whole", changes=changes).returncode, 0)
        command = [MILLPOSE, "plan", JOB, "-o", self.folder / "killed", "--quiet", "--set", *changes]
        for delay in (0.1, 0.4, 0.8):
            child = subprocess.Popen(command, stdout=subprocess.DEVNULL)
            time.sleep(delay)
            child.kill()
            child.wait()
            programs = self.folder / "killed" / "programs"
            if programs.exists():
                self.assertEqual(sorted(p.name for p in programs.iterdir()), ["krl", "linuxcnc", "sinumerik"])
        self.assertEqual(plan(self.folder / "killed", changes=changes).returncode, 0)
        self.assertEqual(tree(self.folder / "killed"), tree(self.folder / "whole"))

    def test_interrupt_ends_with_130_and_says_how_to_go_on(self):
        child = subprocess.Popen([MILLPOSE, "plan", JOB, "-o", self.folder / "out", "--set", "toolpath.spacing_mm=0.05"],
                                 stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        time.sleep(1.5)
        child.send_signal(signal.SIGINT)
        _, errors = child.communicate(timeout=60)
        self.assertEqual(child.returncode, 130, errors)
        self.assertIn("the same command goes on from there", errors)

    def test_on_a_terminal_progress_is_a_bar(self):
        master, terminal = os.openpty()
        command = [MILLPOSE, "plan", JOB, "-o", self.folder / "out", "--set", "toolpath.stepover_mm=20"]
        with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=terminal) as process:
            os.close(terminal)
            shown = b""
            while True:
                try:
                    piece = os.read(master, 65536)
                except OSError:  # the other end is closed
                    break
                if not piece:
                    break
                shown += piece
        os.close(master)
        self.assertEqual(process.returncode, 0)
        self.assertRegex(shown.decode(), r"\r\x1b\[Kpasses +\[[#.]{30}\] \d+ of \d+ \(\d+ %\)")
        self.assertRegex(shown.decode(), r"\r\x1b\[Kpasses +\d+\.\d s  \d+ passes")

    def test_json_progress_is_one_object_a_line(self):
        result = plan(self.folder / "out", "--json-progress")
        lines = [json.loads(line) for line in result.stderr.splitlines()]
        for line in lines:
            self.assertEqual(schema_problems("progress", line), [], line)
        self.assertEqual([line["stage"] for line in lines if line["event"] == "begin"],
                         [line["stage"] for line in lines if line["event"] == "end"])
        passes = [line for line in lines if line["stage"] == "passes"]
        points = json.loads((self.folder / "out" / "summary.json").read_text())["points"]["total"]
        self.assertEqual((passes[0]["share"], passes[0]["total"]), (0, points))
        self.assertEqual((passes[-1]["share"], passes[-1]["done"], passes[-1]["event"]), (1, points, "end"))
        failed = run("plan", self.folder / "none.yaml", "--json-progress")
        line = json.loads(failed.stderr.splitlines()[-1])
        self.assertEqual(schema_problems("progress", line), [])
        self.assertEqual((line["event"], line["status"]), ("error", 2))
        self.assertIn("none.yaml", line["message"])

    def test_resolved_job_is_planned_again_from_its_folder(self):
        self.assertEqual(plan(self.folder / "a" / "out").returncode, 0)
        before = tree(self.folder / "a" / "out")
        again = run("plan", self.folder / "a" / "out" / "job.yaml")
        self.assertEqual(again.returncode, 0, again.stderr)
        self.assertEqual(tree(self.folder / "a" / "out"), before)
        self.assertEqual(run("verify", self.folder / "a" / "out").returncode, 0)
        elsewhere = run("plan", "job.yaml", "-o", self.folder / "b", cwd=self.folder / "a" / "out")
        self.assertEqual(elsewhere.returncode, 0, elsewhere.stderr)
        self.assertEqual(tree(self.folder / "b"), before)

    def test_resolved_job_is_found_after_job_and_results_moved_together(self):
        shutil.copytree(TOP / "cells", self.folder / "plant" / "cells")
        shutil.copytree(JOB.parent, self.folder / "plant" / "parts" / "pad")
        job = self.folder / "plant" / "parts" / "pad" / "job.yaml"
        sets = [word for change in FEW for word in ("--set", change)]
        self.assertEqual(run("plan", job, *sets).returncode, 0)
        (self.folder / "plant").rename(self.folder / "archive")
        out = self.folder / "archive" / "parts" / "pad" / "support_pad.out"
        self.assertEqual(run("plan", out / "job.yaml").returncode, 0)
        out.rename(self.folder / "alone")
        shutil.rmtree(self.folder / "archive")
        lost = run("plan", self.folder / "alone" / "job.yaml")
        self.assertEqual(lost.returncode, 2)
        self.assertIn("were read from", lost.stderr)

    def test_bad_input_is_told_with_its_place(self):
        (self.folder / "job.yaml").write_text(JOB.read_text().replace("stepover_mm", "stepover"))
        result = run("plan", self.folder / "job.yaml")
        self.assertEqual(result.returncode, 2)
        self.assertRegex(result.stderr, r"job.yaml:\d+:\d+: toolpath.stepover: the key lacks its unit; nearest known key: stepover_mm")

    def test_folder_of_others_is_refused(self):
        (self.folder / "out").mkdir()
        (self.folder / "out" / "precious.txt").write_text("mine")
        self.assertEqual(plan(self.folder / "out").returncode, 2)
        self.assertEqual([p.name for p in (self.folder / "out").iterdir()], ["precious.txt"])


class Batch(InFolder):
    def test_one_broken_job_stops_no_other(self):
        jobs = "".join(f"  - {{job: {JOB}, name: {name}, set: {{{changes}}}}}\n" for name, changes in (
            ("a", "toolpath.stepover_mm: 40, toolpath.spacing_mm: 40"),
            ("b", "toolpath.stepover_mm: -1"),
            ("c", "toolpath.stepover_mm: 40, toolpath.spacing_mm: 40, seed: 2")))
        (self.folder / "batch.yaml").write_text("millpose_batch: 1\njobs:\n" + jobs)
        result = run("batch", "batch.yaml", cwd=self.folder)
        self.assertEqual(result.returncode, 2, result.stderr)
        self.assertIn("3 jobs: 2 done, 0 with findings, 1 failed", result.stdout)
        report = json.loads((self.folder / "batch.out" / "batch.json").read_text())
        self.assertEqual(schema_problems("batch-result", report), [])
        self.assertEqual([job["status"] for job in report["jobs"]], [0, 2, 0])
        self.assertIn("toolpath.stepover_mm: given -1", report["jobs"][1]["cause"])
        suite = xml.parse(self.folder / "batch.out" / "junit.xml").getroot()
        self.assertEqual((suite.get("tests"), suite.get("failures"), suite.get("errors")), ("3", "0", "1"))
        self.assertIsNotNone(suite[1].find("error"))

        self.assertEqual(plan(self.folder / "single", "--set", "name=a").returncode, 0)
        self.assertEqual(tree(self.folder / "batch.out" / "a"), tree(self.folder / "single"))

        again = run("batch", "batch.yaml", cwd=self.folder)
        report = json.loads((self.folder / "batch.out" / "batch.json").read_text())
        self.assertEqual([job["up_to_date"] for job in report["jobs"]], [True, False, True], again.stdout)

    def test_folders_and_patterns_name_jobs(self):
        for name in ("x", "y"):
            shutil.copytree(JOB.parent, self.folder / "parts" / name)
            job = self.folder / "parts" / name / "job.yaml"
            job.write_text(job.read_text().replace("name: support_pad", f"name: {name}").replace(
                "../../cells", str(TOP / "cells")).replace("spacing_mm: 4", "spacing_mm: 40").replace(
                    "stepover_mm: 8", "stepover_mm: 40"))
        by_folder = run("batch", "parts", "-o", "one", cwd=self.folder)
        self.assertIn("2 jobs: 2 done", by_folder.stdout, by_folder.stderr)
        by_pattern = run("batch", "parts/*/job.yaml", "-o", "one", "--parallel", 1, cwd=self.folder)
        self.assertEqual(by_pattern.stdout.count("up to date"), 2, by_pattern.stdout)
        self.assertIn("names nothing", run("batch", "parts/*.yml", cwd=self.folder).stderr)
        twice = run("batch", "parts", "parts/x/job.yaml", "-o", "two", cwd=self.folder)
        self.assertEqual(twice.returncode, 2)
        self.assertIn("is also the name of", twice.stderr)

    def slurm(self, **more):
        """A folder with a batch of two jobs, and the environment in which sbatch and squeue are fakes."""
        (self.folder / "batch.yaml").write_text("millpose_batch: 1\njobs:\n" + "".join(
            f"  - {{job: {JOB}, name: {name}, {more}set: {{toolpath.stepover_mm: 20, toolpath.spacing_mm: 40}}}}\n"
            for name, more in (("a", ""), ("b", "shares: 1, "))))
        for name in ("sbatch", "squeue"):
            (self.folder / name).symlink_to(Path(__file__).with_name("fake_slurm.py"))
        return {**os.environ, "PATH": f"{self.folder}:{os.environ['PATH']}", "FAKE_SLURM_FOLDER": str(self.folder), **more}

    def submissions(self):
        return [line.split() for line in (self.folder / "sbatch.log").read_text().splitlines()]

    def test_slurm_gives_the_same_bytes_and_retries_once(self):
        env = self.slurm(FAKE_SLURM_FAIL="1")
        command = ("batch", "batch.yaml", "--slurm", "--shares", 3, "--sbatch", "--partition=cpu")
        result = run(*command, cwd=self.folder, env=env)
        self.assertEqual(result.returncode, 0, result.stderr + result.stdout)
        arrays = [next(word for word in words if word.startswith("--array")) for words in self.submissions()]
        self.assertEqual(arrays, ["--array=0,1,2", "--array=1", "--array=0,1"])
        self.assertTrue(all("--partition=cpu" in words and "--cpus-per-task=1" in words for words in self.submissions()))
        self.assertEqual(plan(self.folder / "single", "--set", "name=a",
                              changes=("toolpath.stepover_mm=20", "toolpath.spacing_mm=40")).returncode, 0)
        self.assertEqual(tree(self.folder / "batch.out" / "a"), tree(self.folder / "single"))
        resumed = json.loads((self.folder / "batch.out" / "a" / "run.json").read_text())["resumed_passes"]
        self.assertEqual(resumed, 4, "the last task only gathers")
        again = run(*command, cwd=self.folder, env=env)
        self.assertEqual(again.stdout.count("up to date"), 2)
        self.assertEqual(len(self.submissions()), 3)

    def test_slurm_detached_submits_all_and_the_next_call_waits_and_gathers(self):
        env = self.slurm(FAKE_SLURM_FAIL="1")
        command = ("batch", "batch.yaml", "--slurm", "--shares", 2)
        first = run(*command, "--detach", cwd=self.folder, env=env)
        self.assertEqual(first.returncode, 0, first.stderr)
        self.assertIn("2 jobs submitted as 2; the same command without --detach gathers", first.stdout)
        orders = [[word for word in words if word.startswith("--dep")] for words in self.submissions()]
        self.assertEqual(orders, [[], ["--dependency=afterany:1"], ["--dependency=afterany:2"]])
        (self.folder / "queue").write_text("2_0\n2_0\n2_1\n")
        self.assertIn("still run", run(*command, "--detach", cwd=self.folder, env=env).stdout)
        (self.folder / "queue").write_text("2_0\n2_0\n2_1\n")
        gathered = run(*command, cwd=self.folder, env=env)
        self.assertEqual((self.folder / "queue").read_text(), "", "it waits until the queue is empty")
        self.assertEqual(gathered.stdout.count("up to date"), 2, gathered.stdout)
        self.assertEqual(len(self.submissions()), 3)

    def test_slurm_that_refuses_is_told(self):
        env = self.slurm()
        (self.folder / "sbatch").unlink()
        (self.folder / "sbatch").write_text("#!/bin/sh\necho 'sbatch: error: invalid partition' >&2\nexit 1\n")
        (self.folder / "sbatch").chmod(0o755)
        result = run("batch", "batch.yaml", "--slurm", cwd=self.folder, env=env)
        self.assertEqual(result.returncode, 2)
        self.assertIn("invalid partition", result.stderr)


    def test_interrupted_it_stops_its_jobs(self):
        (self.folder / "batch.yaml").write_text(
            f"millpose_batch: 1\njobs:\n  - {{job: {JOB}, name: long, set: {{toolpath.spacing_mm: 0.05}}}}\n")
        with subprocess.Popen([MILLPOSE, "batch", "batch.yaml", "-q"], cwd=self.folder, stderr=subprocess.PIPE,
                              text=True) as process:
            while not (self.folder / "batch.out/long/.millpose").exists():
                self.assertIsNone(process.poll())
                time.sleep(0.02)
            child = next(int(path.name) for path in Path("/proc").iterdir() if path.name.isdigit()
                         and str(self.folder / "batch.out/long") in self.command_line(path))
            process.send_signal(signal.SIGINT)
            _, errors = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 130)
        self.assertIn("the same command goes on from there", errors)
        for _ in range(100):  # it may outlive its parent by a moment
            if "batch.out/long" not in self.command_line(Path(f"/proc/{child}")):
                break
            time.sleep(0.1)
        self.assertNotIn("batch.out/long", self.command_line(Path(f"/proc/{child}")))

    @staticmethod
    def command_line(process):
        try:
            return (process / "cmdline").read_bytes().decode(errors="replace")
        except OSError:
            return ""


class Documents(unittest.TestCase):
    def test_manual_names_every_command_and_option(self):
        page = run("man").stdout
        self.assertTrue(page.startswith(".TH MILLPOSE 1\n"))
        names = re.findall(r"^  (\w+)  ", run("--help").stdout.split("Subcommands:")[1], re.M)
        self.assertIn("schema", names)
        for name in names:
            self.assertIn(f".SS {name}\n", page)
            for option in re.findall(r"--[a-z][a-z-]+", run(name, "--help").stdout):
                self.assertIn(option.replace("-", "\\-"), page, name)
        self.assertEqual([line for line in page.splitlines() if re.match(r"[.'](?!TH|SH|SS|TP|br)", line)], [])

    def test_completion_offers_commands_options_and_files(self):
        def complete(*words):
            script = run("completion").stdout + f"COMP_WORDS=(millpose {' '.join(words)}); COMP_CWORD={len(words)}; " \
                "_millpose; printf '%s\\n' ${COMPREPLY[@]}"
            result = subprocess.run(["bash", "-c", script], capture_output=True, text=True, cwd=TOP, timeout=60)
            self.assertEqual(result.stderr, "")
            return result.stdout.split()

        self.assertEqual(complete("sch"), ["schema"])
        self.assertIn("flatness", complete("''"))
        self.assertIn("--quiet", complete("--qu"))
        self.assertIn("--help", complete("schema", "--"))
        self.assertEqual(complete("flatness", "READ"), ["README.md"])


class CamWithoutPart(InFolder):
    def test_tool_axes_serve_as_normals(self):
        job = JOB.read_text().replace("../../cells", str(TOP / "cells"))
        start, end = job.index("toolpath:"), job.index("process:")
        job = job[:start] + "toolpath: {strategy: cam, cam: {file: path.csv}, spacing_mm: 20}\n" + job[end:]
        (self.folder / "path.csv").write_text("x_mm,y_mm,z_mm,i,j,k\n-30,0,0,0,0,1\n30,0,0,0,0.1,1\n")
        (self.folder / "job.yaml").write_text(job.replace("  mesh: support_pad.stl\n", ""))
        result = run("plan", self.folder / "job.yaml", "-o", self.folder / "out", "--quiet")
        self.assertEqual(result.returncode, 0, result.stderr)
        with (self.folder / "out" / "points.csv").open() as file:
            rows = list(csv.DictReader(file))
        self.assertEqual([row["status"] for row in rows], ["planned"] * 4)
        normals = [[float(row[n]) for n in ("nx", "ny", "nz")] for row in rows]
        cosine = sum(a * b for a, b in zip(normals[0], normals[-1]))
        self.assertAlmostEqual(cosine, 1 / 1.01 ** 0.5, 12, "the axes' angle is that of the normals")
        warnings = json.loads((self.folder / "out" / "summary.json").read_text())["warnings"]
        self.assertTrue(any(w.startswith("no part is given") for w in warnings), warnings)
        result = run("verify", self.folder / "out", "--job", self.folder / "job.yaml")
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        (self.folder / "job.yaml").write_text(JOB.read_text().replace("  mesh: support_pad.stl\n", ""))
        self.assertIn("workpiece.mesh: missing; only strategy cam goes without a part",
                      run("plan", self.folder / "job.yaml").stderr)


class Check(unittest.TestCase):
    def test_sound_mesh_is_described_with_status_0(self):
        result = run("check", f"{TOP}/toolpaths/cabin_ring/cabin_ring.stl")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("1000 x 1000 x 40 mm", result.stdout)
        self.assertIn("1, 1 of them closed", result.stdout)

    def test_doubtful_unit_is_a_finding(self):
        result = run("check", f"{TOP}/toolpaths/cabin_ring/cabin_ring.stl", "--unit", "m", "--json")
        self.assertEqual(result.returncode, 1)
        self.assertIn("1000 times smaller", json.loads(result.stdout)["warnings"][0])

    def test_job_tells_reach_and_gouges(self):
        result = run("check", f"{TOP}/toolpaths/support_pad/job.yaml", "--json", "-q")
        self.assertEqual(result.returncode, 0, result.stderr)
        found = json.loads(result.stdout)
        self.assertEqual(found["reach"]["admissible"], found["points"])
        self.assertEqual(found["gouges"], 0)

    def test_unreadable_mesh_has_status_2(self):
        self.assertEqual(run("check", f"{TOP}/README.md").returncode, 2)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
