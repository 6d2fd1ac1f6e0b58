#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Does by debootstrap and chroot what docs/Containerfile asks a container runtime for, then plans a sample. usage: container_test.py TOP"""
import json
import os
import pathlib
import shlex
import shutil
import subprocess
import sys
import tempfile
import unittest

TOP = pathlib.Path(sys.argv[1]).resolve()
MIRROR = os.environ.get("MILLPOSE_DEBIAN_MIRROR", "http://deb.debian.org/debian")
ENVIRONMENT = {"PATH": "/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin", "DEBIAN_FRONTEND": "noninteractive",
               "LC_ALL": "C", "HOME": "/root"}
RELEASES = {"docker.io/library/debian:12": "bookworm"}


def run(*command, **options):
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True, **options)
    if done.returncode != 0:
        raise AssertionError(f"{' '.join(map(str, command))}: status {done.returncode}\n{done.stdout[-4000:]}\n{done.stderr[-4000:]}")
    return done.stdout


class Stages:
    """The roots of a Containerfile's stages, one folder each."""

    def __init__(self, folder):
        self.folder, self.roots, self.names, self.entry, self.clean = folder, [], {}, None, {}

    def do(self, line):
        word, _, rest = line.partition(" ")
        getattr(self, "on_" + word.lower())(rest)  # an instruction that is not known here fails the test

    def on_from(self, rest):
        image, *named = rest.split()
        root = self.folder / f"root{len(self.roots)}"
        if image not in self.clean:
            self.clean[image] = self.folder / "clean"
            run("debootstrap", "--variant=minbase", RELEASES[image], self.clean[image], MIRROR)
        run("cp", "-a", self.clean[image], root)
        self.roots.append(root)
        if named:
            self.names[named[1]] = root

    def on_copy(self, rest):
        *options, source, target = rest.split()
        to = self.roots[-1] / target.lstrip("/")
        if options:
            place = self.names[options[0].removeprefix("--from=")]
            [found] = place.glob(source.lstrip("/"))
            shutil.copy(found, to)
            return
        for name in run("git", "-C", TOP, "ls-files", "-z").split("\0"):  # a clone, without what was built in it
            if name and (TOP / name).is_file():
                (to / name).parent.mkdir(parents=True, exist_ok=True)
                shutil.copy(TOP / name, to / name)

    def on_run(self, rest):
        run("chroot", self.roots[-1], "sh", "-c", rest, env=ENVIRONMENT)

    def on_workdir(self, rest):
        (self.roots[-1] / rest.lstrip("/")).mkdir(parents=True, exist_ok=True)

    def on_entrypoint(self, rest):
        self.entry = json.loads(rest)


class Container(unittest.TestCase):
    def test_what_the_container_file_makes_plans_a_sample(self):
        self.assertEqual(os.geteuid(), 0, "debootstrap and chroot need root")
        # A root of gigabytes, with devices: nothing for memory.
        with tempfile.TemporaryDirectory(prefix="millpose_container_", dir="/var/tmp") as folder:
            stages = Stages(pathlib.Path(folder))
            for line in (TOP / "docs" / "Containerfile").read_text().splitlines():
                if line and not line.startswith("#"):
                    stages.do(line)
            root = stages.roots[-1]
            command = shlex.join([*stages.entry, "plan", "--quiet", "/work/job/toolpaths/support_pad/job.yaml", "-o", "/work/out"])
            run("chroot", root, "sh", "-c", "cp -r /usr/share/millpose /work/job && " + command, env=ENVIRONMENT)
            summary = json.loads((root / "work/out/summary.json").read_text())
            self.assertEqual(summary["points"]["planned"], summary["points"]["total"])
            self.assertGreater(summary["points"]["total"], 100)
            self.assertTrue(all(p["verified"] for p in summary["programs"]))
            # The clone of the first stage runs as well.
            first = stages.roots[0]
            said = run("chroot", first, "sh", "-c", "cd /src && ./millpose -V", env=ENVIRONMENT)
            self.assertTrue(said.startswith("millpose "), said)


if __name__ == "__main__":
    unittest.main(argv=["container_test"], verbosity=2)
