#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The frame of the real millpose: help, usage, schemas, manual, check, verify. Usage: cli_test.py MILLPOSE TOP"""
import csv
import json
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

from cli_fixture import JOB, MILLPOSE, TOP, InFolder, plan, run, without_force


class Frame(unittest.TestCase):
    def test_version_and_help_go_to_stdout_with_status_0(self):
        self.assertEqual(run("-V").stdout, run("--version").stdout)
        self.assertEqual(run("help").stdout, run("--help").stdout)
        self.assertEqual(run("help", "plan").stdout, run("plan", "--help").stdout)
        self.assertIn("unknown command paln; nearest: plan", run("help", "paln").stderr)
        self.assertRegex(run("--version").stdout, r"^millpose \d+\.\d+\.\d+\n$")
        for arguments in (("--help",), ("plan", "--help"), ("batch", "--help"), ("inspect", "--help")):
            result = run(*arguments)
            self.assertEqual(result.returncode, 0)
            self.assertIn("Usage: millpose", result.stdout)
            self.assertEqual(result.stderr, "")
        self.assertIn("Exit status: 0 done", re.sub(r"\s+", " ", run("--help").stdout))

    def test_help_fits_a_terminal_of_80_columns(self):
        commands = re.findall(r"^  ([a-z]+)  ", run("--help").stdout.split("Subcommands:")[1], re.M)
        self.assertGreater(len(commands), 15)
        for command in ([], *([name] for name in commands)):
            text = run(*command, "--help").stdout
            # A line of one word cannot be broken; names of options stand by themselves.
            self.assertEqual([line for line in text.splitlines() if len(line) > 79 and not line.startswith("  -")], [], command)

    def test_usage_errors_go_to_stderr_with_status_2(self):
        for arguments in ((), ("paln",), ("schema",), ("schema", "robot"), ("--no-such-option",), ("plan",),
                          ("plan", JOB, "--threads", "-1"), ("plan", JOB, "--set", "seed"), ("inspect",)):
            result = run(*arguments)
            self.assertEqual(result.returncode, 2, arguments)
            self.assertEqual(result.stdout, "", arguments)
            self.assertNotEqual(result.stderr, "", arguments)

    def test_mistyped_option_is_answered_with_the_nearest(self):
        for arguments, words in ((("plan", JOB, "--thread", "2"), "option --thread is not known to millpose plan; nearest: --threads"),
                                 (("inspect", "x", "y"), "argument y is not known to millpose inspect; millpose inspect --help"),
                                 (("init", "part.stl", "out"), "argument out is not known to millpose init; is it meant as --out out?"),
                                 (("plan", JOB, "b.yaml"), "argument b.yaml is not known to millpose plan; millpose plan --help"),
                                 (("verify",), "millpose: DIR|PROGRAM is required; millpose verify --help"),
                                 (("inspect", TOP), "holds no points.csv; allowed: a folder that millpose plan wrote")):
            result = run(*arguments)
            self.assertEqual((result.returncode, result.stdout), (2, ""))
            self.assertIn(words, result.stderr)

    def test_mistyped_command_is_answered_with_the_nearest(self):
        self.assertIn("unknown command paln; nearest: plan", run("paln", "job").stderr)
        self.assertIn("what is required", run("schema").stderr)


class Cells(unittest.TestCase):
    def test_every_cell_of_the_project_is_listed_and_printed_as_it_is(self):
        files = {path.stem: path for path in (TOP / "cells").glob("*.yaml")}
        cells = {cell["name"]: cell for cell in json.loads(run("cells", "--json").stdout)["cells"]}
        self.assertEqual(sorted(cells), sorted(files))
        text = run("cells").stdout
        for name, file in files.items():
            yaml = file.read_text(encoding="utf-8")
            self.assertEqual(run("cells", name).stdout, yaml)
            self.assertIn(name, text)
            self.assertIn(f"name: {cells[name]['arm']}\n", yaml)
            for tool in cells[name]["tools"]:
                self.assertIn(f"name: {tool.split(' (')[0]}", yaml)
            self.assertEqual(bool(cells[name]["external_axes"]), "\nexternal_axes:" in yaml)
            for controller in cells[name]["controllers"]:
                self.assertRegex(yaml, rf"\n  {controller}:")
        # Makers count an arm's reach from axis 1 to the wrist centre.
        self.assertAlmostEqual(cells["kr500_r2830"]["reach_mm"], 2826.47, 2)
        self.assertEqual(cells["kr500_two_tools"]["tools"], ["mill_d20 (20 mm)", "drill_d5 (5 mm)"])
        self.assertEqual(cells["irb6640_rail"]["external_axes"], ["rail (linear, carries the robot, -2000 to 2000 mm)"])

    def test_a_name_that_none_has_is_answered_with_the_nearest(self):
        result = run("cells", "kr500_r2831")
        self.assertEqual((result.returncode, result.stdout), (2, ""))
        self.assertIn('did you mean "kr500_r2830"', result.stderr)
        self.assertEqual(run("cells", "ur10e", "--json").returncode, 2)

    def test_init_takes_what_the_list_says(self):
        refusal = run("init", TOP / "toolpaths/support_pad/support_pad.stl", "--arm", "x").stderr
        for cell in json.loads(run("cells", "--json").stdout)["cells"]:
            self.assertEqual(bool(re.search(rf"\b{cell['name']}\b", refusal)), cell["for_init"], refusal)


