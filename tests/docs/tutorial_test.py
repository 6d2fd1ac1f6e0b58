#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs a page of docs: writes the files that it shows, runs its commands and compares what they print.

usage: tutorial_test.py MILLPOSE PAGE [--renew]

In blocks named `console` a line "$ …" is a command, the lines below it are its output; a line "…" stands for any number of
lines. Any other block is the file whose name in backticks came last before it. --renew writes the outputs anew."""
import os
import pathlib
import re
import subprocess
import sys
import tempfile

MILLPOSE, PAGE = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
RENEW = "--renew" in sys.argv[3:]


def blocks(lines):
    """Yields (kind, first line, one behind the last, indent) of each fenced block."""
    begin = None
    for i, line in enumerate(lines):
        fence = re.match(r"^( *)```(\w*)\s*$", line)
        if fence and begin is None:
            begin, kind, indent = i + 1, fence[2], fence[1]
        elif fence:
            yield kind, begin, i, indent
            begin = None


def steady(text):
    """Times differ from run to run."""
    return [line for line in text.rstrip("\n").split("\n") if not line.startswith("time  ")] if text else []


def matches(shown, printed):
    """Whether the printed lines are the shown ones, "…" standing for any number."""
    if not shown:
        return not printed
    if shown[0] == "…":
        return any(matches(shown[1:], printed[i:]) for i in range(len(printed) + 1))
    return bool(printed) and shown[0] == printed[0] and matches(shown[1:], printed[1:])


def run(command, folder):
    path = f"{MILLPOSE.parent}:{os.environ['PATH']}"
    done = subprocess.run(["bash", "-c", command], cwd=folder, capture_output=True, text=True, timeout=300,
                          env={**os.environ, "PATH": path, "LC_ALL": "C"})
    # Progress is for terminals; messages of failed commands are shown.
    return done.stdout + (done.stderr if done.returncode not in (0, 1) else "")


def main():
    lines = PAGE.read_text().split("\n")
    commands, failed, output = 0, [], []
    with tempfile.TemporaryDirectory() as folder:
        at = 0
        for kind, begin, end, indent in list(blocks(lines)):
            output += lines[at:begin]
            block = [line.removeprefix(indent) for line in lines[begin:end]]
            if kind != "console":
                name = re.findall(r"`([\w.-]+)`", " ".join(lines[:begin - 1]))[-1]
                (pathlib.Path(folder) / name).write_text("\n".join(block) + "\n")
                output += lines[begin:end]
            else:
                starts = [i for i, line in enumerate(block) if line.startswith("$ ")] + [len(block)]
                for first, last in zip(starts, starts[1:]):
                    command, shown = block[first][2:], block[first + 1:last]
                    printed = steady(run(command, folder))
                    commands += 1
                    if not matches(shown, printed):
                        failed.append(f"$ {command}\n-- shown\n" + "\n".join(shown) + "\n-- printed\n" + "\n".join(printed))
                        shown = printed
                    output += [indent + line for line in [block[first], *shown]]
            at = end
    output += lines[at:]
    if RENEW:
        PAGE.write_text("\n".join(output))
        return
    if failed or commands < 8:
        sys.exit("\n".join(failed) or f"only {commands} commands found")
    print(f"{commands} commands print what {PAGE.name} shows")


main()
