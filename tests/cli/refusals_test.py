#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""What `millpose plan` refuses or leaves out, and what it leaves behind then. Usage: refusals_test.py MILLPOSE MILLPOSE_AUDIT TOP"""
import json
import os
import sys
import unittest

from plan_fixture import CUT_DOWN, Bench

BENCH = None


def box(x, y):
    """ASCII STL of an 80 x 80 x 40 mm block whose top, z = 0, has its centre at x, y."""
    corner = [(x + 40 * i, y + 40 * j, k) for k in (-40, 0) for j in (-1, 1) for i in (-1, 1)]
    faces = ((0, 2, 3), (0, 3, 1), (4, 5, 7), (4, 7, 6), (0, 1, 5), (0, 5, 4), (1, 3, 7), (1, 7, 5), (3, 2, 6), (3, 6, 7),
             (2, 0, 4), (2, 4, 6))
    return "".join("facet normal 0 0 0\nouter loop\n" + "".join("vertex %g %g %g\n" % corner[v] for v in face) +
                   "endloop\nendfacet\n" for face in faces)


class OutOfReach(unittest.TestCase):
    def test_points_that_no_pose_reaches_are_skipped_with_the_reason(self):
        # Two pads on one wall, the second three metres above the first.
        (BENCH.top / "toolpaths/support_pad/two.stl").write_text("solid\n" + box(0, 0) + box(3000, 0) + "endsolid\n")
        job = BENCH.job("support_pad", CUT_DOWN + [("mesh: support_pad.stl", "mesh: two.stl")], "far")
        result, folder = BENCH.plan(job, "far")
        self.assertEqual(result.returncode, 1, result.stderr)
        summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
        points = summary["points"]
        self.assertGreater(points["skipped"], 0)
        self.assertEqual(points["planned"] + points["skipped"], points["total"])
        self.assertEqual(len(summary["skipped"]), points["skipped"])
        self.assertEqual(points["skipped"], points["planned"])
        self.assertEqual({entry["reason"] for entry in summary["skipped"]}, {"unreachable"})
        self.assertTrue(all(entry["detail"] for entry in summary["skipped"]))
        status, verdict = BENCH.audit(folder, job, "--travel-mm", "5")
        self.assertEqual((status, verdict["broken"]), (0, {}))


class BadInput(unittest.TestCase):
    def check(self, job, folder, *words):
        result, out = BENCH.plan(job, folder)
        self.assertEqual(result.returncode, 2, result.stdout + result.stderr)
        self.assertEqual(result.stdout, "")
        for word in words:
            self.assertIn(word, result.stderr)
        return out

    def test_broken_yaml_leaves_nothing(self):
        job = BENCH.job("support_pad", [("stepover_mm", "stepovr_mm")], "broken")
        out = self.check(job, "broken", "broken.yaml:", "stepovr_mm", "stepover_mm")
        self.assertFalse(out.exists())

    def test_a_missing_file_leaves_nothing(self):
        job = BENCH.job("support_pad", [("mesh: support_pad.stl", "mesh: none.stl")], "missing")
        self.assertFalse(self.check(job, "missing", "none.stl").exists())

    def test_a_broken_mesh_leaves_no_programs(self):
        (BENCH.top / "toolpaths/support_pad/empty.stl").write_bytes(b"solid x\nendsolid x\n")
        job = BENCH.job("support_pad", [("mesh: support_pad.stl", "mesh: empty.stl")], "empty")
        self.assertFalse((self.check(job, "empty", "empty.stl") / "programs").exists())

    def test_a_folder_of_someone_else_is_left_alone(self):
        foreign = BENCH.top / "foreign"
        foreign.mkdir()
        (foreign / "thesis.txt").write_text("years of work", encoding="utf-8")
        self.check(BENCH.job("support_pad", CUT_DOWN, "small"), "foreign", "foreign")
        self.assertEqual(os.listdir(foreign), ["thesis.txt"])

    def test_a_cell_for_reproduction_gets_no_programs(self):
        job = BENCH.job("support_pad", [("kr500_r2830", "chen2021_table6")], "reproduction")
        self.check(job, "reproduction", "reproduction")


if __name__ == "__main__":
    BENCH = Bench(*sys.argv[1:4])
    unittest.main(argv=sys.argv[:1])
