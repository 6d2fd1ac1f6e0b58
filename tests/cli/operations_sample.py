# SPDX-License-Identifier: GPL-3.0-or-later
"""The sample of several operations, cut down to few points; with MILLPOSE_SLOW=1 whole."""
import os
import re

from cli_fixture import TOP

SLOW = os.environ.get("MILLPOSE_SLOW") == "1"
SAMPLE = (TOP / "toolpaths" / "cabin_window" / "job.yaml").read_text()
CELL = (TOP / "cells" / "kr500_two_tools.yaml").read_text()
FOLDERS = ("01_face_pads", "02_trim_window", "03_drill_holes")
CUTS = [(r"stepover_mm: 14", "stepover_mm: 60"), (r"spacing_mm: 12", "spacing_mm: 40"), (r"per_depth_mm: 5", "per_depth_mm: 20"),
        (r"spacing_mm: 25", "spacing_mm: 80"), (r"(?:          - \{at_mm: .*\n){4}", ""), (r"tabs: \{count: 4", "tabs: {count: 1"),
        (r"chord_tolerance_mm: 0.02", "chord_tolerance_mm: 0.05"), (r"\noperations:", r"\npath: {rotation_step_deg: 20}\noperations:")]


def small(text=SAMPLE):
    """The sample with few points, its part and its cell found from anywhere."""
    for pattern, replacement in [] if SLOW else CUTS:
        text, count = re.subn(pattern, replacement, text, count=1)
        assert count == 1, pattern
    return text.replace("../cabin_panel", str(TOP / "toolpaths" / "cabin_panel")).replace("../../cells/kr500_two_tools.yaml", "cell.yaml")
