#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The package millpose of apps/python. Usage: python_test.py MILLPOSE TOP"""
import json
import os
import subprocess
import sys
import threading
import unittest

import numpy as np
from cli_fixture import FEW, JOB, MILLPOSE, TOP, InFolder, run, tree

os.environ["MILLPOSE"] = str(MILLPOSE)
sys.path.insert(0, str(TOP / "apps/python"))
import millpose  # noqa: E402

SETTINGS = dict(change.split("=") for change in FEW)
CELL = TOP / "cells/kr500_r2830.yaml"


def softest(index):
    return np.maximum(index["normal_deflection_mm_N"], 0.5 * index["worst_in_plane_mm_N"])


class Plans(InFolder):
    def test_same_bytes_as_by_the_command_line(self):
        plan = millpose.plan(JOB, self.folder / "a", settings=SETTINGS)
        done = run("plan", JOB, "-o", self.folder / "b", "-q", *[word for change in FEW for word in ("--set", change)])
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(tree(self.folder / "a"), tree(self.folder / "b"))
        self.assertTrue(plan.planned.all())
        self.assertEqual((plan.positions_mm.shape, plan.joints_deg.shape), ((len(plan), 3), (len(plan), 6)))
        self.assertTrue(np.allclose(np.linalg.norm(plan.normals, axis=1), 1))
        self.assertTrue(np.allclose(plan.feeds_mm_min, 80))

    def test_arrays_are_the_plans(self):
        plan = millpose.plan(JOB, self.folder / "a", settings=SETTINGS)
        points = [point for one in plan.document["passes"] for point in one["points"]]
        self.assertTrue(np.array_equal(plan.positions_mm, [point["point"]["position"] for point in points]))
        self.assertTrue(np.allclose(plan.joints_deg, np.degrees([point["q"] for point in points]), rtol=0, atol=1e-9))
        stiff = np.array([1e-3 / point["indices"]["normal_compliance"] for point in points])
        self.assertTrue(np.allclose(plan.stiffness_n_per_um, stiff, rtol=1e-12))
        self.assertEqual(len(plan.gaps_deg), len(plan.document["gaps"]))
        self.assertTrue(np.allclose(plan.gaps_deg[0][0], [0, -90, 90, 0, 0, 0]))  # from home
        # The stiffness in a planned pose is the same by itself.
        alone = millpose.stiffness(CELL, plan.joints_deg, normal=plan.normals)
        self.assertTrue(np.allclose(alone.origin_mm, plan.positions_mm, atol=1e-6))
        self.assertTrue(np.allclose(alone.stiffness_n_per_um, plan.stiffness_n_per_um, rtol=1e-9))
        self.assertTrue(np.array_equal(millpose.load(self.folder / "a").joints_deg, plan.joints_deg))

    def test_skipped_points_are_nan_and_no_exception(self):
        plan = millpose.plan(JOB, self.folder / "a", settings={**SETTINGS, "workpiece.pose.xyz_mm": np.array([2900, 0, 1006])})
        self.assertFalse(plan.planned.any())
        self.assertGreater(len(plan), 3)
        self.assertTrue(np.isnan(plan.joints_deg).all() and np.isnan(plan.stiffness_n_per_um).all())
        self.assertEqual(set(plan.texts("reason")), {"limit"})
        self.assertTrue(plan.findings)

    def test_dict_is_a_job_and_leaves_no_file(self):
        job = {"millpose_job": 1, "name": "dict", "cell": str(CELL), "seed": 1,
               "workpiece": {"mesh": "support_pad.stl", "unit": "mm", "frame": "robot_base",
                             "pose": {"xyz_mm": [2076, 0, 1006], "abc_deg": [0, -90, 0]}},
               "toolpath": {"strategy": "parallel_planes", "region": {"facing": {"direction": [0, 0, 1], "within_deg": 1}},
                            "planes": {"normal": [0, 1, 0]}, "stepover_mm": 60, "spacing_mm": 40},
               "process": {"feed_mm_min": 80, "spindle_rpm": 7000}, "programs": ["krl"]}
        before = sorted(JOB.parent.iterdir())
        events = []
        plan = millpose.plan(job, self.folder / "a", folder=JOB.parent, on_progress=events.append)
        self.assertEqual(sorted(JOB.parent.iterdir()), before)
        self.assertTrue(plan.planned.all())
        self.assertTrue(events)
        self.assertEqual(run("verify", self.folder / "a").returncode, 0)
        job["process"]["feed_mm_mn"] = job["process"].pop("feed_mm_min")
        with self.assertRaises(millpose.InputError) as caught:
            millpose.plan(job, self.folder / "b", folder=JOB.parent)
        self.assertEqual(caught.exception.status, 2)
        unknown = [message for message in caught.exception.messages if "feed_mm_mn" in message.text][0]
        self.assertIn("nearest known key: feed_mm_min", unknown.text)
        self.assertTrue(unknown.file.endswith(".yaml") and unknown.line > 1 and unknown.column > 1, unknown)
        self.assertEqual(sorted(JOB.parent.iterdir()), before)

    def test_what_ends_python_ends_the_program(self):
        with self.assertRaises(ZeroDivisionError):
            millpose.plan(JOB, self.folder / "a", settings=SETTINGS, on_progress=lambda event: 1 / 0)
        self.assertFalse((self.folder / "a/summary.json").exists())
        plan = millpose.plan(JOB, self.folder / "a", settings=SETTINGS)  # nobody holds the folder any more
        self.assertTrue(plan.planned.all())

    def test_other_endings(self):
        with self.assertRaises(FileNotFoundError):
            millpose.load(self.folder)
        with self.assertRaises(millpose.InputError) as caught:
            millpose.run("plan", "--no-such-option")
        self.assertTrue(caught.exception.messages)
        with self.assertRaises(millpose.InternalError):
            program = self.folder / "program"
            program.write_text("#!/bin/sh\nkill -SEGV $$\n")
            program.chmod(0o700)
            os.environ["MILLPOSE"] = str(program)
            try:
                millpose.run("plan")
            finally:
                os.environ["MILLPOSE"] = str(MILLPOSE)