class Schema(unittest.TestCase):
    def test_schemas_are_the_committed_ones(self):
        for what in ("job", "cell", "batch"):
            result = run("schema", what)
            self.assertEqual(result.returncode, 0)
            with open(f"{TOP}/docs/schema/{what}.schema.json", encoding="utf-8") as file:
                self.assertEqual(json.loads(result.stdout), json.load(file))


class Verify(InFolder):
    def test_confirms_what_plan_wrote_and_refuses_what_was_changed(self):
        out = self.folder / "out"
        self.assertEqual(plan(out).returncode, 0)
        result = run("verify", out, "--job", JOB, "--json")
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        programs = json.loads(result.stdout)["programs"]
        self.assertEqual([p["controller"] for p in programs if "/starts/" not in p["file"]], ["krl", "linuxcnc", "sinumerik"])
        self.assertTrue(all(p["confirmed"] for p in programs))

        source = out / "programs" / "krl" / "support_pad.src"
        text = source.read_text()
        line = next(l for l in text.splitlines() if l.startswith("LIN "))
        source.write_text(text.replace(line, line.replace("Z ", "Z 1"), 1))
        result = run("verify", out, "--job", JOB)
        self.assertEqual(result.returncode, 1, result.stderr)
        self.assertIn("  changed since they were written: support_pad.src\n", result.stdout)
        number = text.splitlines().index(line) + 1
        self.assertRegex(result.stdout, rf"support_pad\.src:{number}: ")

        def held(changed, status, words):
            source.write_text(changed)
            elsewhere = self.folder / "support_pad.src"
            elsewhere.write_text(changed)
            for arguments in ((out, "--job", JOB), (elsewhere, "--plan", out, "--job", JOB)):
                result = run("verify", *arguments)
                self.assertEqual(result.returncode, status, result.stdout + result.stderr)
                self.assertIn(words, result.stdout)
        still = "changed since, still as planned"
        held(text.replace("\n", "\r\n"), 0, still)
        held(text.replace("\n" + line, "\n; by hand\n\n" + line, 1), 0, still)
        held(text.replace(line, line.replace("LIN {", "LIN  { "), 1), 0, still)
        held(text.replace("\nEND\n", "\nHALT\nEND\n"), 1, "the stop HALT is not planned here")
        held(text.replace("\n;FOLD PASS 0 PIECE 0", "", 1), 1, "the mark of the begin of pass 0 piece 0 is missing here")
        source.write_text(text)
        data = source.with_suffix(".dat")
        was = data.read_text()
        data.write_text(was.replace("DECL INT SUCCESS", "DECL REAL SUCCESS"))
        result = run("verify", out, "--job", JOB)
        self.assertEqual(result.returncode, 1, result.stderr)
        self.assertIn("'DECL REAL SUCCESS' is here, written was 'DECL INT SUCCESS'", result.stdout)
        data.write_text(was)
        source.write_text(text.replace(line, line.replace("LIN", "LINE"), 1))
        result = run("verify", out, "--job", JOB)
        self.assertEqual(result.returncode, 2)
        self.assertRegex(result.stderr, rf"support_pad\.src:{number}:\d+: ")
        result = run("verify", source, "--cell", TOP / "cells" / "kr500_r2830.yaml")
        self.assertEqual(result.returncode, 2)
        self.assertRegex(result.stderr, r"support_pad\.src:\d+:\d+: ")

        source.write_text(text)
        result = run("verify", source, "--cell", TOP / "cells" / "kr500_r2830.yaml")
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        self.assertIn("compared: reach, limits, speeds, singularity, interference, spindle; not the plan\n", result.stdout)
        self.assertEqual(run("verify", source).returncode, 2)
        self.assertEqual(run("verify", out, "--plan", out).returncode, 2)


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
        self.assertEqual(complete("schema", "''"), ["job", "cell", "tools", "batch", "reference"])
        self.assertEqual(complete("stiffness", "--map", "lambda_t"), ["lambda_t1", "lambda_t2"])
        self.assertEqual(complete("plan", "--axis-map", "f"), ["full"])
        self.assertEqual(complete("help", "sch"), ["schema"])
        self.assertEqual(complete("hel"), ["help"])

    def test_examples_of_the_manual_name_commands_and_options_that_there_are(self):
        page = run("man").stdout.replace("\\-", "-")
        examples = re.findall(r"^\\fB(millpose .*)\\fR$", page.split(".SH EXAMPLES")[1].split(".SH EXIT")[0], re.M)
        self.assertGreater(len(examples), 5)
        for example in examples:
            _, command, *words = example.split()
            known = run("help", command)
            self.assertEqual(known.returncode, 0, example)
            for option in (word for word in words if word.startswith("-")):
                self.assertIn(option, known.stdout, example)

    def test_version_by_both_names(self):
        self.assertEqual(run("-V").stdout, run("--version").stdout)
        self.assertRegex(run("-V").stdout, r"^millpose \d+\.\d+\.\d+\n$")
        self.assertEqual(run("help").stdout, run("--help").stdout)
        self.assertEqual(run("help", "schemas").returncode, 2)


