#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The table of docs/fixed-rotation.md: plans beside the best fixed rotation of the job and of each pass.
Usage: fixed_rotation_table.py MILLPOSE TOP [--write]. Status 1 where a plan is worse than a fixed rotation in the worst value that
it was planned for, or where the page's table is another; with --write the page gets the table."""
import json
import math
import subprocess
import sys
import tempfile
from pathlib import Path

MARK = "<!-- made by tests/docs/fixed_rotation_table.py -->\n"
FACES = "\nPlanned for `face_error`, beside the rotations that are best for its points ([face-error.md](face-error.md)):\n\n"
SHALLOW = ["--set", "toolpath.region.facing.within_deg=60", "--set", "toolpath.region.rim_distance_mm=0"]
PARTS = [("support_pad", "support_pad", [], None), ("cabin_panel", "cabin_panel", [], None), ("ur10e_pad", "ur10e_pad", [], None),
         ("cabin_ring, step-over 60 mm", "cabin_ring", ["--set", "toolpath.stepover_mm=60"], None),
         ("dome, R 800 mm, Ø 400 mm", "cabin_panel", SHALLOW, lambda x, y: math.sqrt(800**2 - x * x - y * y) - 800),
         ("saddle, 400 × 400 mm, ±15 mm", "cabin_panel", SHALLOW, lambda x, y: 15 * (x * x - y * y) / 200**2),
         ("skin, R 600 mm, 400 × 400 mm", "cabin_panel", SHALLOW, lambda x, y: math.sqrt(600**2 - y * y) - 600)]
GOALS = [("before: chen2021, sum", ["--set", "pose.objective.name=chen2021", "--set", "path.criterion=sum"]),
         ("surface_error", ["--set", "pose.objective.name=surface_error", "--set", "path.criterion=worst_then_sum"]),
         ("process_force", ["--set", "pose.objective.name=process_force", "--set", "path.criterion=worst_then_sum"])]


def sheet(height):
    """A sheet of 400 × 400 mm as OFF, z up."""
    count = 40
    side = range(count + 1)
    vertices = [(400 * i / count - 200, 400 * j / count - 200) for j in side for i in side]
    faces = []
    for j in range(count):
        for i in range(count):
            a = j * (count + 1) + i
            faces += [(a, a + 1, a + count + 2), (a, a + count + 2, a + count + 1)]
    return (f"OFF\n{len(vertices)} {len(faces)} 0\n" + "".join(f"{x} {y} {height(x, y):.9g}\n" for x, y in vertices)
            + "".join("3 {} {} {}\n".format(*face) for face in faces))


def figures(millpose, job, arguments, folder):
    out = folder / "out"
    run = subprocess.run([millpose, "plan", job, "-o", out, "-q", "--fresh", "--set", "programs=[]", *arguments], capture_output=True,
                         text=True)
    if run.returncode > 1:
        sys.exit(run.stderr)
    return json.loads((out / "summary.json").read_text())


def ratio(fixed, of, figure):
    entry = (fixed[of] or {}).get(figure)
    return entry["worst"]["ratio"] if entry else None


def cell(value):
    return "–" if value is None else f"{value:.3f}"


FACE = ["--set", "pose.objective.name=face_error"]


def face_row(part, summary):
    """What lost motion leaves under face_error: the plan, the job's best rotation, each pass's."""
    fixed = summary["fixed_rotation"]
    of = [fixed["plan_reversals"], *((fixed[which] or {}).get("reversals") for which in ("job", "passes"))]
    values = [f"{one[key]:.0f}" if one else "–" for key in ("largest_error_um", "marks_sum_um") for one in of]
    return f"| {part} | " + " | ".join(values) + " |\n", [one["largest_error_um"] for one in of if one]


def main():
    millpose, top, write = sys.argv[1], Path(sys.argv[2]), "--write" in sys.argv
    lines = ["| part | planned for | points | worst of that ÷ job's rotation | ÷ each pass's | worst \\|nᵀcF\\| ÷ job's | ÷ passes' | "
             "worst \\|cF\\| ÷ job's best in \\|cF\\| | ÷ passes' best in it |\n", "|---|---|---|---|---|---|---|---|---|\n"]
    faces = ["| part | lost motion, largest µm: plan | job's rotation | each pass's | marks, summed µm: plan | job's rotation | each pass's |\n",
             "|---|---|---|---|---|---|---|\n"]
    worse = []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for part, sample, arguments, height in PARTS:
            job = top / "toolpaths" / sample / "job.yaml"
            if height:
                (folder / "part.off").write_text(sheet(height))
                arguments = [*arguments, "--set", f"workpiece.mesh={folder / 'part.off'}"]
            for goal, settings in GOALS:
                summary = figures(millpose, job, [*arguments, *settings], folder)
                fixed = summary["fixed_rotation"]
                values = [ratio(fixed, of, figure) for figure in ("objective", "normal") for of in ("job", "passes")]
                values += [ratio(fixed, of, "length") for of in ("job_by_length", "passes_by_length")]
                lines.append(f"| {part} | {goal} | {fixed['points']} | " + " | ".join(map(cell, values)) + " |\n")
                if not goal.startswith("before"):
                    worse += [f"{part}, {goal}: {value:.4f}" for value in values[:2] if value is not None and value > 1 + 1e-6]
            if sample == "ur10e_pad":  # of whose gears no lost motion is published
                continue
            row, largest = face_row(part, figures(millpose, job, [*arguments, *FACE], folder))
            faces.append(row)
            # By lost motion alone: what a force adds within the same limit may cost as much.
            worse += [f"{part}, face_error: {largest[0]:.1f} µm" for other in largest[1:] if largest[0] > 1.05 * other]
    table = MARK + "".join(lines) + FACES + "".join(faces)
    page = top / "docs" / "fixed-rotation.md"
    text = page.read_text()
    begin = text.index(MARK)
    end = text.find("\n\n", text.index(FACES, begin) + len(FACES) if FACES in text else begin)
    end = len(text) if end < 0 else end + 1
    if write:
        page.write_text(text[:begin] + table + text[end:])
    elif text[begin:end] != table:
        print("docs/fixed-rotation.md has another table than:\n" + table)
        return 1
    print(table)
    for one in worse:
        print("worse than a fixed rotation:", one)
    return 1 if worse else 0


if __name__ == "__main__":
    sys.exit(main())
