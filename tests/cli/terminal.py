# SPDX-License-Identifier: GPL-3.0-or-later
"""A shell in a real terminal of a stated width, by tmux (packages-slow.txt): what a person sees there."""
import os
import re
import shlex
import subprocess
import time


class Terminal:
    def __init__(self, columns, folder):
        """`folder` holds the terminal's socket; the shell stands beside it."""
        self.columns, self.count = columns, 0
        folder.mkdir()
        self.environment = {**os.environ, "TMUX_TMPDIR": str(folder), "LC_ALL": "C.UTF-8"}
        self.environment.pop("TMUX", None)
        self.tmux("-f", "/dev/null", "new-session", "-d", "-x", columns, "-y", 50, "-c", folder.parent, "bash --norc --noprofile")

    def tmux(self, *arguments):
        done = subprocess.run(["tmux", "-L", "walk", *map(str, arguments)], capture_output=True, text=True, timeout=60, env=self.environment)
        if done.returncode != 0:
            raise RuntimeError(f"tmux {arguments[0]}: {done.stderr}")
        return done.stdout

    def close(self):
        self.tmux("kill-server")

    def type(self, *words, seconds=900):
        """(lines that a command leaves in the terminal, its exit status). A line that the terminal broke, because it was too wide, is one
        line here that is longer than `columns`."""
        self.count += 1
        begin, end = f"begin-{self.count}", f"end-{self.count}-"
        self.tmux("clear-history")
        self.tmux("send-keys", "-l", f"clear; echo {begin}; {shlex.join(map(str, words))}; echo {end}$?")
        self.tmux("send-keys", "Enter")
        deadline = time.monotonic() + seconds
        while time.monotonic() < deadline:
            lines = [line.rstrip() for line in self.tmux("capture-pane", "-p", "-J", "-S", "-").splitlines()]
            ends = [i for i, line in enumerate(lines) if re.fullmatch(end + r"\d+", line)]
            if ends and begin in lines:
                return lines[lines.index(begin) + 1:ends[0]], int(lines[ends[0]].removeprefix(end))
            time.sleep(0.2)
        raise AssertionError(f"no end of {words} in {seconds} s:\n" + "\n".join(lines))
