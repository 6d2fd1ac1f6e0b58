#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""How `batch` is called: manifests, folders, patterns, Slurm, interrupts. Usage: batch_calls_test.py MILLPOSE TOP"""
import json
import os
import shutil
import signal
import subprocess
import sys
import time
import unittest
import xml.etree.ElementTree as xml
from pathlib import Path

from cli_fixture import JOB, MILLPOSE, TOP, InFolder, plan, run, schema_problems, tree


class BatchCalls(InFolder):
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

    def test_a_job_that_starts_alone_takes_all_threads_and_progress_names_it(self):
        def batch(seed, *options):
            few = "toolpath.stepover_mm: 40, toolpath.spacing_mm: 40"
            (self.folder / "batch.yaml").write_text("millpose_batch: 1\njobs:\n" + "".join(
                f"  - {{job: {JOB}, name: {name}, set: {{{few}, seed: {number}}}}}\n"
                for name, number in (("a", 1), ("b", seed))))
            result = run("batch", "batch.yaml", "--threads", 4, "--parallel", 2, *options, cwd=self.folder)
            self.assertEqual(result.returncode, 0, result.stderr)
            return [json.loads((self.folder / "batch.out" / name / "run.json").read_text())["threads"]
                    for name in ("a", "b")], result
        self.assertEqual(batch(2)[0], [2, 2])
        threads, result = batch(3, "--json-progress")
        self.assertEqual(threads, [2, 4], "a is up to date")
        lines = [json.loads(line) for line in result.stderr.splitlines()]
        for line in lines:
            self.assertEqual(schema_problems("progress", line), [], line)
        self.assertLessEqual({line["doing"] for line in lines}, {None, "b"})

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

    def test_a_baseline_shows_what_has_changed(self):
        def batch(out, more, *words):
            (self.folder / "batch.yaml").write_text("millpose_batch: 1\njobs:\n" + "".join(
                f"  - {{job: {JOB}, name: {name}, set: {{toolpath.stepover_mm: 40, toolpath.spacing_mm: 40{change}}}}}\n"
                for name, change in more))
            return run("batch", "batch.yaml", "-o", out, *words, cwd=self.folder)

        self.assertEqual(batch("old", [("a", ""), ("b", "")]).returncode, 0)
        now = batch("now", [("a", ""), ("b", ", process.feed_mm_min: 8, gaps.retract_mm: 5"), ("c", "")], "--baseline", "old")
        self.assertLess(now.returncode, 2, now.stderr)
        jobs = json.loads((self.folder / "now" / "batch.json").read_text())["jobs"]
        self.assertEqual(jobs[0]["remarks"], [])
        self.assertIn("baseline: settings   process.feed_mm_min: 80 -> 8", jobs[1]["remarks"])
        self.assertIn("baseline: settings   gaps.retract_mm: 50 -> 5", jobs[1]["remarks"])
        self.assertIn("baseline: points     6 points have another feed", jobs[1]["remarks"])
        self.assertEqual(jobs[2]["remarks"], ["baseline: has no plan of this job"])
        for page in ("index.html", "junit.xml"):
            self.assertIn("has no plan of this job", (self.folder / "now" / page).read_text())
        refused = batch("now", [("a", "")], "--baseline", "nowhere")
        self.assertEqual(refused.returncode, 2)
        self.assertIn("nowhere: is no output folder of millpose", refused.stderr)

    def test_it_finds_its_own_program_where_there_is_no_proc(self):
        bare = ["unshare", "--mount", "sh", "-c", 'mount -t tmpfs none /proc && exec "$@"', "sh"]
        if subprocess.run([*bare, "true"], capture_output=True).returncode != 0:
            self.skipTest("may not hide /proc here")
        (self.folder / "batch.yaml").write_text(
            f"millpose_batch: 1\njobs:\n  - {{job: {JOB}, set: {{toolpath.stepover_mm: 40, toolpath.spacing_mm: 40}}}}\n")
        result = subprocess.run([*bare, MILLPOSE, "batch", "batch.yaml"], capture_output=True, text=True, cwd=self.folder)
        self.assertIn("1 jobs: 1 done", result.stdout, result.stderr)

    def slurm(self, **more):
        """A folder with a batch of two jobs, and the environment in which sbatch and squeue are fakes."""
        (self.folder / "batch.yaml").write_text("millpose_batch: 1\njobs:\n" + "".join(
            f"  - {{job: {JOB}, name: {name}, {more}set: {{toolpath.stepover_mm: 30, toolpath.spacing_mm: 80}}}}\n"
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
                              changes=("toolpath.stepover_mm=30", "toolpath.spacing_mm=80")).returncode, 0)
        self.assertEqual(tree(self.folder / "batch.out" / "a"), tree(self.folder / "single"))
        resumed = json.loads((self.folder / "batch.out" / "a" / "run.json").read_text())["resumed_passes"]
        self.assertEqual(resumed, 3, "the last task only gathers")
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

    def test_an_answer_of_slurm_that_is_no_job_id_is_an_error_once(self):
        env = self.slurm()
        (self.folder / "sbatch").unlink()
        for answer in ("", "Submitted batch job 17", "17 queued", "17\n18", "a maintenance is on\x1b[2J"):
            (self.folder / "answer").write_text(answer)
            (self.folder / "sbatch").write_text(f"#!/bin/sh\necho call >> {self.folder}/calls\ncat {self.folder}/answer\n")
            (self.folder / "sbatch").chmod(0o755)
            (self.folder / "calls").unlink(missing_ok=True)
            for detach in ((), ("--detach",)):
                result = run("batch", "batch.yaml", "--slurm", *detach, "-q", cwd=self.folder, env=env)
                self.assertEqual(result.returncode, 2, answer)
                shown = answer.replace("\n", "?").replace("\x1b", "?")
                self.assertEqual(result.stderr, f'millpose: sbatch: answered "{shown}", which is no job id; allowed: what '
                                                "sbatch --parsable prints, like 4711 or 4711;cluster\n")
            self.assertEqual((self.folder / "calls").read_text(), "call\n" * 2, "asked once by each")
        self.assertEqual(list(self.folder.rglob("submitted")), [])

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


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
