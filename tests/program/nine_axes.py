# SPDX-License-Identifier: GPL-3.0-or-later
"""LinuxCNC's own interpreter for a machine with nine axes: rs274 itself knows X, Y, Z, A, B, C alone. Prints its canonical
calls as rs274 does, with nine numbers, mm and degrees. Usage: nine_axes.py PROGRAM"""
import sys

import gcode

INCH = 25.4  # its lengths are inches


class Canon:
    parameter_file = "machine.var"

    def __getattr__(self, name):
        return lambda *arguments: 0

    def next_line(self, state):
        pass

    def get_axis_mask(self):
        return 0x1ff

    def get_external_angular_units(self):
        return 1.0

    def get_external_length_units(self):
        return 1.0

    def get_tool(self, _):
        return (-1, *[0.0] * 12, 0)

    def check_abort(self):
        return False

    def set_feed_rate(self, rate):
        print(f"SET_FEED_RATE({rate * INCH:.4f})")

    def straight_traverse(self, *axes):
        self.straight("STRAIGHT_TRAVERSE", axes)

    def straight_feed(self, *axes):
        self.straight("STRAIGHT_FEED", axes)

    @staticmethod
    def straight(call, axes):
        x, y, z, a, b, c, u, v, w = axes
        numbers = (x * INCH, y * INCH, z * INCH, a, b, c, u * INCH, v * INCH, w * INCH)
        print(f"{call}({', '.join(f'{number:.4f}' for number in numbers)})")


status, _ = gcode.parse(sys.argv[1], Canon(), "G21", "")
if status > gcode.MIN_ERROR:
    print(gcode.strerror(status))
    sys.exit(1)
