# SPDX-License-Identifier: GPL-3.0-or-later
"""millpose from Python: runs the program `millpose` and reads what it writes. docs/python.md."""
from ._objective import INDICES
from ._plan import Plan, load, plan
from ._program import InputError, InternalError, Interrupted, Message, MillposeError, program, run
from ._stiffness import Stiffness, StiffnessMap, stiffness, stiffness_map

__all__ = ["INDICES", "InputError", "InternalError", "Interrupted", "Message", "MillposeError", "Plan", "Stiffness",
           "StiffnessMap", "load", "plan", "program", "run", "stiffness", "stiffness_map"]
