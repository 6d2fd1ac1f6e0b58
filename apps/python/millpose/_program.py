# SPDX-License-Identifier: GPL-3.0-or-later
"""The program as a process: where it is, how it is run, what it says when it fails."""
import json
import os
import pathlib
import re
import shutil
import subprocess
import tempfile
from dataclasses import dataclass


@dataclass(frozen=True)
class Message:
    """One thing that is wrong; file, line and column (from 1) are None where the program names none."""
    text: str
    file: str | None = None
    line: int | None = None
    column: int | None = None

    def __str__(self):
        place = ":".join(str(part) for part in (self.file, self.line, self.column) if part is not None)
        return f"{place}: {self.text}" if place else self.text


class MillposeError(Exception):
    """The program failed: `status` is its exit status, `messages` what it said."""

    def __init__(self, status, text):
        super().__init__(text)
        self.status = status
        self.messages = [_message(line) for line in text.splitlines() if line.strip()]


class InputError(MillposeError):
    """Bad input or usage (exit status 2)."""


class InternalError(MillposeError):
    """The program is at fault, or the machine gave it too little memory (exit status 3, or a signal)."""


class Interrupted(MillposeError):
    """Stopped by a signal (exit status 130); what was finished is kept."""


def _message(line):
    placed = re.fullmatch(r"(.+?):(\d+)(?::(\d+))?: (.*)", line)
    if placed:
        file, number, column, text = placed.groups()
        return Message(text, file, int(number), int(column) if column else None)
    return Message(line)


def program():
    """The program that is run: $MILLPOSE, else the clone that this file lies in, else `millpose` in PATH."""
    if os.environ.get("MILLPOSE"):
        return os.environ["MILLPOSE"]
    clone = pathlib.Path(__file__).resolve().parents[3] if len(pathlib.Path(__file__).resolve().parents) > 3 else None
    if clone and (clone / "packages.txt").is_file() and (clone / "millpose").is_file():
        return str(clone / "millpose")
    found = shutil.which("millpose")
    if not found:
        raise FileNotFoundError("no program millpose in PATH; set MILLPOSE to where it is")
    return found


def raise_for(status, errors):
    """Raises what the exit status asks for; `errors` is stderr with --json-progress."""
    if status in (0, 1):
        return
    texts = []
    for line in errors.splitlines():
        try:
            event = json.loads(line)
        except ValueError:
            texts.append(line)  # what was said before the options were read
            continue
        if isinstance(event, dict) and event.get("event") == "error":
            texts.append(event["message"])
    kind = {2: InputError, 130: Interrupted}.get(status, InternalError)
    raise kind(status, "\n".join(texts) or f"millpose ended with status {status}")


def run(*arguments, cwd=None, pass_fds=(), serve=None, on_progress=None):
    """Runs `millpose ARGUMENTS` and returns (exit status 0 or 1, stdout); raises MillposeError for others.

    `serve()` is called while the program runs, in this thread. `on_progress(event)` hears every event of
    --json-progress, a dict, when the program has ended or, without `serve`, as it comes."""
    with tempfile.TemporaryFile("w+", encoding="utf-8") as output, tempfile.TemporaryFile("w+", encoding="utf-8",
                                                                                        errors="replace") as spooled:
        process = subprocess.Popen([program(), "--json-progress", *map(str, arguments)], cwd=cwd, stdin=subprocess.DEVNULL,
                                   stdout=output, stderr=spooled if serve else subprocess.PIPE, text=True,
                                   encoding="utf-8", errors="replace", pass_fds=pass_fds)
        errors = []
        try:
            if serve:
                serve()
            else:
                for line in process.stderr:
                    errors.append(line)
                    _tell(line, on_progress)
            process.wait()
        except BaseException:  # also KeyboardInterrupt: no program is left behind
            process.terminate()
            process.wait()
            raise
        finally:
            if process.stderr:
                process.stderr.close()
        if serve:
            spooled.seek(0)
            errors = spooled.readlines()
            for line in errors:
                _tell(line, on_progress)
        raise_for(process.returncode, "".join(errors))
        output.seek(0)
        return process.returncode, output.read()


def _tell(line, on_progress):
    if on_progress is None:
        return
    try:
        event = json.loads(line)
    except ValueError:
        return
    on_progress(event)