class OtherFiles(InFolder):
    def test_what_is_no_mesh_is_named_as_what_it_is(self):
        for name, text, words in (("arm.stl", "<?xml version='1.0'?><robot name='a'/>", "this is a URDF"),
                                  ("README.md", "# A part\nof mine\n", "a text for people"),
                                  ("part.stl", "millpose_job: 1\nname: a\n", "a millpose job"),
                                  ("part.dae", "<COLLADA/>", "this is XML")):
            (self.folder / name).write_text(text)
            result = run("check", self.folder / name)
            self.assertEqual(result.returncode, 2, name)
            self.assertIn(words, result.stderr)
        (self.folder / "notes.stl").write_text("words of no meaning\n")
        self.assertIn("text of no known mesh format", run("check", self.folder / "notes.stl").stderr)

    def test_points_in_a_groove_are_told_as_skipped_where_they_are(self):
        (self.folder / "groove.obj").write_text("v -40 -40 8\nv 0 -40 0\nv 40 -40 8\nv -40 40 8\nv 0 40 0\nv 40 40 8\n"
                                                "f 1 2 5 4\nf 2 3 6 5\n")
        text = without_force().replace("support_pad.stl", "groove.obj").replace("within_deg: 1}", "within_deg: 30}")
        (self.folder / "job.yaml").write_text(text)
        told = {}
        for action in ("skip", "lift"):
            result = run("plan", self.folder / "job.yaml", "-q", "-o", self.folder / action, "--set", "toolpath.stepover_mm=40",
                         "--set", f"toolpath.gouges.action={action}")
            summary = json.loads((self.folder / action / "summary.json").read_text())
            [told[action]] = [w for w in summary["warnings"] if "the cutter would go" in w]
            if action == "skip":
                skipped = [s for s in summary["skipped"] if s["reason"] == "gouge"]
                self.assertGreater(len(skipped), 0)
                self.assertIn(f"; {len(skipped)} points are skipped", told[action])
        self.assertNotIn("skipped", told["lift"])

    def test_nobody_is_told_to_remove_a_folder(self):
        (self.folder / "mine.txt").write_text("mine\n")
        result = run("plan", JOB, "-o", self.folder)
        self.assertEqual(result.returncode, 2)
        self.assertIn("was not written by millpose; choose another with -o DIR", result.stderr)
        self.assertNotIn("remove", result.stderr)

    def test_a_plan_without_a_point_shows_no_empty_table(self):
        text = JOB.read_text().replace("../../cells", str(TOP / "cells")).replace("support_pad.stl", str(JOB.parent / "support_pad.stl"))
        (self.folder / "job.yaml").write_text(text.replace("[2076, 0, 1006]", "[9076, 0, 1006]"))
        result = run("plan", self.folder / "job.yaml", "-q")
        self.assertEqual(result.returncode, 1, result.stderr)
        self.assertIn("support_pad on kr500_r2830: 0 of 210 points in 10 passes", result.stdout)
        for word in ("median", "lambda_", "against", "nan", "objective "):
            self.assertNotIn(word, result.stdout)


