# SPDX-License-Identifier: GPL-3.0-or-later
"""Plans: made by the program, read from its output folder."""
import csv
import gzip
import json
import os
import pathlib
import tempfile
from functools import cached_property

import numpy as np

from ._cbor import decode
from ._objective import Served
from ._program import MillposeError, run


class Plan:
    """An output folder of `millpose plan`, read. One row per milling point; skipped points hold NaN.

    Positions and directions are in the world frame W, angles in the arm's own convention (docs/outputs.md)."""

    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        with open(self.folder / "summary.json", encoding="utf-8") as file:
            self.summary = json.load(file)
        with open(self.folder / "points.csv", encoding="utf-8", newline="") as file:
            rows = csv.reader(file)
            self.columns = next(rows)
            self._cells = list(zip(*rows)) or [()] * len(self.columns)

    def __len__(self):
        return len(self._cells[0])

    def texts(self, column):
        """A column of points.csv as it stands there."""
        return np.array(self._cells[self.columns.index(column)], dtype=str)

    def numbers(self, *columns):
        """Columns of points.csv as numbers, NaN where a cell is empty: (n,) of one, else (n, columns)."""
        cells = [[float(cell) if cell else np.nan for cell in self._cells[self.columns.index(column)]] for column in columns]
        return np.array(cells[0]) if len(columns) == 1 else np.array(cells).T.reshape(-1, len(columns))

    @cached_property
    def planned(self):
        """Whether each point is planned."""
        return self.texts("status") == "planned"

    @cached_property
    def kinds(self):
        """cut, lead-in or lead-out."""
        return self.texts("kind")

    @cached_property
    def passes(self):
        """Number of each point's pass."""
        return self.numbers("pass").astype(int)

    @cached_property
    def positions_mm(self):
        return self.numbers("x_mm", "y_mm", "z_mm")

    @cached_property
    def normals(self):
        """Unit vectors out of the material."""
        return self.numbers("nx", "ny", "nz")

    @cached_property
    def tool_axes(self):
        """Unit vectors from tip to holder."""
        return self.numbers("tx", "ty", "tz")

    @cached_property
    def feed_directions(self):
        return self.numbers("fx", "fy", "fz")

    @cached_property
    def feeds_mm_min(self):
        return self.numbers("feed_mm_min")

    @cached_property
    def arc_lengths_mm(self):
        """Along the pass."""
        return self.numbers("s_mm")

    @cached_property
    def joints_deg(self):
        """A1 … A6, full revolutions included."""
        return self.numbers(*(f"a{i}_deg" for i in range(1, 7)))

    @cached_property
    def external_axes(self):
        """What points.csv says of external axes, by column ("e1_mm", "e2_deg"); empty where there are none."""
        return {name: self.numbers(name) for name in self.columns if name in {f"e{i}_{unit}" for i in range(1, 7) for unit in ("mm", "deg")}}

    @cached_property
    def rotations_deg(self):
        """About the tool axis, from the pass's reference direction."""
        return self.numbers("rotation_deg")

    @cached_property
    def stiffness_n_per_um(self):
        """Along the surface normal: force along it for a displacement of 1 µm along it."""
        return 1e-3 / self.numbers("normal_compliance_mm_N")

    @cached_property
    def objective(self):
        """In the unit that summary["stiffness"]["units"]["objective"] names."""
        return self.numbers("objective")

    @cached_property
    def clearances_mm(self):
        return self.numbers("clearance_mm")

    @property
    def findings(self):
        """Why programs were withheld; empty where all were written."""
        return self.summary["findings"]

    @property
    def warnings(self):
        return self.summary["warnings"]

    @cached_property
    def document(self):
        """plan.cbor.gz, decoded (docs/plan-format.md): mm, rad, s, N; lists and dicts as they stand there."""
        return decode(gzip.decompress((self.folder / "plan.cbor.gz").read_bytes()))

    @cached_property
    def gaps_deg(self):
        """Joint angles along each motion between pieces, (n, 6) each, in the order of execution."""
        return [np.degrees(np.array(gap["joints"], dtype=float).reshape(-1, 6)) for gap in self.document["gaps"]]

    def __repr__(self):
        return f"<millpose.Plan {self.folder}: {int(self.planned.sum())} of {len(self)} points>"


def load(folder):
    """Reads an output folder. Raises FileNotFoundError where it holds no plan."""
    return Plan(folder)


def plan(job, output, *, folder=None, settings=None, objective=None, reads_force=False, threads=0, options=(),
         on_progress=None):
    """Plans a job into the folder `output` and reads the plan; raises MillposeError where there is none.

    job         path of a job file, or a dict with its keys, written as JSON (which is YAML)
    folder      of a dict: the folder that its file names are relative to; the current one by default
    settings    {key: value} in place of the job's, as --set: {"toolpath.stepover_mm": 4}
    objective   a function of a dict {index: values of some candidates} that returns a value for each, smaller is
                better; INDICES has the names, force_deflection_mm needs reads_force. Slow.
    threads     0: all cores
    options     further words of the command line
    on_progress hears every event of --json-progress, a dict"""
    words = ["-o", pathlib.Path(output).absolute(), "--threads", threads, *options]
    for key, value in (settings or {}).items():
        words += ["--set", f"{key}={value if isinstance(value, str) else _json(value)}"]
    if not isinstance(job, dict):
        _run(["plan", pathlib.Path(job).absolute(), *words], objective, reads_force, on_progress)
        return load(output)
    descriptor, path = tempfile.mkstemp(prefix=".millpose-", suffix=".yaml", dir=folder or ".", text=True)
    try:
        with open(descriptor, "w", encoding="utf-8") as file:
            file.write(_json(job, indent=1))
        _run(["plan", os.path.abspath(path), *words], objective, reads_force, on_progress)
    finally:
        os.unlink(path)
    return load(output)


def _json(value, **options):
    """JSON, numpy's arrays and numbers too."""
    return json.dumps(value, allow_nan=False, default=lambda other: other.tolist(), **options)


def _run(words, objective, reads_force, on_progress):
    if objective is None:
        run(*words, on_progress=on_progress)
        return
    served = Served(objective, reads_force)
    try:
        run(*words, *served.arguments, pass_fds=served.pass_fds, serve=served.serve, on_progress=on_progress)
    except MillposeError:
        if served.error is not None:
            raise served.error from None
        raise
    finally:
        served.close()
