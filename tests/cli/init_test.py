# SPDX-License-Identifier: GPL-3.0-or-later
"""`millpose init`: what it writes plans without an edit. Arguments: MILLPOSE TOP"""
import importlib.util
import math
import os
import re
import unittest
from pathlib import Path

from cli_fixture import TOP, InFolder, run

spec = importlib.util.spec_from_file_location("make_meshes", TOP / "toolpaths" / "make_meshes.py")
make_meshes = importlib.util.module_from_spec(spec)
spec.loader.exec_module(make_meshes)


def dome():
    """An open sheet, 400 x 400 mm, bulged by 40 mm."""
    def at(i, j):
        x, y = 40.0 * i - 200, 40.0 * j - 200
        return (x, y, 40 * math.cos(math.pi * x / 400) * math.cos(math.pi * y / 400))
    return [t for i in range(10) for j in range(10)
            for t in make_meshes.quad(at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1))]


def urdf(name="own_arm", flange="tool0", shapes=True, wrist_offset=0.0, limited=True, speed=2.0):
    """An arm with a spherical wrist and a reach of 2.3 m; a counterweight hangs beside the chain."""
    joints = [("0 0 0.7", "0 0 1", 3.1), ("0.35 0 0", "0 1 0", 2.2), ("0 0 1.0", "0 1 0", 2.6), ("0.5 0 0", "1 0 0", 3.2),
              (f"0.5 {wrist_offset} 0", "0 1 0", 2.0), ("0 0 0", "1 0 0", 6.1)]
    shape = ('<collision><origin xyz="{}"/><geometry><box size="{}"/></geometry></collision>' if shapes else "")
    sizes = [("0 0 0.2", "0.5 0.5 0.4"), ("0 0 -0.1", "0.4 0.4 0.2"), ("0 0.3 0.5", "0.2 0.2 0.8"), ("0 0 0", "0.2 0.2 0.2"),
             ("0.1 0 0", "0.2 0.15 0.15"), ("0 0 0", "0.12 0.12 0.12"), ("0.1 0 0", "0.1 0.1 0.05")]
    links = [f'<link name="link_{i}">{shape.format(*sizes[i])}</link>' for i in range(7)]
    parts = []
    for i, (xyz, axis, bound) in enumerate(joints, 1):
        kind = "revolute" if limited or i != 6 else "continuous"
        limit = f'<limit lower="-{bound}" upper="{bound}" velocity="{speed}" effort="0"/>' if kind == "revolute" else ""
        parts.append(f'<joint name="joint_{i}" type="{kind}"><parent link="link_{i - 1}"/><child link="link_{i}"/>'
                     f'<origin xyz="{xyz}"/><axis xyz="{axis}"/>{limit}</joint>')
    parts.append(f'<link name="{flange}"/><joint name="to_{flange}" type="fixed"><parent link="link_6"/><child link="{flange}"/>'
                 '<origin xyz="0.2 0 0" rpy="0 1.5707963267948966 0"/></joint>')
    parts.append('<link name="weight"/><joint name="balance" type="revolute"><parent link="link_1"/><child link="weight"/>'
                 '<origin xyz="-0.3 0 0.1"/><axis xyz="0 1 0"/><limit lower="-1" upper="1" velocity="1" effort="0"/>'
                 '<mimic joint="joint_2"/></joint>')
    return f'<robot name="{name}">' + "".join(links + parts) + "</robot>"