class CamWithoutPart(InFolder):
    def test_tool_axes_serve_as_normals(self):
        job = without_force()
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
        self.assertIn("workpiece.mesh: missing; only strategy cam, drill with a list of holes and trim along a line go without a part",
                      run("plan", self.folder / "job.yaml").stderr)


    def with_path(self, name, text, keys="", process=""):
        job = without_force()
        start, end = job.index("toolpath:"), job.index("process:")
        job = job[:start] + f"toolpath: {{strategy: cam, cam: {{file: {name}{keys}}}, spacing_mm: 20}}\n" + job[end:]
        (self.folder / name).write_text(text)
        job = re.sub(r"spindle_rpm: *\d+", "spindle_rpm: 7000", job)
        (self.folder / "job.yaml").write_text(job.replace("  mesh: support_pad.stl\n", ""))
        return self.folder / "job.yaml"

    def test_check_says_who_wrote_the_file_and_how_it_is_read(self):
        text = ("$$-> MFGNO / HOLES\nUNITS / MM\nLOADTL / 1\n$$-> CUTTER / 20.000000\n"
                "$$-> CSYS / 1.0, 0.0, 0.0, 0.0, $\n 0.0, 1.0, 0.0, 0.0, $\n 0.0, 0.0, 1.0, 0.0\n"
                "SPINDL / RPM, 12000.000000,  CLW\nRAPID\nGOTO / -30.0, 0.0, 20.0\nFEDRAT / 600.0, MMPM\n"
                "GOTO / -30.0, 0.0, 0.0\nGOTO / 30.0, 0.0, 0.0\n")
        job = self.with_path("path.ncl", text)
        result = run("check", job)
        self.assertIn("path.ncl: read as Creo, mm, by UNITS in line 2, frame CSYS in line 5 (identity), three numbers = +z, "
                      "tool 1 D20 at 12,000/min clockwise", result.stdout, result.stderr)
        cam = json.loads(run("check", job, "--json").stdout)["cam"]
        self.assertEqual((cam["sender"], cam["three_numbers"]), ("Creo", "+z"))
        self.assertEqual(cam["sections"], [{"tool": "1", "cutter_mm": 20.0, "corner_radius_mm": 0.0, "spindle_rpm": 12000.0,
                                            "spindle_sense": "clockwise", "first_line": 12, "last_line": 13}])
        result = run("plan", job, "-o", self.folder / "out", "--quiet")
        self.assertEqual(result.returncode, 0, result.stderr)
        programs = "".join(file.read_text(encoding="ascii") for file in (self.folder / "out" / "programs").rglob("*")
                           if file.suffix in (".src", ".mpf", ".ngc"))
        self.assertRegex(programs, r"(?<![\d.])12000(?![\d.])")
        self.assertNotRegex(programs, r"(?<![\d.])7000(?![\d.])")
        warnings = json.loads((self.folder / "out" / "summary.json").read_text())["warnings"]
        self.assertTrue(any("process.spindle_rpm says 7000: the file's holds" in w for w in warnings), warnings)
        cell = self.with_path("path.ncl", text, ", spindle: cell")
        self.assertEqual(run("plan", cell, "-o", self.folder / "own", "--quiet").returncode, 0)
        programs = "".join(file.read_text(encoding="ascii") for file in (self.folder / "own" / "programs").rglob("*")
                           if file.suffix in (".src", ".mpf", ".ngc"))
        self.assertNotRegex(programs, r"(?<![\d.])12000(?![\d.])")

    def test_words_that_senders_use_differently_are_refused_with_their_key(self):
        rapid = "RAPID\nGOTO/-30,0,20\nFEDRAT/600.,MMPM\nGOTO/-30,0,0\nGOTO/30,0,0\n"
        head = "PARTNO/X\nUNITS/MM\nCUTTER/20\nLOADTL/1\n"
        two = head + "SPINDL/7000,RPM,CLW\n" + rapid + "CUTTER/6\nLOADTL/2\n" + rapid
        for text, keys, expected in (
                (head + "SPINDL/12000,RPM,CCLW\n" + rapid, "", "path.apt:9: the file turns the spindle counter-clockwise (at 12000/min)"),
                (two, "", "section 2: tool 2 D6 at 7,000/min clockwise, lines 16 to 17"),
                (two, ", section: 3", "toolpath.cam.section: given 3, the file has 2 sections"),
                (head + rapid, ", unit: inch", "toolpath.cam.unit has no effect: the file states its unit itself"),
                (head + rapid, ", frame: as_given", "toolpath.cam.frame has no effect"),
                (head + rapid, ", sender: fanuc", "allowed: one of nx, catia, creo, autodesk, solidworks_cam, mastercam, linuxcnc, sinumerik"),
                ("PARTNO/X\nCUTTER/0.7874\n" + rapid.replace("600.,MMPM", "24,IPM"), "", "state toolpath.cam.unit".capitalize()),
                (head + "CYCLE/BORE,12,MMPM,120,5\nRAPID\nGOTO/0,0,9\nRAPID\nGOTO/0,0,8\nGOTO/0,0,0\nCYCLE/OFF\n", "",
                 "the CAM path holds no cut: all its ways are rapids; left out: CYCLE/BORE in line 7")):
            result = run("check", self.with_path("path.apt", text, keys))
            self.assertEqual(result.returncode, 2, result.stdout)
            self.assertIn(expected, result.stderr)
        result = run("check", self.with_path("path.apt", two, ", section: 1"))
        self.assertIn("tool 1 D20 at 7,000/min clockwise", result.stdout, result.stderr)
        self.assertNotIn("tool 2", result.stdout)
        code = "G21 G90\nS7000 M3\nG54\nG0 X-30 Y0 Z20\nG1 Z0 F600\nX30\nG0 Z20\nG55\nG0 X-30 Y0\nG1 Z0\nX30\n"
        result = run("check", self.with_path("path.nc", code))
        self.assertEqual(result.returncode, 2, result.stdout)
        self.assertIn("path.nc:8:1: G55 behind cuts under G54", result.stderr)
        result = run("check", self.with_path("path.nc", code, ", offsets_mm: {G54: [0, 0, 0], G55: [0, 40, 0]}"), "--json")
        self.assertEqual(json.loads(result.stdout)["passes"], 2, result.stderr)
        result = run("check", self.with_path("path.nc", code, ", offsets_mm: {G54: [0, 0, 0], G55: [0, 40, 0], G56: [0, 0, 0]}"))
        self.assertIn("toolpath.cam.offsets_mm.G56 has no effect: nothing is cut under it", result.stderr)

    def test_holes_that_are_left_out_are_told_in_report_and_program_head(self):
        job = without_force()
        start, end = job.index("toolpath:"), job.index("process:")
        job = job[:start] + "toolpath: {strategy: cam, cam: {file: path.nc}, spacing_mm: 20}\n" + job[end:]
        (self.folder / "path.nc").write_text("G90 G21\nG0 X-30 Y0 Z20\nG84 Z-5 R5 F100\nX0\nG80\nG0 X-30 Z0\n"
                                             "G1 X30 F600 M77\n")
        (self.folder / "job.yaml").write_text(job.replace("  mesh: support_pad.stl\n", ""))
        result = run("plan", self.folder / "job.yaml", "-o", self.folder / "out", "--quiet")
        self.assertEqual(result.returncode, 1, result.stderr)
        summary = json.loads((self.folder / "out" / "summary.json").read_text())
        why = "the cycle stops, orients or synchronises the spindle"
        holes = [f"NOT MACHINED: G84 in line {n} at ({x}, 0.000, 5.000) mm of the workpiece: {why}"
                 for n, x in ((3, "-30.000"), (4, "0.000"))]
        self.assertEqual(summary["findings"], holes)
        self.assertIn("path.nc: M codes that are not known, taken for no motion: M77 (1)", summary["warnings"])
        programs = [file for file in (self.folder / "out" / "programs").rglob("*") if file.suffix in (".src", ".mpf", ".ngc")]
        self.assertTrue(programs)
        for program in programs:
            text = program.read_text(encoding="ascii")
            self.assertEqual(text.count("; NOT MACHINED: G84 in line "), 2, program)
        result = run("check", self.folder / "job.yaml")
        self.assertEqual(result.returncode, 1, result.stderr)
        self.assertIn(holes[1], result.stdout)


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

    def test_a_setting_of_the_job_can_be_changed(self):
        job = f"{TOP}/toolpaths/support_pad/job.yaml"
        points = [json.loads(run("check", job, "--json", "-q", *more).stdout)["points"] for more in ([], ["--set", "toolpath.stepover_mm=16"])]
        self.assertLess(points[1], points[0])
        result = run("check", job, "--set", "toolpath.stepver_mm=16")
        self.assertEqual(result.returncode, 2)
        self.assertIn("nearest known key: stepover_mm", result.stderr)
        result = run("check", f"{TOP}/cells/kr500_r2830.yaml", "--set", "name=x")
        self.assertEqual(result.returncode, 2)
        self.assertIn("--set: has no effect here", result.stderr)

    def test_cell_is_checked(self):
        result = run("check", f"{TOP}/cells/kr500_r2830.yaml")
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        self.assertIn("cell                kr500_r2830, arm KUKA KR 500 R2830", result.stdout)
        self.assertIn("krl, linuxcnc, sinumerik", result.stdout)
        found = json.loads(run("check", f"{TOP}/cells/kr500_r2830.yaml", "--json").stdout)
        self.assertGreater(found["reach_mm"], 2000)
        self.assertGreater(found["bodies"], 5)

    def test_cell_with_a_fault_is_refused_and_one_whose_home_interferes_is_a_finding(self):
        with tempfile.TemporaryDirectory() as folder:
            text = pathlib.Path(f"{TOP}/cells/kr500_r2830.yaml").read_text()
            cell = pathlib.Path(folder) / "cell.yaml"
            cell.write_text(text + "nonsense: 1\n")
            result = run("check", cell)
            self.assertEqual(result.returncode, 2)
            self.assertIn("nonsense", result.stderr)
            cell.write_text(re.sub(r"home_deg: \[.*?\]", "home_deg: [0, 0, 120, 0, 0, 0]", text))
            result = run("check", cell)
            self.assertEqual(result.returncode, 1, result.stdout + result.stderr)
            self.assertIn("no way from or to home can be planned", result.stdout)

    def test_check_refuses_what_plan_refuses(self):
        """A cell without the settings of a controller that the job names: check said OK and plan refused."""
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            cell = pathlib.Path(f"{TOP}/cells/kr500_r2830.yaml").read_text()
            lines, kept, inside = cell.splitlines(), [], False
            for line in lines:
                inside = line.startswith("  krl:") or (inside and (line.startswith("    ") or not line.strip()))
                if not inside:
                    kept.append(line)
            self.assertLess(len(kept), len(lines))
            (folder / "cell.yaml").write_text("\n".join(kept) + "\n")
            shutil.copy(f"{TOP}/toolpaths/support_pad/support_pad.stl", folder)
            job = pathlib.Path(f"{TOP}/toolpaths/support_pad/job.yaml").read_text()
            (folder / "job.yaml").write_text(job.replace("../../cells/kr500_r2830.yaml", "cell.yaml"))
            told = [run(command, folder / "job.yaml", "-q") for command in ("check", "plan")]
            self.assertEqual([r.returncode for r in told], [2, 2], told[0].stdout)
            self.assertIn("controllers", told[0].stderr)
            self.assertEqual(told[0].stderr, told[1].stderr)

    def test_view_is_a_page_that_stays_the_same(self):
        with tempfile.TemporaryDirectory() as folder:
            pages = []
            for threads in ("1", "2"):
                page = pathlib.Path(folder) / f"{threads}.html"
                result = run("check", f"{TOP}/toolpaths/support_pad/job.yaml", "--view", page, "--threads", threads, "-q")
                self.assertEqual(result.returncode, 0, result.stderr)
                pages.append(page.read_bytes())
            self.assertEqual(pages[0], pages[1])
            for what in (f"{TOP}/cells/ur10e.yaml", f"{TOP}/toolpaths/cabin_ring/cabin_ring.stl"):
                page = pathlib.Path(folder) / "other.html"
                self.assertLess(run("check", what, "--view", page, "-q").returncode, 2)
                self.assertIn(b"millpose check</title>", page.read_bytes())
                page.unlink()

    def test_unreadable_mesh_has_status_2(self):
        self.assertEqual(run("check", f"{TOP}/README.md").returncode, 2)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
