#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""A run of `plan`: its files, its progress, what later runs take over from it. Usage: run_test.py MILLPOSE TOP; with MILLPOSE_SLOW=1
also with an audit."""
import csv
import fcntl
import json
import os
import pty
import re
import shutil
import signal
import struct
import subprocess
import sys
import termios
import time
import unittest

from cli_fixture import FEW, JOB, MILLPOSE, TOP, InFolder, plan, run, schema_problems, tree


# A wish that costs 10 s of CPU; its quick twins are the other wishes, and FindExistingPlan.HoldsForTheSameWishesAlone.
AUDITED = [("--audit",)] if os.environ.get("MILLPOSE_SLOW") == "1" else []


def on_a_terminal(columns, *arguments):
    """What stdout gets where it is a terminal so wide, in lines."""
    ours, terminal = pty.openpty()
    fcntl.ioctl(terminal, termios.TIOCSWINSZ, struct.pack("HHHH", 50, columns, 0, 0))
    with subprocess.Popen([MILLPOSE, *map(str, arguments)], stdout=terminal, stderr=subprocess.DEVNULL):
        os.close(terminal)
        text = b""
        while True:
            try:
                piece = os.read(ours, 65536)
            except OSError:  # the program has closed its end
                break
            if not piece:
                break
            text += piece
    os.close(ours)
    return text.decode().splitlines()


class Run(InFolder):
    def test_yaml_to_copy_is_never_broken(self):
        self.assertEqual(on_a_terminal(60, "cells", "kr500_r2830"), run("cells", "kr500_r2830").stdout.splitlines())

    def test_the_last_lines_are_broken_between_words(self):
        out = self.folder / "out"
        arguments = ["plan", JOB, "-o", out, *(word for change in FEW for word in ("--set", change))]
        self.assertEqual(run(*arguments).returncode, 0)
        piped = run(*arguments).stdout.splitlines()
        self.assertGreater(max(map(len, piped)), 120)
        for columns in (80, 120):
            lines = on_a_terminal(columns, *arguments)
            # A word alone may be wider: the report's path.
            self.assertEqual([line for line in lines if len(line) >= columns and " " in line[11:]], [], columns)
            whole = re.sub(r"\n {11}(?! )", " ", "\n".join(lines)).split("\n")
            self.assertEqual(whole, piped, columns)

    def test_no_command_is_wider_than_a_terminal_and_json_stays(self):
        for arguments in (("check", JOB), ("cells",), ("plan", "--help")):
            piped = run(*arguments).stdout
            lines = on_a_terminal(80, *arguments)
            self.assertEqual([line for line in lines if len(line) >= 80 and len(line.split()) > 1], [], arguments)
            self.assertEqual(" ".join(lines).split(), piped.split(), arguments)
        # JSON may be copied: of the lines of its schema, which are longer, none is broken.
        piped = run("schema", "job").stdout.splitlines()
        self.assertGreater(max(map(len, piped)), 80)
        self.assertEqual(on_a_terminal(80, "schema", "job"), piped)

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
        shown_text = run("inspect", self.folder / "out", "--point", 1).stdout
        self.assertIn("digits: branch S, *: chosen", shown_text)
        self.assertIn("why this pose\n  the path has ", shown_text)
        self.assertTrue(shown["reasons"][0].startswith("the path has "))
        self.assertIn("\n  " + shown["reasons"][-1] + "\n", shown_text)
        self.assertIsNone(shown["pose_steps"])
        cell = self.folder / "out" / "cell.yaml"
        text = cell.read_text()
        cell.write_text(text.replace("\ntool:\n", "\ntool:\n  tip_uncertainty_mm: 0.2\n"))
        self.assertNotEqual(cell.read_text(), text)
        steps = json.loads(run("inspect", self.folder / "out", "--point", 1, "--json").stdout)["pose_steps"]
        told = run("inspect", self.folder / "out", "--point", 1).stdout
        self.assertIn("what the tool's own error can leave in the surface here\n  ", told)
        for step in steps:
            self.assertEqual(step["point"], 1)
            self.assertLessEqual(step["height_mm"], 0.4)
            self.assertIn(f"points 1 and {step['other_point']}, rotation", told)
        older = self.folder / "out" / "summary.json"
        older.write_text(older.read_text().replace('"schema_version": 2', '"schema_version": 1'))
        refused = run("inspect", self.folder / "out")
        self.assertEqual(refused.returncode, 2)
        self.assertIn("schema_version: given 1; allowed: 2", refused.stderr)
        self.assertEqual(run("inspect", self.folder / "out", "--point", len(rows)).returncode, 2)
        self.assertEqual(run("inspect", self.folder).returncode, 2)

    def test_damaged_checkpoint_is_found_and_redone(self):
        self.assertEqual(plan(self.folder / "a").returncode, 0)
        before = tree(self.folder / "a")
        for file in (self.folder / "a" / "checkpoints").iterdir():
            data = bytearray(file.read_bytes())
            data[len(data) // 2] ^= 1
            file.write_bytes(data)
        (self.folder / "a" / "manifest.json").unlink()  # else nothing would be planned again
        again = plan(self.folder / "a")
        self.assertRegex(again.stderr, r"passes .* 0 (of them )?from checkpoints")
        self.assertEqual(tree(self.folder / "a"), before)

    def test_a_plan_that_stands_is_not_made_again(self):
        out = self.folder / "a"
        first = plan(out)
        kept, times = tree(out), {file: file.stat().st_mtime_ns for file in out.rglob("*") if file.is_file()}

        def is_kept(*more):
            again = plan(out, *more)
            self.assertEqual(again.returncode, first.returncode, again.stderr)
            unchanged = "unchanged  this plan is up to date; nothing was planned again\n" in again.stdout
            told = [re.sub(r"(?m)^(time|unchanged) .*\n", "", run.stdout) for run in (first, again)]
            if "--audit" not in more:
                self.assertEqual(told[0], told[1])
            return unchanged

        self.assertTrue(is_kept())
        self.assertTrue(is_kept("--threads", "1"))
        self.assertEqual({file: file.stat().st_mtime_ns for file in times}, times)
        for name in ("points.csv", "programs/linuxcnc/support_pad.ngc", "run.json"):
            with open(out / name, "a", encoding="utf-8") as file:
                file.write("x")
            self.assertFalse(is_kept(), name)
            self.assertEqual(tree(out), kept, name)
            self.assertTrue(is_kept(), name)
        (out / "path.vtp").unlink()
        self.assertFalse(is_kept())
        self.assertFalse(is_kept("--fresh"))
        for wish in (("--max-points", "3000"), ("--trajectory", "0.5"), ("--axis-map", "full"), *AUDITED):
            self.assertFalse(is_kept(*wish), wish)
        self.assertTrue(is_kept(*wish))
        self.assertFalse(is_kept())

    def test_changed_parameter_redoes_only_what_depends_on_it(self):
        changes = ("toolpath.stepover_mm=30", "toolpath.spacing_mm=80")

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
        for harmless in ("name=other", "programs=[krl]", "program_options.date=today"):
            self.assertEqual(resumed(harmless), (passes, gaps), harmless)
        self.assertEqual(resumed("gaps.max_iterations=30000"), (passes, 0))
        self.assertEqual(resumed("gaps.retract_mm=60"), (passes, 0))
        kept_passes, kept_gaps = resumed("toolpath.stepover_mm=40")
        self.assertLess(kept_passes, passes)
        self.assertLess(kept_gaps, gaps)
        for deep in ("seed=9", "process.force_direction_deg=15", "limits.margin_deg=3.5", "workpiece.pose.xyz_mm=[2076, 1, 1006]"):
            self.assertEqual(resumed(deep)[0], 0, deep)
        program = MILLPOSE.read_bytes()
        build_id = program.index(b"\x04\0\0\0\x14\0\0\0\x03\0\0\0GNU\0") + 16
        other = self.folder / "other_build"
        other.write_bytes(program[:build_id] + bytes([program[build_id] ^ 1]) + program[build_id + 1:])
        other.chmod(0o755)
        self.assertEqual(resumed(program=other), (0, 0))

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


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
