#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs the examples of docs/python.md in their order and compares what they print with the block below each: shown lines must be
printed, lines that begin with a shown one count. usage: python_page_test.py MILLPOSE TOP"""
import contextlib
import io
import os
import pathlib
import re
import shutil
import sys
import tempfile

MILLPOSE, TOP = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
os.environ["MILLPOSE"] = str(MILLPOSE)
sys.path.insert(0, str(TOP / "apps/python"))


def main():
    page = (TOP / "docs/python.md").read_text(encoding="utf-8")
    examples = re.findall(r"```python\n(.*?)```\n```\n(.*?)```", page, re.DOTALL)
    if len(examples) < 5 or page.count("```python") != len(examples):
        sys.exit(f"{len(examples)} examples with what they print; every example has some")
    names, failed = {}, []
    with tempfile.TemporaryDirectory() as folder:
        for name in ("cells", "toolpaths"):
            shutil.copytree(TOP / name, pathlib.Path(folder, name), ignore=shutil.ignore_patterns("*.out"))
        os.chdir(folder)
        for code, shown in examples:
            printed = io.StringIO()
            with contextlib.redirect_stdout(printed):
                exec(compile(code, "docs/python.md", "exec"), names)  # pylint: disable=exec-used
            lines = printed.getvalue().splitlines()
            for line in shown.splitlines():
                if not any(one.startswith(line) for one in lines):
                    failed.append(f"shown: {line}\nprinted:\n" + "\n".join(lines))
        os.chdir("/")
    sys.exit("\n".join(failed) or 0)


main()