class Stiffness(InFolder):
    def test_poses_and_maps(self):
        one = millpose.stiffness(CELL, [0, -90, 90, 0, 30, 0])
        self.assertEqual((one.compliance.shape, one.mu.shape), ((6, 6), ()))
        self.assertTrue(np.allclose(one.compliance @ one.stiffness, np.eye(6), atol=1e-6))
        two = millpose.stiffness(CELL, [[0, -90, 90, 0, 30, 0], [0, -90, 90, 0, 0, 0]])
        self.assertTrue(np.array_equal(two.compliance[0], one.compliance))
        self.assertTrue(np.isnan(two.stiffness[1]).all())  # singular
        plane = [[1800, -500, 900], [1800, 500, 900], [1800, -500, 1400]]
        drawn = millpose.stiffness_map(CELL, "normal_deflection", plane, (2, 1), rotation_step_deg=15, tool_axis=[-1, 0, 0])
        self.assertEqual((drawn.values.shape, drawn.unit), ((2, 3), "mm/N"))
        self.assertEqual([list(drawn.points_mm[0, 0]), list(drawn.points_mm[0, 2]), list(drawn.points_mm[1, 0])],
                         [[float(x) for x in corner] for corner in plane])
        reached = ~np.isnan(drawn.values)
        self.assertTrue(reached.any())
        alone = millpose.stiffness(CELL, drawn.joints_deg[reached], normal=[-1, 0, 0])
        self.assertTrue(np.allclose(alone.normal_deflection_mm_n, drawn.values[reached], rtol=1e-9))
        self.assertTrue(np.allclose(alone.origin_mm, drawn.points_mm[reached], atol=1e-6))
        with self.assertRaises(millpose.InputError):
            millpose.stiffness_map(CELL, "softness", plane, (2, 1))


