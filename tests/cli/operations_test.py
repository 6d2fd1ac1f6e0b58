#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Jobs of several operations. Usage: operations_test.py MILLPOSE TOP AUDIT; with MILLPOSE_SLOW=1 the whole sample."""
import csv
import json
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import time
import unittest

from cli_fixture import TOP, InFolder, run, schema_problems
from operations_sample import CELL, FOLDERS, SLOW, small

AUDIT = pathlib.Path(sys.argv[3]).resolve()
CONTROLLERS = ("krl", "sinumerik", "linuxcnc")


def without(text, name):
    """The job without one operation."""
    begin = text.index(f"  - name: {name}\n")
    end = min(at for at in (text.find("  - name:", begin + 1), text.find("programs:", begin)) if at > 0)
    return text[:begin] + text[end:]


def rows(path):
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


class Operations(InFolder):
    def setUp(self):
        super().setUp()
        self.out = self.folder / "out"
        (self.folder / "cell.yaml").write_text(CELL)

    def plan(self, text, *arguments, out=None):
        (self.folder / "job.yaml").write_text(text)
        return run("plan", self.folder / "job.yaml", "-o", out or self.out, "-q", *arguments)

    kept = {}  # folders with a plan, by the job's text: planned for the first test that asks, copied for the others

    def planned(self, text):
        """Job, cell and results of `text` in this test's folder; how `plan` ended and how long one thread took."""
        if text not in Operations.kept:
            folder = tempfile.TemporaryDirectory()
            self.addClassCleanup(folder.cleanup)
            top = pathlib.Path(folder.name)
            (top / "cell.yaml").write_text(CELL)
            (top / "job.yaml").write_text(text)
            begun = time.monotonic()
            ended = run("plan", top / "job.yaml", "-o", top / "out", "-q", "--threads", "1")
            Operations.kept[text] = top, ended, time.monotonic() - begun
        top, ended, seconds = Operations.kept[text]
        self.assertEqual(ended.returncode, 0, ended.stdout + ended.stderr)
        shutil.copytree(top, self.folder, dirs_exist_ok=True)
        return ended, seconds

    def results(self, out=None):
        out = out or self.out
        return {str(path.relative_to(out)): path.read_bytes() for path in sorted(out.rglob("*"))
                if path.is_file() and path.name != "run.json" and "checkpoints" not in path.parts}

    def test_the_way_from_the_job_to_the_main_programs(self):
        planned, _ = self.planned(small())
        for controller in CONTROLLERS:
            self.assertIn(f"programs/{controller}: calls 3 programs, read back and confirmed", planned.stdout)
        self.assertIn("<title>trim_window – millpose</title>", (self.out / "operations" / FOLDERS[1] / "report.html").read_text())
        told = planned.stdout.splitlines()
        self.assertLessEqual(len(told), 12, planned.stdout)
        self.assertRegex(told[0], r"^done       \w+ on \w+: (\d+) of \1 points in 3 operations$")
        self.assertRegex(told[-1], r"^report     \S+/report\.html$")
        verified = run("verify", self.out)
        self.assertEqual(verified.returncode, 0, verified.stdout + verified.stderr)
        self.assertRegex(verified.stdout, r"krl +0 motions  confirmed .*/out/programs/krl\n")
        for folder in FOLDERS:  # each is an output folder as any other, for the independent judge as well
            judged = subprocess.run([AUDIT, self.out / "operations" / folder, "--inputs", self.folder, "--travel-mm", "2" if SLOW else "10"],
                                    capture_output=True, text=True, timeout=600)
            self.assertEqual(judged.returncode, 0, judged.stdout[-2000:] + judged.stderr)
        self.check_summary()
        self.check_points()
        self.check_calls()
        self.check_report()

    def check_summary(self):
        text = (self.out / "summary.json").read_text()
        self.assertEqual(schema_problems("operations-summary", json.loads(text)), [])
        summary = json.loads(text)
        own = [json.loads((self.out / "operations" / folder / "summary.json").read_text()) for folder in FOLDERS]
        self.assertEqual([operation["summary"] for operation in summary["operations"]], own)
        self.assertEqual([operation["tool"] for operation in summary["operations"]], ["mill_d20", "mill_d20", "drill_d5"])
        self.assertEqual([s["budget"] is None for s in own], [False, False, True])  # drilled holes are no face
        self.assertEqual(summary["points"]["total"], sum(s["points"]["total"] for s in own))
        self.assertEqual(summary["clearance_min_mm"], min(s["clearance_min_mm"] for s in own))
        self.assertEqual(summary["stiffness"]["lambda_n"]["worst"], max(s["stiffness"]["lambda_n"]["worst"] for s in own))
        for cycle in summary["cycle_times"]:
            parts = [times["total_s"] for s in own for times in s["cycle_times"] if times["controller"] == cycle["controller"]]
            self.assertAlmostEqual(cycle["total_s"], sum(parts))

    def check_points(self):
        points = rows(self.out / "points.csv")
        own = [(folder[3:], row) for folder in FOLDERS for row in rows(self.out / "operations" / folder / "points.csv")]
        self.assertEqual([(point.pop("operation"), point) for point in points], own)

    def check_calls(self):
        """Programs and their calls, text by text."""
        programs = self.out / "programs"
        for controller, main, ending in (("krl", ".src", ".src"), ("sinumerik", ".mpf", ".spf"), ("linuxcnc", ".ngc", ".ngc")):
            text = (programs / controller / f"cabin_window{main}").read_text()
            calls = re.findall(r"^(?:O<)?(\w+_[0-9a-z]{5})(?: \( \)|> CALL|)$", text, re.M)
            self.assertEqual([name[:-6] for name in calls], ["face_pads", "trim_window", "drill_holes"])
            self.assertEqual(len({name[-5:] for name in calls}), 3, "each has a hash of its own")
            for folder, name in zip(FOLDERS, calls):
                own = (self.out / "operations" / folder / "programs" / controller / (name + main)).read_text()
                called = (programs / controller / (name + ending)).read_text()
                if controller == "sinumerik":
                    called = called.removesuffix("M17\n") + "M30\n"
                if controller == "linuxcnc":
                    called = called.removeprefix(f"O<{name}> SUB\n").removesuffix(f"O<{name}> ENDSUB\n") + "M2\n"
                self.assertEqual(called, own)

    def check_report(self):
        """As text; operations_browser_test.py opens it."""
        text = (self.out / "report.html").read_text()
        tabs = re.findall(r'<button role="tab" data-report="([^"]+)">([^<]+)</button>', text)
        self.assertEqual(tabs, [(f"operations/{folder}/report.html", folder[3:]) for folder in FOLDERS])
        self.assertEqual(re.findall(r'<a href="([^"]+)">([^<]+)</a>', text), tabs)
        for path, _ in tabs:
            self.assertTrue((self.out / path).is_file(), path)
        self.assertEqual(re.findall(r"\b(?:https?:|url\(|@import|src=)", text), [], "it loads nothing else")

    @unittest.skipUnless(shutil.which("rs274"), "LinuxCNC's interpreter is not installed")
    def test_the_interpreter_runs_the_whole_main_program(self):
        self.planned(small())
        (self.folder / "machine.ini").write_text(f"[RS274NGC]\nSUBROUTINE_PATH={self.out / 'programs' / 'linuxcnc'}\n[EMC]\n")

        def interpreted(program, before=""):
            (self.folder / "alone.ngc").write_text(before + program.read_text())
            program = self.folder / "alone.ngc"
            result = subprocess.run(["rs274", "-g", "-i", self.folder / "machine.ini", program], cwd=self.folder, capture_output=True,
                                    text=True, timeout=120, env={"HOME": str(self.folder)})
            self.assertEqual(result.returncode, 0, result.stdout[-500:] + result.stderr)
            return re.findall(r"N\.+ ((?:STRAIGHT|CHANGE_TOOL|START_SPINDLE|PROGRAM_).*)", result.stdout)

        whole = interpreted(self.out / "programs" / "linuxcnc" / "cabin_window.ngc")
        parts = []
        for folder in FOLDERS:
            program = next((self.out / "operations" / folder / "programs" / "linuxcnc").glob(f"{folder[3:]}_*.ngc"))
            held = "tool_held" in program.read_text()  # by whatever ran before it
            parts += interpreted(program, "T1 M6\n" if held else "")[1 if held else 0:]
        self.assertEqual(whole[-1], "PROGRAM_END()")
        self.assertEqual(whole[:-1], [line for line in parts if line != "PROGRAM_END()"])
        self.assertEqual([line for line in whole if line.startswith("CHANGE")], ["CHANGE_TOOL(1)", "CHANGE_TOOL(2)"])

    def test_a_tool_that_is_held_is_compared_and_not_changed(self):
        """The second operation has the first one's tool, the third another."""
        (self.folder / "cell.yaml").write_text(CELL.replace("  krl:\n", "  krl:\n    tool_in_spindle: SPINDLE_TOOL\n"))
        planned = self.plan(small())
        self.assertEqual(planned.returncode, 0, planned.stdout + planned.stderr)
        changes = {"krl": r"\nHALT\nWAIT SEC 0\nWHILE SPINDLE_TOOL<>", "sinumerik": r"\nM6\nMP_TOOL:", "linuxcnc": r"\nT\d M6\nO9001 WHILE"}
        checks = {"krl": r"WHILE SPINDLE_TOOL<>1\n", "sinumerik": r'\nD1\nMP_TOOL:\nSTOPRE\nIF \$TC_TP2.*=="mill_d20" GOTOF', "linuxcnc": r"O9001 WHILE \[#5400 NE 1\]"}
        for controller in CONTROLLERS:
            texts = {}
            for folder in FOLDERS:
                (main,) = [file for file in self.main_texts(folder, controller) if re.search(rf"tool_held:|{changes[controller]}", file.read_text())]
                texts[folder] = main.read_text()
            changed = [bool(re.search(changes[controller], text)) for text in texts.values()]
            self.assertEqual(changed, [True, False, True], controller)
            held = texts[FOLDERS[1]]
            self.assertRegex(held, r"tool_held: the operation before leaves it")
            self.assertRegex(held, checks[controller])
            self.assertIsNone(re.search(r"PTP \{A1 60,|RA1=60\.0+ |G0 X60\.0", held), "the arm does not go to the change")
        self.assertEqual(run("verify", self.out).returncode, 0)
        self.check_held_alone()

    def main_texts(self, folder, controller):
        programs = self.out / "operations" / folder / "programs" / controller
        return [file for file in sorted(programs.iterdir()) if file.suffix in (".src", ".mpf", ".spf", ".ngc")]

    def check_held_alone(self):
        """A program alone says itself that its tool is held; one that says so and changes the tool is refused."""
        for controller in CONTROLLERS:
            told = {}
            for folder in FOLDERS[0 if controller == "linuxcnc" else 1:2]:
                (file,) = [file for file in self.main_texts(folder, controller) if re.search(r"(?m)^[;(] ?tool: ", file.read_text())]
                verified = run("verify", file, "--cell", self.folder / "cell.yaml", "--tool", "mill_d20")
                told[folder] = [line for line in (verified.stdout + verified.stderr).splitlines() if re.search(r"SPINDLE_TOOL|MP_TOOL|5400|tool_change", line)]
                self.assertIn(verified.returncode, (0, 1), verified.stderr)
                text = file.read_text()
                file.write_text(text.replace("tool_held:", "tool_hold:") if "tool_held" in text else re.sub(r"(?m)^([;(] ?)tool: ", r"\1tool_held: x\n\1tool: ", text, count=1))
                swapped = run("verify", file, "--cell", self.folder / "cell.yaml", "--tool", "mill_d20")
                file.write_text(text)
                self.assertNotEqual((verified.returncode, verified.stdout, verified.stderr), (swapped.returncode, swapped.stdout, swapped.stderr), (controller, folder))
            self.assertEqual(told, {folder: [] for folder in told}, controller)

    def test_the_spindle_stands_where_the_tool_is_changed(self):
        self.planned(small())
        for controller, on, off, change in (("krl", r"\$OUT\[1\]=TRUE", r"\$OUT\[1\]=FALSE", "put it in"),
                                            ("sinumerik", r"\bM3\b", r"\bM5\b", r"\bM6\b"), ("linuxcnc", r"\bM3\b", r"\bM5\b", r"\bM6\b")):
            folder = self.out / "programs" / controller
            text = "".join(path.read_text() for path in sorted(folder.iterdir()) if re.search(r"_[0-9a-z]{5}\.(?!dat)\w+$", path.name))
            if controller != "krl":  # whose change of the tool is told to a person
                text = re.sub(r"\([^)\n]*\)|;.*", "", text)
            order = re.findall(f"({on})|({off})|({change})", text)
            held = [2, 0, 1] if controller == "krl" else [0, 1]  # trim_window, by its name the last, has its tool already
            expected = [2, 0, 1] * 2 + held
            self.assertEqual([next(i for i, word in enumerate(words) if word) for words in order], expected, controller)

    def test_same_bytes_for_any_number_of_threads_and_nothing_is_planned_twice(self):
        self.assertEqual(self.plan(small(), "--threads", "1").returncode, 0)
        two = self.folder / "two"
        self.assertEqual(self.plan(small(), "--threads", "2", out=two).returncode, 0)
        self.assertEqual(self.results(), self.results(two))
        again = run("plan", self.folder / "job.yaml", "-o", self.out)
        self.assertEqual(again.returncode, 0)
        self.assertNotIn("face_pads: passes", again.stderr, "its plan stands")
        resolved = run("plan", self.out / "job.yaml", "-q")
        self.assertEqual(resolved.returncode, 0, resolved.stderr)
        self.assertEqual(self.results(), self.results(two))
        # An operation that is gone takes its folder along; the others stand.
        fewer = self.plan(without(small(), "trim_window"))
        self.assertEqual(fewer.returncode, 0, fewer.stderr)
        self.assertEqual(sorted(path.name for path in (self.out / "operations").iterdir()), ["01_face_pads", "02_drill_holes"])
        self.assertEqual(run("verify", self.out).returncode, 0)

    def test_a_job_that_has_no_operations_any_more_leaves_none(self):
        text = without(without(small(), "trim_window"), "drill_holes")
        self.assertEqual(self.plan(text).returncode, 0)
        several = run("inspect", self.out, "--point", "0")
        self.assertEqual(several.returncode, 2)
        self.assertIn("holds several operations", several.stderr)
        _, own = text[:text.index("programs:")].split("  - name: face_pads\n")
        single = text[:text.index("process: {")] + re.sub("^    ", "", own, flags=re.M).replace("process:\n", "process:\n  spindle_rpm: 7000\n")
        self.assertEqual(self.plan(single).returncode, 0)
        self.assertFalse((self.out / "operations").exists())
        (self.out / "operations" / "01_face_pads").mkdir(parents=True)  # as a run leaves it that was ended before it tidied up
        for command in (("inspect", self.out, "--point", "0"), ("verify", self.out)):
            self.assertEqual(run(*command).returncode, 0, command)

    def test_operations_are_one_set_with_their_job(self):
        text = without(small(), "trim_window").replace("programs: [krl, sinumerik, linuxcnc]", "programs: [krl]")
        (self.folder / "job.yaml").write_text(text)
        batch = ("batch", self.folder / "job.yaml", "-o", self.folder / "batch")
        self.assertEqual(run(*batch).returncode, 0)
        out = self.folder / "batch" / "cabin_window"
        whole = self.results(out)
        self.assertIn("up to date", run(*batch).stdout)
        names = {file["path"] for file in json.loads((out / "manifest.json").read_text())["files"]}
        self.assertLessEqual({f"operations/{folder}/{file}" for folder in ("01_face_pads", "02_drill_holes")
                              for file in ("manifest.json", "plan.cbor.gz", "job.yaml")}, names)

        def edit(path):
            path.write_text(path.read_text() + " ")

        first = out / "operations" / "01_face_pads"
        for change in (lambda: edit(next((first / "programs" / "krl").glob("*.src"))), lambda: edit(first / "summary.json"),
                       lambda: (first / "run.json").write_text("{}"), lambda: shutil.rmtree(out / "operations"), lambda: shutil.rmtree(first)):
            change()
            again = run(*batch)
            self.assertEqual(again.returncode, 0, again.stdout)
            self.assertNotIn("up to date", again.stdout)
            self.assertEqual(self.results(out), whole)
        planned = run("plan", self.folder / "job.yaml", "-o", out)
        self.assertIn("this plan is up to date", planned.stdout)
        alone = run("plan", first / "job.yaml")
        self.assertEqual(alone.returncode, 2)
        self.assertIn("is of one operation of the job whose folder is", alone.stderr)
        self.assertEqual(self.results(out), whole)

    def test_what_is_left_out_and_why(self):
        planned = self.plan(without(small(), "trim_window"), "--set", "workpiece.pose.xyz_mm=[3100,0,1200]", "-v")
        self.assertEqual(planned.returncode, 1)
        self.assertRegex(planned.stdout, r"skipped    face_pads: %s unreachable\n" % (80 if SLOW else 7))

    def test_a_share_of_the_passes_is_planned_and_taken_up(self):
        text = without(small(), "trim_window")
        (self.folder / "job.yaml").write_text(text)
        for k in ("1/2", "2/2"):
            shared = run("plan", self.folder / "job.yaml", "-o", self.out, "-q", "--share", k)
            self.assertEqual(shared.returncode, 0, shared.stderr)
            self.assertIn("operation drill_holes: share", shared.stdout)
        self.assertFalse((self.out / "summary.json").exists())
        self.assertEqual(self.plan(text).returncode, 0)
        shared = self.out.rename(self.folder / "shared")
        self.planned(text)
        self.assertEqual(self.results(shared), self.results())

    def test_a_killed_run_goes_on_to_the_same_bytes(self):
        text = without(small(), "trim_window")
        _, seconds = self.planned(text)
        killed, whole = self.folder / "killed", self.results()
        for part in range(1, 21 if SLOW else 4):
            process = subprocess.Popen([sys.argv[1], "plan", self.folder / "job.yaml", "-o", killed, "-q", "--threads", "1"],
                                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            time.sleep(seconds * part / (21 if SLOW else 4))
            process.kill()
            process.wait()
            self.assertEqual(self.plan(text, out=killed).returncode, 0)
            self.assertEqual(self.results(killed), whole)
            shutil.rmtree(killed)

    def test_what_stands_until_a_later_operation_takes_it_off_is_known_before(self):
        face = "rotation_reference: [0, 0, 1]        # in the world; the rotation about the tool axis counts from here\n"
        text = small().replace(face, face + "      depth: {total_mm: 3, per_layer_mm: 1.5}\n", 1).replace(", depth_mm: 1}", "}", 1)
        first = text.index("  - name: face_pads")
        second, last = text.index("  - name: trim_window"), text.index("programs: [krl")
        text = text[:first] + text[second:last] + text[first:second] + text[last:]
        self.assertEqual(self.plan(text).returncode, 0)
        allowances = [re.search(r"allowance_mm: ([\d.]+)", (folder / "job.yaml").read_text().split("toolpath:")[0])
                      for folder in sorted((self.out / "operations").iterdir())]
        self.assertEqual([found and found.group(1) for found in allowances], ["3", "3", None])

    def test_a_program_that_is_not_confirmed_withholds_the_main_program(self):
        thick = CELL.replace("      - {name: spindle, class: spindle, length_mm: 320, diameter_mm: 160}\n  - name",
                             "      - {name: big, class: holder, length_mm: 400, diameter_mm: 3000}\n  - name", 1)
        (self.folder / "cell.yaml").write_text(thick)
        planned = self.plan(without(without(small(), "trim_window"), "face_pads").replace("spindle_rpm: 7000, ", ""))
        self.assertEqual(planned.returncode, 1, planned.stderr)
        self.assertIn("no krl main program is written: operation drill_holes has no krl program", planned.stdout)
        self.assertFalse((self.out / "programs").exists())

    def test_damage_to_a_whole_program_is_seen(self):
        self.planned(without(small(), "trim_window"))
        path = self.out / "programs" / "krl" / "cabin_window.src"
        before = path.read_text()
        calls = re.findall(r"(?m)^(\w+) \( \)$", before)
        self.assertEqual(len(calls), 2)
        path.write_text(before.replace(calls[1] + " ( )\n", ""))
        for arguments in ((self.out,), (path, "--plan", self.out)):
            seen = run("verify", *arguments)
            self.assertEqual(seen.returncode, 1, seen.stderr)
            self.assertIn(f"calls {calls[0]}; expected: {calls[0]}, {calls[1]}", seen.stdout)
        path.write_text("; by hand\n" + before)
        self.assertEqual(run("verify", self.out).returncode, 0)
        path.write_text(before)
        data = path.with_suffix(".dat")
        was = data.read_text()
        data.write_text("rubbish\n")
        self.assertEqual(run("verify", self.out).returncode, 1)
        data.write_text(was)
        # A called program that was edited is held against its operation's plan.
        called = path.with_name(calls[0] + ".src")
        program = called.read_text()
        called.write_text(program.replace("\n", "\r\n"))
        seen = run("verify", self.out)
        self.assertEqual(seen.returncode, 0, seen.stdout)
        self.assertIn("changed since, still as planned", seen.stdout)
        called.write_text(program.replace("\nEND\n", "\nHALT\nEND\n"))
        self.assertEqual(run("verify", self.out).returncode, 1)
        called.write_text(program)
        # By file: the main program, and what it calls, of every controller.
        for controller, ending in (("krl", ".src"), ("sinumerik", ".mpf"), ("linuxcnc", ".ngc")):
            main = self.out / "programs" / controller / ("cabin_window" + ending)
            for arguments in (("--cell", self.folder / "cell.yaml"), ("--plan", self.out)):
                seen = run("verify", main, *arguments)
                self.assertEqual(seen.returncode, 0, seen.stdout + seen.stderr)
            for file in sorted(main.parent.iterdir()):
                if file == main or file.suffix not in (ending, ".spf"):
                    continue
                seen = run("verify", file, "--plan", self.out)
                self.assertEqual(seen.returncode, 0, seen.stdout + seen.stderr)
        # A main folder that is gone is missed.
        shutil.rmtree(self.out / "programs" / "krl")
        self.assertEqual(run("verify", self.out).returncode, 2)

    def test_check_looks_at_each_as_plan_does(self):
        (self.folder / "job.yaml").write_text(small())
        page = self.folder / "pages" / "check.html"
        page.parent.mkdir()
        told = run("check", self.folder / "job.yaml", "--view", page, "-q")
        self.assertLess(told.returncode, 2, told.stderr)
        pages = [f"check_{folder}.html" for folder in FOLDERS]
        self.assertEqual(re.findall(r"^page +\S+/(\S+)$", told.stdout, re.M), pages)
        self.assertEqual(sorted(path.name for path in page.parent.iterdir()), pages)
        found = json.loads(run("check", self.folder / "job.yaml", "--json", "-q").stdout)["operations"]
        self.assertEqual([f"{i + 1:02}_{one['operation']}" for i, one in enumerate(found)], list(FOLDERS))
        self.planned(small())
        for one, folder in zip(found, FOLDERS, strict=True):
            planned = json.loads((self.out / "operations" / folder / "summary.json").read_text())
            # A plan may put points between those that are laid (PlanFiner).
            self.assertLessEqual(one["points"], planned["points"]["total"])
            self.assertEqual(one["reach"]["admissible"], one["points"])
            self.assertEqual(planned["points"]["planned"], planned["points"]["total"])
            self.assertIn(f"\noperation           {folder[3:]}\n", told.stdout)
        moved = run("check", self.folder / "job.yaml", "--view", page, "-q")
        self.assertEqual(moved.stdout, told.stdout)
        (self.folder / "job.yaml").write_text(small().replace("peck_mm: 4", "peck_mm: -4").replace("stepover_mm", "stepovr_mm"))
        wrong = run("check", self.folder / "job.yaml", "--view", self.folder / "none.html")
        self.assertEqual(wrong.returncode, 2)
        self.assertRegex(wrong.stderr, r"stepovr_mm(.|\n)*peck_mm: given -4")
        self.assertEqual([path.name for path in self.folder.glob("none*")], [])

    def test_what_is_wrong_in_any_operation_is_told_at_once_with_its_place(self):
        wrong = small().replace("stepover_mm", "stepovr_mm").replace("peck_mm: 4", "peck_mm: -4").replace("tool: drill_d5", "tool: drill_d6")
        told = self.plan(wrong)
        self.assertEqual(told.returncode, 2)
        self.assertRegex(told.stderr, r"job\.yaml:\d+:7: toolpath\.stepovr_mm: unknown key; nearest known key: stepover_mm")
        self.assertRegex(told.stderr, r"job\.yaml:\d+:\d+: toolpath\.drill\.peck_mm: given -4")
        self.assertFalse(self.out.exists(), "nothing half-written")
        told = self.plan(small().replace("tool: drill_d5", "tool: drill_d6"))
        line = small().splitlines().index("    tool: drill_d5") + 1
        self.assertRegex(told.stderr, rf"job\.yaml:{line}:\d+: tool: given drill_d6; .*did you mean drill_d5\?")
        self.assertFalse(self.out.exists())
        for change, said in (
            (("  - name: trim_window", "  - name: face_pads"), r"operations\[1\]\.name: given face_pads twice"),
            (("process: {spindle", "process: {feed_mm_min: 500, spindle"), r"job\.yaml:\d+:11: process\.feed_mm_min has no effect here: every operation has"),
            (("operations:\n", "tool: mill_d20\noperations:\n"), r"job\.yaml:\d+:1: tool has no effect here"),
            (("  - name: trim_window", "  - name: trim-window"), r"operations\[1\]\.name: given trim-window; allowed: letters, digits"),
            (("  - name: trim_window\n    tool", "  - tool"), r"operations\[1\]\.name: missing"),
            (("    tool: drill_d5\n", "    tool: drill_d5\n    programs: [krl]\n"), r"operations\[2\]\.programs: unknown key"),
            (("process: {spindle_rpm: 7000, retract_feed_mm_min: 2000}", "process: {spindle_rpm: x}"), r"process\.spindle_rpm: given x"),
        ):
            with self.subTest(said):
                told = self.plan(small().replace(*change))
                self.assertEqual(told.returncode, 2, told.stdout)
                self.assertRegex(told.stderr, said)
                self.assertEqual(len(re.findall(said, told.stderr)), 1, "reported once")
        for operations in ("[]", "face", "[1]"):
            told = self.plan(re.sub(r"operations:\n(.*\n)*programs", f"operations: {operations}\nprograms", small()))
            self.assertEqual(told.returncode, 2)
            self.assertRegex(told.stderr, r"operations(\[0\])?: given")

    def test_a_batch_takes_it_as_any_job(self):
        (self.folder / "job.yaml").write_text(without(small(), "trim_window"))
        out = self.folder / "all"
        for up_to_date in (False, True):
            done = run("batch", self.folder / "job.yaml", "-o", out, "-q")
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
            job = json.loads((out / "batch.json").read_text())["jobs"][0]
            self.assertEqual((job["name"], job["up_to_date"]), ("cabin_window", up_to_date))
            self.assertEqual(job["points"], job["planned"])
            self.assertGreater(job["figures"]["cycle_s"], 0)

    def test_where_one_operation_is_wanted_the_answer_is_its_folder(self):
        self.planned(without(small(), "trim_window"))
        for command in (("inspect", self.out), ("inspect", self.out, "--point", "3")):
            told = run(*command)
            self.assertEqual(told.returncode, 2)
            self.assertRegex(told.stderr, r"operations/01_face_pads")
        self.assertEqual(run("inspect", self.out / "operations" / "01_face_pads", "--point", "3").returncode, 0)

    @unittest.skipUnless(SLOW, "the quick twins are the tests of cabin_trim and cabin_holes")
    def test_the_window_is_that_of_cabin_trim_and_the_holes_those_of_cabin_holes(self):
        self.assertEqual(self.plan(small()).returncode, 0)
        for sample, folder, count in (("cabin_trim", "02_trim_window", None), ("cabin_holes", "03_drill_holes", 106)):
            alone = self.folder / sample
            self.assertEqual(run("plan", TOP / "toolpaths" / sample / "job.yaml", "-o", alone, "-q").returncode, 0)
            places = [[tuple(row[c] for c in ("x_mm", "y_mm", "z_mm")) for row in rows(path / "points.csv")]
                      for path in (self.out / "operations" / folder, alone)]
            self.assertLessEqual(set(places[0]), set(places[1]))


if __name__ == "__main__":
    unittest.main(argv=[__file__], verbosity=2)
