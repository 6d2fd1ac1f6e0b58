# SPDX-License-Identifier: GPL-3.0-or-later
"""How long a printed page is."""
import re
import zlib


def pages_of(pdf):
    """How many pages a PDF of weasyprint has; its objects may stand in compressed streams."""
    parts = [pdf]
    for stream in re.findall(rb"stream\r?\n(.*?)\r?\nendstream", pdf, re.S):
        try:
            parts.append(zlib.decompress(stream))
        except zlib.error:
            continue
    return sum(len(re.findall(rb"/Type\s*/Page\b(?!s)", part)) for part in parts)
