#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Measures how long `millpose plan` takes to end after Ctrl-C, at several moments of every stage (not a test: no clock
decides one). Usage: interrupt_times.py MILLPOSE JOB"""
import json
import signal
import subprocess
import sys
import tempfile
import time

MILLPOSE, JOB = sys.argv[1:3]
# Seconds after a stage has begun.
MOMENTS = {"read": (0, 0.02), "surface": (0, 0.005), "toolpath": (0, 0.01), "passes": (0.2, 3, 8), "gaps": (0.1, 0.6, 1.5),
           "programs": (0.05, 0.2, 0.4), "audit": (0.3, 3), "report": (0.2, 0.8)}


def interrupted(stage, delay, folder):
    """(seconds from the signal to the end, status); (None, status) when the stage was over before."""
    command = [MILLPOSE, "plan", JOB, "-o", folder, "--json-progress", "--audit"]
    with subprocess.Popen(command, stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True) as process:
        for line in process.stderr:
            event = json.loads(line)
            if (event["event"], event.get("stage")) == ("begin", stage):
                break
        time.sleep(delay)
        if process.poll() is not None:
            return None, process.returncode
        began = time.monotonic()
        process.send_signal(signal.SIGINT)
        process.stderr.read()
        return round(time.monotonic() - began, 3), process.wait()


with tempfile.TemporaryDirectory(prefix="millpose-interrupt.") as folder:
    for stage, delays in MOMENTS.items():
        for delay in delays:
            print(stage, delay, *interrupted(stage, delay, f"{folder}/out"), flush=True)
