#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""usage: first_build_test.py TOP: what ./millpose shows while it compiles, in terminals of 80 and 50 columns, and that Ctrl-C stops
it and the same command goes on. cmake and ninja are stand-ins: forty steps of 20 ms."""
import fcntl
import os
import pathlib
import pty
import re
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import termios
import time
import unittest

TOP = pathlib.Path(sys.argv[1])
STEPS = 40
NINJA = f"""#!{sys.executable}
import os, pathlib, sys, time
state = pathlib.Path("state")
done = len(state.read_text()) if state.exists() else 0
if "-n" in sys.argv:
    print("ninja: no work to do." if done == {STEPS} else "[1/1] step")
    sys.exit()
try:
    for i in range(done, {STEPS}):
        time.sleep(0.02)
        state.write_text("x" * (i + 1))
        print(f"[{{i + 1 - done}}/{{{STEPS} - done}}] Building something with a long name in some folder", flush=True)
        if pathlib.Path("broken").exists():
            print("FAILED: file.cpp:1:1: error", flush=True)
            sys.exit(1)
except KeyboardInterrupt:
    print("ninja: build stopped: interrupted by user.", flush=True)
    sys.exit(130)
"""
CMAKE = "#!/bin/sh\nmkdir -p build/release\n: > build/release/build.ninja\n"
PROGRAM = "#!/bin/sh\necho the program: \"$@\"\n"


class FirstBuild(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.top = pathlib.Path(folder.name)
        for name in ("millpose", "apps/setup.sh"):
            (self.top / name).parent.mkdir(exist_ok=True)
            shutil.copy(TOP / name, self.top / name)
        (self.top / "packages.txt").write_text("bash\n")
        for name, text in (("bin/ninja", NINJA), ("bin/cmake", CMAKE), ("build/release/apps/millpose/millpose", PROGRAM)):
            (self.top / name).parent.mkdir(parents=True, exist_ok=True)
            (self.top / name).write_text(text)
            (self.top / name).chmod(0o755)

    def steps(self):
        return len((self.top / "state").read_text()) if (self.top / "state").exists() else 0

    def run_it(self, columns, stop_at=None):
        """What the terminal got, and the exit status."""
        ours, theirs = pty.openpty()
        fcntl.ioctl(theirs, termios.TIOCSWINSZ, struct.pack("HHHH", 24, columns, 0, 0))
        with subprocess.Popen(["./millpose", "plan", "job.yaml"], cwd=self.top, stdin=theirs, stdout=theirs, stderr=theirs, start_new_session=True,
                              env={**os.environ, "PATH": f"{self.top}/bin:{os.environ['PATH']}"}) as process:
            os.close(theirs)
            while stop_at and self.steps() < stop_at:
                time.sleep(0.01)
            if stop_at:
                os.killpg(process.pid, signal.SIGINT)  # as the terminal does it for Ctrl-C
            shown = b""
            while True:
                try:
                    shown += os.read(ours, 4096)
                except OSError:  # the other end is closed
                    break
        os.close(ours)
        return shown.decode(), process.returncode

    def test_counts_steps_within_the_terminal_and_ends_with_the_program(self):
        for columns in (80, 50):
            (self.top / "state").unlink(missing_ok=True)
            shown, status = self.run_it(columns)
            self.assertEqual(status, 0, shown)
            self.assertIn("the program: plan job.yaml", shown)
            counts = re.findall(rf"compiling, step (\d+) of {STEPS}, ", shown)
            self.assertEqual(counts, [str(i + 1) for i in range(STEPS)])
            for line in re.split(r"[\r\n]+", shown):
                if "step" in line:
                    self.assertLess(len(line), columns, "it would break, and each step leave a line")
            self.assertNotIn("Building something", shown)

    def test_ctrl_c_stops_it_and_the_same_command_goes_on(self):
        shown, status = self.run_it(80, stop_at=5)
        self.assertEqual(status, 130, shown)
        self.assertIn("stopped; the same command goes on from there", shown)
        self.assertNotIn("failed", shown)
        self.assertNotIn("Building something", shown)
        self.assertIn("interrupted by user", (self.top / "build/setup.log").read_text())
        before = self.steps()
        self.assertLess(before, STEPS)
        shown, status = self.run_it(80)
        self.assertEqual(status, 0, shown)
        self.assertIn(f"of {STEPS - before}, ", shown)

    def test_what_failed_is_shown_without_the_steps(self):
        (self.top / "broken").write_text("")
        shown, status = self.run_it(80)
        self.assertEqual(status, 3, shown)
        self.assertIn("FAILED: file.cpp:1:1: error", shown)
        self.assertIn("building failed", shown)
        self.assertNotIn("Building something", shown)


if __name__ == "__main__":
    unittest.main(argv=["first_build_test"])
