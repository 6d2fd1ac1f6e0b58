#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""What a plan over an earlier one works out again, stage by stage: no more than what a change reaches, and the files are
those of --fresh whatever was kept. Usage: stages_test.py MILLPOSE TOP"""
import json
import re
import shutil
import unittest

import resolved_yaml
from cli_fixture import FEW, TOP, InFolder, plan, run, tree

PROGRAMS = {"programs-krl", "programs-sinumerik", "programs-linuxcnc"}
RUNS = {"runs-krl", "runs-sinumerik", "runs-linuxcnc"}  # cuts that were confirmed
OF_PLAN = {"ends", "fixed", "choices", "base-window"} | PROGRAMS | RUNS  # what follows from all passes


class Stages(InFolder):
    def setUp(self):
        super().setUp()
        self.assertEqual(plan(self.folder / "sample").returncode, 0)
        self.job, self.cell = (resolved_yaml.parse((self.folder / "sample" / name).read_text())
                               for name in ("job.yaml", "cell.yaml"))
        shutil.copy(TOP / "toolpaths" / "support_pad" / "support_pad.stl", self.folder)
        self.job["cell"] = "cell.yaml"
        self.cell["tool"]["tip_uncertainty_mm"] = 0.2
        self.plan()
        self.made = self.stages()

    def plan(self, out="out", *arguments):
        (self.folder / "job.yaml").write_text(json.dumps(self.job))
        (self.folder / "cell.yaml").write_text(json.dumps(self.cell))
        done = run("plan", self.folder / "job.yaml", "-o", self.folder / out, "-q", *arguments)
        self.assertLess(done.returncode, 2, done.stderr)

    def stages(self):
        """When each stage was last worked out, those of a pass together; points that are inserted (`finer-N`) come and go
        with the passes."""
        made = {}
        for path in (self.folder / "out" / "checkpoints").glob("*.stage"):
            if not path.stem.startswith("finer-") and not path.stem.endswith(".earlier"):
                stage = re.sub(r"-[0-9]+$", "", path.stem)
                made[stage] = max(made.get(stage, 0), path.stat().st_mtime_ns)
        return made

    def check(self, again):
        """Plans as the job is now; `again` names the stages that are worked out anew."""
        self.plan()
        made = self.stages()
        self.assertEqual({stage for stage in made if made[stage] != self.made.get(stage)}, again)
        self.made = made
        self.plan("fresh", "--fresh")
        old, new = tree(self.folder / "out"), tree(self.folder / "fresh")
        self.assertEqual([name for name in old.keys() | new.keys() if old.get(name) != new.get(name)], [])

    def test_each_change_reaches_its_own_stages(self):
        self.assertLessEqual(OF_PLAN | {"toolpath"}, set(self.made))
        self.cell["tool"]["tip_uncertainty_mm"] = 0.3  # for reports alone
        self.check(set())
        self.cell["controllers"]["krl"]["advance"] = 2
        self.check({"programs-krl", "base-window"})  # the window is that of the first controller
        self.job["program_options"]["path_tolerance_mm"] = 0.03
        self.check(PROGRAMS | RUNS | {"base-window"})
        for tolerance in (0.02, 0.03):  # undone and done again: what an edit replaced is there
            self.job["program_options"]["path_tolerance_mm"] = tolerance
            self.check(set())
        self.job["gaps"]["retract_mm"] = 40
        self.check(OF_PLAN)
        self.job["toolpath"]["rotation_reference"] = [0, 0.1, 1]  # which is laid anew, and every pass with it
        self.check(set(self.made))

    def test_a_clamp_moved_far_from_everything_reaches_no_stage(self):
        """But the window of $BASE, which moves the part itself. Heads of programs name the new inputs all the same."""
        clamp = {"name": "clamp", "class": "fixture", "mount": "world", "shape": {"box": {"size_mm": [60, 60, 60]}}}
        self.cell["bodies"].append(clamp)
        pairs = {"nearest-pairs"} & set(self.made)
        for place, again in (([-3000, 0, 50], OF_PLAN | pairs), ([-3000, 1500, 50], {"base-window"}),
                             ([-3000, 0, 50], set())):
            clamp["pose"] = {"xyz_mm": place}
            self.check(again)

    def test_what_is_damaged_is_made_again(self):
        for stage in (self.folder / "out" / "checkpoints").glob("*.stage"):
            bytes_ = bytearray(stage.read_bytes())
            bytes_[len(bytes_) // 2] ^= 1
            stage.write_bytes(bytes_)
        self.made = self.stages()
        self.job["process"]["min_feed_share"] = 0.4
        self.check(set(self.made))

    def test_a_moved_clamp_costs_the_passes_that_it_matters_to(self):
        """On the panel, whose passes lie far apart: kept are those that the clamp is too far from, before and after."""
        clamp = {"name": "clamp", "class": "fixture", "mount": "world", "shape": {"box": {"size_mm": [60, 60, 60]}}}
        bodies, kept = self.cell["bodies"], []
        for place in ([1300, -1400, 600], [1750, -620, 1000], [1750, -600, 1000], [1750, -620, 1000]):
            clamp["pose"] = {"xyz_mm": place}
            self.cell["bodies"] = [*bodies, clamp]
            (self.folder / "cell.yaml").write_text(json.dumps(self.cell))
            for out, more in (("panel", ()), ("fresh", ("--fresh",))):
                sets = (f"cell={self.folder / 'cell.yaml'}", "programs=[linuxcnc]", "toolpath.stepover_mm=90", "toolpath.spacing_mm=90")
                done = run("plan", TOP / "toolpaths/cabin_panel/job.yaml", "-o", self.folder / out, "-q", *more,
                           *(word for change in sets for word in ("--set", change)))
                self.assertLess(done.returncode, 2, done.stderr)
            old, new = tree(self.folder / "panel"), tree(self.folder / "fresh")
            self.assertEqual([name for name in old.keys() | new.keys() if old.get(name) != new.get(name)], [])
            kept.append(json.loads((self.folder / "panel" / "run.json").read_text())["resumed_passes"])
        passes = json.loads((self.folder / "panel" / "summary.json").read_text())["passes"]
        self.assertEqual(kept[0], 0)
        self.assertEqual(kept.pop(), passes, "put back where it was")
        for count in kept[1:]:
            self.assertGreater(count, passes / 4)
            self.assertLess(count, passes)


if __name__ == "__main__":
    unittest.main(argv=["stages_test"])
