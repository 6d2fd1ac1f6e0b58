# SPDX-License-Identifier: GPL-3.0-or-later
"""Stiffness in poses and over planes, by `millpose stiffness`."""
import json
import os
import tempfile
from dataclasses import dataclass

import numpy as np

from ._program import run


@dataclass(frozen=True)
class Stiffness:
    """In n poses: arrays begin with n, or lack it where one pose was asked for. Robot base frame; NaN where a pose
    is singular. Meaning of each: docs/stiffness.md."""
    joints_deg: np.ndarray
    origin_mm: np.ndarray  # where it holds
    normal: np.ndarray
    compliance: np.ndarray  # 6 x 6; blocks mm/N, 1/N; 1/N, rad/(N mm)
    stiffness: np.ndarray  # 6 x 6; blocks N/mm, N; N, N mm/rad
    lambda_mm_n: np.ndarray  # the three semi-axes
    lambda_t1_mm_n: np.ndarray
    lambda_t2_mm_n: np.ndarray
    lambda_n_mm_n: np.ndarray
    mu: np.ndarray
    normal_deflection_mm_n: np.ndarray
    in_plane_deflection_mm_n: np.ndarray
    worst_in_plane_mm_n: np.ndarray
    dexterity: np.ndarray

    @property
    def stiffness_n_per_um(self):
        """Along the normal."""
        return 1e-3 / self.normal_deflection_mm_n


@dataclass(frozen=True)
class StiffnessMap:
    """Over a plane of tool tips, each in its best pose; NaN where none is reached."""
    index: str
    unit: str
    points_mm: np.ndarray  # (v, u, 3), robot base frame
    values: np.ndarray  # (v, u)
    rotations_deg: np.ndarray  # (v, u), about the tool axis
    joints_deg: np.ndarray  # (v, u, 6)


# Field of Stiffness -> key of the program's JSON.
_KEYS = {"joints_deg": "joints_deg", "origin_mm": "origin_mm", "normal": "normal", "compliance": "C", "stiffness": "K",
         "lambda_mm_n": "lambda", "lambda_t1_mm_n": "lambda_t1", "lambda_t2_mm_n": "lambda_t2", "lambda_n_mm_n": "lambda_n",
         "mu": "mu", "normal_deflection_mm_n": "normal_deflection", "in_plane_deflection_mm_n": "in_plane_deflection",
         "worst_in_plane_mm_n": "worst_in_plane", "dexterity": "dexterity"}


def stiffness(cell, joints_deg, *, normal=None, at=None):
    """Stiffness of a cell's arm with its tool in one pose, joints_deg of shape (6,), or in many, (n, 6).

    normal  of the milling plane, robot base frame, one for all or (n, 3); the tool axis of each pose by default
    at      tool_tip or flange; as the cell says by default"""
    joints = np.asarray(joints_deg, dtype=float)
    if joints.shape[-1:] != (6,) or joints.ndim > 2:
        raise ValueError(f"joints_deg has the shape {joints.shape}; allowed: (6,) or (n, 6)")
    many = np.atleast_2d(joints)
    names, rows = [f"a{i}_deg" for i in range(1, 7)], many
    words = ["stiffness", os.path.abspath(cell), "--json"]
    if normal is None:
        words += ["--axis", "tool"]
    else:
        rows = np.hstack([many, np.broadcast_to(np.asarray(normal, dtype=float), (len(many), 3))])
        names += ["nx", "ny", "nz"]
    if at is not None:
        words += ["--at", at]
    with tempfile.NamedTemporaryFile("w", suffix=".csv", encoding="ascii") as poses:
        poses.write(",".join(names) + "\n")
        poses.writelines(",".join(repr(float(number)) for number in row) + "\n" for row in rows)
        poses.flush()
        found = json.loads(run(*words, "--poses", poses.name)[1])["poses"]
    fields = {}
    for field, key in _KEYS.items():
        shape = {"compliance": (6, 6), "stiffness": (6, 6)}.get(field, ())
        values = [np.full(shape, np.nan) if pose[key] is None else pose[key] for pose in found]
        fields[field] = np.array(values, dtype=float)[0 if joints.ndim == 1 else slice(None)]
    return Stiffness(**fields)


def stiffness_map(cell, index, plane_mm, steps, *, tool_axis=None, normal=None, at=None, rotation_step_deg=5):
    """An index over a plane of tool tips.

    index     as `millpose stiffness --map` names it: dexterity, lambda_n, normal_deflection, chen2021, …
    plane_mm  (3, 3): corner, end of the first edge (u), end of the second (v), robot base frame
    steps     (u, v): steps along the two edges"""
    words = ["stiffness", os.path.abspath(cell), "--json", "--map", index, "--steps", *steps, "--rotation-step-deg",
             rotation_step_deg, "--plane", *np.asarray(plane_mm, dtype=float).reshape(9)]
    for option, vector in (("--tool-axis", tool_axis), ("--normal", normal)):
        if vector is not None:
            words += [option, *vector]
    if at is not None:
        words += ["--at", at]
    found = json.loads(run(*words)[1])
    shape = (steps[1] + 1, steps[0] + 1)

    def grid(key, width):
        empty = np.nan if width == 1 else [np.nan] * width
        values = [empty if point[key] is None else point[key] for point in found["points"]]
        return np.array(values, dtype=float).reshape(shape if width == 1 else (*shape, width))

    return StiffnessMap(found["index"], found["unit"], grid("point_mm", 3), grid("value", 1), grid("rotation_deg", 1),
                        grid("joints_deg", 6))
