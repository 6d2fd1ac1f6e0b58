# SPDX-License-Identifier: GPL-3.0-or-later
"""An objective that is a Python function: the program asks for its values over two pipes."""
import fcntl
import hashlib
import inspect
import os

import numpy as np

#: What an objective may read, by name; the last one only with reads_force.
INDICES = ("lambda_t1_mm_N", "lambda_t2_mm_N", "lambda_n_mm_N", "mu", "normal_deflection_mm_N", "in_plane_deflection_mm_N",
           "worst_in_plane_mm_N", "axis_deflection_mm_N", "force_deflection_mm")
_DOUBLE = np.dtype("<f8")


def number_of(function):
    """A number below a million that tells functions apart by their source, for the settings of the plan."""
    try:
        text = inspect.getsource(function).encode()
    except (OSError, TypeError):
        text = getattr(getattr(function, "__code__", None), "co_code", repr(function).encode())
    return int.from_bytes(hashlib.sha256(text).digest()[:8], "big") % 999_983


class Served:
    """The two pipes of one run; `arguments` and `pass_fds` are for the program, serve() for this side."""

    def __init__(self, function, reads_force):
        self._function, self._names = function, INDICES if reads_force else INDICES[:-1]
        self._asked, theirs_out = os.pipe()
        theirs_in, self._answers = os.pipe()
        # A clone's ./millpose uses descriptors below 10 while it builds.
        self.pass_fds = tuple(fcntl.fcntl(low, fcntl.F_DUPFD_CLOEXEC, 20) for low in (theirs_in, theirs_out))
        for low in (theirs_in, theirs_out):
            os.close(low)
        theirs_in, theirs_out = self.pass_fds
        self.arguments = ("--objective-pipe", f"{theirs_in},{theirs_out}", "--fresh", "--set",
                          f"pose.objective={{name: piped, force: {'read' if reads_force else 'unread'}, "
                          f"function: {number_of(function)}}}")
        self.error = None

    def serve(self):
        """Answers until the program closes its side. An error of the function ends the program: see `error`."""
        for descriptor in self.pass_fds:
            os.close(descriptor)
        self.pass_fds = ()
        try:
            with open(self._asked, "rb") as asked, open(self._answers, "wb", buffering=0) as answers:
                self._asked = self._answers = None
                self._answer_all(asked, answers)
        except BrokenPipeError:
            pass  # the program has ended; its exit status says why
        except Exception as error:  # pipes are closed now, so the program ends
            self.error = error

    def _answer_all(self, asked, answers):
        greeting = asked.readline().decode("ascii").split()
        if not greeting:
            return
        if greeting[:2] != ["millpose-objective", "1"] or tuple(greeting[3:]) != INDICES:
            raise RuntimeError(f"the program speaks another protocol: {' '.join(greeting[:2])}")
        lanes = int(greeting[2])
        size = lanes * len(INDICES) * _DOUBLE.itemsize
        with np.errstate(all="ignore"):  # lanes without a pose hold what need not be finite
            while block := asked.read(size):
                if len(block) < size:
                    return
                rows = np.frombuffer(block, _DOUBLE).reshape(len(INDICES), lanes)
                values = np.asarray(self._function(dict(zip(self._names, rows))), dtype=float)
                answers.write(np.ascontiguousarray(np.broadcast_to(values, (lanes,)), _DOUBLE).tobytes())

    def close(self):
        for descriptor in (*self.pass_fds, self._asked, self._answers):
            if descriptor is not None:
                os.close(descriptor)
        self.pass_fds, self._asked, self._answers = (), None, None