class Objectives(InFolder):
    def test_function_plans_as_the_expression_does(self):
        asked = []

        def objective(index):
            asked.append((threading.get_ident(), sorted(index)))
            return softest(index)

        few = {**SETTINGS, "programs": ["krl"]}
        mine = millpose.plan(JOB, self.folder / "a", objective=objective, settings=few, threads=2)
        spelled = millpose.plan(JOB, self.folder / "b", settings={
            **few, "pose.objective": {"expression": "max(normal_deflection_mm_N, 0.5*worst_in_plane_mm_N)"}})
        self.assertEqual((self.folder / "a/points.csv").read_bytes(), (self.folder / "b/points.csv").read_bytes())
        self.assertEqual({thread for thread, _ in asked}, {threading.get_ident()})
        self.assertEqual(asked[0][1], sorted(millpose.INDICES[:-1]))
        self.assertEqual(mine.summary["objective"], "piped")
        self.assertRegex((self.folder / "a/job.yaml").read_text(), r"name: piped")
        self.assertGreater(len(spelled), 0)
        for command in (("verify", self.folder / "a"), ("report", self.folder / "a", "--html", self.folder / "sheet.html"),
                        ("diff", self.folder / "a", self.folder / "b"), ("inspect", self.folder / "a")):
            self.assertLess(run(*command).returncode, 2, command)
        self.assertEqual(run("diff", self.folder / "a", self.folder / "a").returncode, 0)
        self.assertIn("none is connected", run("face", self.folder / "a").stderr)

    def test_force_is_there_when_asked_for(self):
        plan = millpose.plan(JOB, self.folder / "a", objective=lambda index: index["force_deflection_mm"], reads_force=True,
                             settings={**SETTINGS, "programs": []})
        spelled = millpose.plan(JOB, self.folder / "b", settings={**SETTINGS, "programs": [],
                                                                  "pose.objective": {"expression": "force_deflection_mm"}})
        self.assertTrue(np.array_equal(plan.joints_deg, spelled.joints_deg))

    def test_errors_of_the_function_are_raised_and_leave_nothing(self):
        def broken(index):
            return index["no_such_index"]

        with self.assertRaises(KeyError):
            millpose.plan(JOB, self.folder / "a", objective=broken, settings=SETTINGS)
        self.assertFalse((self.folder / "a/summary.json").exists())
        with self.assertRaises(ValueError):
            millpose.plan(JOB, self.folder / "a", objective=lambda index: np.zeros(3), settings=SETTINGS)
        with self.assertRaises(millpose.InputError):  # the program's own refusal, before it asks anything
            millpose.plan(JOB, self.folder / "a", objective=softest, settings={"toolpath.stepovr_mm": 4})

    def test_nobody_connected_or_gone(self):
        words = ["plan", JOB, "-o", self.folder / "a", "-q", *[w for change in FEW for w in ("--set", change)],
                 "--set", "pose.objective={name: piped}"]
        done = run(*words)
        self.assertEqual(done.returncode, 2)
        self.assertIn("objective piped: its values come from another program, and none is connected", done.stderr)
        done = run(*words, "--objective-pipe", "77,78")
        self.assertEqual(done.returncode, 2)
        self.assertIn("--objective-pipe: given 77,78; allowed: IN,OUT, two open descriptors from 3", done.stderr)
        read, write = os.pipe()
        os.close(os.dup(read))
        theirs, unread = os.pipe()
        os.close(theirs)
        with subprocess.Popen([MILLPOSE, *map(str, words), "--objective-pipe", f"{read},{unread}"], pass_fds=(read, unread),
                              stderr=subprocess.PIPE, text=True) as process:
            os.close(read)
            os.close(unread)
            os.close(write)
            self.assertIn("the process that gives its values has ended", process.communicate(timeout=120)[1])
            self.assertEqual(process.returncode, 2)

    def test_another_function_is_another_setting(self):
        few = {**SETTINGS, "programs": []}
        numbers = []
        for objective in (softest, lambda index: index["lambda_t1_mm_N"]):
            plan = millpose.plan(JOB, self.folder / "a", objective=objective, settings=few)
            numbers.append(json.loads((self.folder / "a/manifest.json").read_text())["key"])
            self.assertTrue(plan.planned.all())
        self.assertNotEqual(*numbers)


if __name__ == "__main__":
    unittest.main(argv=["python_test"])