class Init(InFolder):
    def mesh(self, name, triangles):
        path = self.folder / name
        path.write_bytes(make_meshes.stl(name, triangles))
        return path

    def arm(self, **options):
        path = self.folder / "arm.urdf"
        path.write_text(urdf(**options))
        return path

    def init(self, *arguments):
        return run("init", *arguments, "-q", cwd=self.folder)

    def assert_plans(self, folder):
        planned = run("plan", folder / "job.yaml", "-q", "-v")
        self.assertEqual(planned.returncode, 0, planned.stdout + planned.stderr)
        self.assertRegex(planned.stdout, r"points +(\d+) planned of \1, 0 skipped")
        self.assertTrue(any(folder.glob("*.out/programs/linuxcnc/*.ngc")))

    def try_parts(self, parts, arms):
        for arm in arms:
            for name, triangles in parts.items():
                with self.subTest(part=name, arm=str(arm)):
                    out = self.folder / f"of_{Path(arm).stem}" / name
                    result = self.init(self.mesh(f"{name}.stl", triangles), "--arm", arm, "--out", out)
                    self.assertEqual(result.returncode, 0, result.stderr)
                    self.assertEqual(sorted(p.name for p in out.iterdir()), ["cell.yaml", "job.yaml"])
                    self.assert_plans(out)
        self.assertEqual(list(self.folder.rglob("*.init")), [])

    def test_a_block_plans_with_a_urdf_and_a_named_arm(self):
        self.try_parts({"block": make_meshes.support_pad()}, (self.arm(), "kr500_r2830"))

    @unittest.skipUnless("MILLPOSE_SLOW" in os.environ, "slow")
    def test_other_parts_plan(self):
        self.try_parts({"dome": dome(), "ring": make_meshes.cabin_ring(), "panel": make_meshes.CabinPanel().build()},
                       (self.arm(), "kr500_r2830"))
        self.try_parts({"block": make_meshes.support_pad()}, ("kr500_r2800_2", "quantec_r2700", "ur10e"))

    def test_every_guess_is_marked_and_says_what_to_do(self):
        self.init(self.mesh("block.stl", make_meshes.support_pad()), "--arm", self.arm())
        cell, job = ((self.folder / "block" / name).read_text() for name in ("cell.yaml", "job.yaml"))
        for text, keys in ((cell, ("base_in_world", "home_deg", "tool", "bodies", "accelerations_deg_s2", "controllers",
                                   "joint_stiffness_Nm_per_rad", "clearance_mm")),
                           (job, ("pose", "region", "stepover_mm", "process"))):
            for key in keys:
                lines = text.splitlines()
                at = next(i for i, line in enumerate(lines) if re.match(rf" *{key}:", line))
                above = lines[at]
                while at > 0 and lines[at - 1].lstrip().startswith("#"):
                    at -= 1
                    above += lines[at]
                self.assertIn("GUESS", above, key)
        self.assertIn("../arm.urdf", cell)
        self.assertIn("../block.stl", job)

    def test_all_sample_arms_are_offered(self):
        result = self.init(self.mesh("block.stl", make_meshes.support_pad()), "--arm", "kr500")
        self.assertEqual(result.returncode, 2)
        for cell in (TOP / "cells").glob("*.yaml"):
            text = cell.read_text()
            first = not any(key in text for key in ("reproduction_only", "\ntools:", "\nexternal_axes:"))  # a first cell is a simple one
            self.assertEqual(cell.stem in result.stderr, first, cell)

    def test_what_a_urdf_leaves_open_is_written_and_marked(self):
        arm = self.arm(shapes=False, limited=False, speed=0)
        result = self.init(self.mesh("block.stl", make_meshes.support_pad()), "--arm", arm)
        self.assertEqual(result.returncode, 0, result.stderr)
        cell = (self.folder / "block" / "cell.yaml").read_text()
        self.assertRegex(cell, r"GUESS: the URDF leaves limits open.*\n +limits_deg: .*\[-350, 350\]\]")
        self.assertRegex(cell, r"GUESS: the URDF leaves speeds open.*\n +speeds_deg_s: \[60, 60, 60, 60, 60, 60\]")
        self.assertIn("unchecked_links: [base, link1, link2, link3, link4, link5]", cell)

    def test_refusals_say_what_is_allowed_and_leave_nothing(self):
        block, arm = self.mesh("block.stl", make_meshes.support_pad()), self.arm(flange="hand")
        (self.folder / "readme.md").write_text("# a part\n")
        (self.folder / "taken").mkdir()
        (self.folder / "taken" / "job.yaml").write_text("mine\n")
        self.mesh("small.stl", [[tuple(x / 1000 for x in p) for p in t] for t in make_meshes.support_pad()])
        before = sorted(self.folder.rglob("*"))
        for arguments, words in (
                (("missing.stl", "--arm", arm), "missing.stl: no such file"),
                ((block, "--arm", "kr500_r2831"), "nearest: kr500_r2830"),
                ((block, "--arm", "no.urdf"), "no.urdf: no such file"),
                ((block, "--arm", arm, "--base-link", "lnk_0"), "nearest: link_0"),
                ((block, "--arm", "kr500_r2830", "--out", "taken"), "job.yaml: exists already"),
                ((block, "--arm", "kr500_r2830", "--out", "readme.md"), "is a file"),
                (("small.stl", "--arm", "kr500_r2830"), "give --unit"),
                (("readme.md", "--arm", "kr500_r2830"), "readme.md"),
                ((block,), "--arm")):
            result = self.init(*arguments)
            self.assertEqual(result.returncode, 2, arguments)
            self.assertIn(words, result.stderr)
            self.assertEqual(sorted(self.folder.rglob("*")), before, arguments)
        self.assertEqual((self.folder / "taken" / "job.yaml").read_text(), "mine\n")

    def test_an_arm_without_a_closed_form_is_refused(self):
        result = self.init(self.mesh("block.stl", make_meshes.support_pad()), "--arm", self.arm(wrist_offset=0.1))
        self.assertEqual(result.returncode, 2)
        self.assertIn("wrist", result.stderr)
        self.assertFalse((self.folder / "block").exists())

    def test_a_calibrated_arm_takes_a_tolerance(self):
        block, arm = self.mesh("block.stl", make_meshes.support_pad()), self.arm(wrist_offset=0.0003)
        refused = self.init(block, "--arm", arm)
        self.assertEqual(refused.returncode, 2)
        self.assertIn("allowed by --tolerance-mm: 0.01 mm", refused.stderr)
        taken = self.init(self.large(), "--arm", arm, "--tolerance-mm", "1")  # which is refused next, for its size
        self.assertRegex(taken.stdout, r"wrist +spherical: .*; the closed form is within 0\.[1-9]\d* mm")
        self.assertIn("is 8 m long", taken.stderr)

    def test_arms_that_are_no_arms_are_told_by_their_cause(self):
        block = self.mesh("block.stl", make_meshes.support_pad())
        good = urdf()
        seven = good.replace("</robot>", '<link name="hand"/><joint name="joint_7" type="revolute"><parent link="tool0"/><child link="hand"/>'
                             '<axis xyz="0 0 1"/><limit lower="-1" upper="1" velocity="1"/></joint></robot>').replace("tool0", "plate")
        degrees = good.replace('lower="-3.1" upper="3.1"', 'lower="-178" upper="178"')
        for text, words in ((seven, "7 joints move between 'link_0' and 'hand' (joint_1, joint_2, joint_3, joint_4, joint_5, joint_6, joint_7)"),
                            (degrees, "joint 'joint_1': limits -178 to 178 rad are 56.7 revolutions"),
                            (good.replace('rpy="0 1.5707963267948966 0"', 'rpy="0 1.57 0"'), "rpy 1.57 is a rounded π/2")):
            (self.folder / "arm.urdf").write_text(text)
            result = self.init(block, "--arm", self.folder / "arm.urdf")
            self.assertEqual(result.returncode, 2, result.stdout)
            self.assertIn(words, result.stderr.splitlines()[0])
            self.assertFalse((self.folder / "block").exists())

    def large(self):
        return self.mesh("large.stl", [[tuple(100 * x for x in p) for p in t] for t in make_meshes.support_pad()])

    def test_the_arm_is_told_before_anything_is_planned(self):
        result = self.init(self.large(), "--arm", self.arm(), "--unit", "mm")
        self.assertEqual(result.returncode, 2)
        self.assertIn("is 8 m long, while the arm with its tool reaches", result.stderr)
        for words in ("joints              joint_1 … joint_6, from link_0 to tool0", "zero                upper arm upright, forearm level",
                      "link body           link_3 on link3: 200 x 200 x 200 mm", "linuxcnc: its angle = [1, 1, 1, 1, 1, 1] × the arm's"):
            self.assertIn(words, result.stdout)

    def test_an_own_cell_stands_in_place_of_an_arm(self):
        cell = TOP / "cells/kr500_two_tools.yaml"
        told = self.init(self.large(), "--cell", cell, "--out", "first")
        self.assertIn("arm                 KUKA KR 500 R2830", told.stdout)
        self.assertIn("is 8 m long", told.stderr)
        wrong = self.init(self.large(), "--cell", cell, "--tool", "mill_d21", "--out", "first")
        self.assertIn("did you mean mill_d20?", wrong.stderr)
        self.assertEqual(self.init(self.large(), "--cell", cell, "--arm", "kr500_r2830").returncode, 2)

    @unittest.skipUnless("MILLPOSE_SLOW" in os.environ, "slow")
    def test_the_users_own_cell_is_taken_as_it_is(self):
        block = self.mesh("block.stl", make_meshes.support_pad())
        cell = self.folder / "plant" / "cell.yaml"
        cell.parent.mkdir()
        text = (TOP / "cells/kr500_r2830.yaml").read_text()
        cell.write_text(text)
        result = self.init(block, "--cell", cell, "--out", "first")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual([p.name for p in (self.folder / "first").iterdir()], ["job.yaml"])
        self.assertEqual(cell.read_text(), text)
        job = (self.folder / "first" / "job.yaml").read_text()
        self.assertIn("cell: ../plant/cell.yaml", job)
        self.assertIn("programs: [krl, linuxcnc, sinumerik]", job)
        self.assert_plans(self.folder / "first")

    def test_shared_parts_where_they_are(self):
        data = Path(os.environ.get("MILLPOSE_SHARED_DATA", ""))
        if "MILLPOSE_SLOW" not in os.environ or not (data / "robots").exists():
            self.skipTest("slow, and with a folder of parts and robots alone (MILLPOSE_SHARED_DATA)")
        parts = {"fm1_satellite_TessPart_3.stl": (), "trimesh_featuretype.STEP": (), "trimesh_featuretype.STL": ("--unit", "in"),
                 "fuselage777_side_panel_2.0x2.1m.stl": (), "fuselage777_barrel_1.5m.stl": ()}
        for arm in sorted((data / "robots").glob("*.urdf")):
            for part, unit in parts.items():
                with self.subTest(part=part, arm=arm.name):
                    out = self.folder / arm.stem / Path(part).name.replace(".", "_").lower()
                    result = self.init(data / "parts" / part, "--arm", arm, "--out", out, *unit)
                    self.assertEqual(result.returncode, 0, result.stderr)
                    planned = run("plan", out / "job.yaml", "-q")
                    self.assertEqual(planned.returncode, 0, planned.stdout)


if __name__ == "__main__":
    unittest.main(argv=["init_test"], verbosity=1)
