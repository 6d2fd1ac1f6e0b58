# SPDX-License-Identifier: GPL-3.0-or-later
"""The arrays of path.vtp: XML with base64 of blocks that zlib packed."""
import base64
import struct
import xml.etree.ElementTree as xml
import zlib


def numbers(array):
    text = array.text.strip()
    blocks = struct.unpack("<Q", base64.b64decode(text[:12])[:8])[0]
    length = (8 * (3 + blocks) + 2) // 3 * 4
    sizes = struct.unpack(f"<{3 + blocks}Q", base64.b64decode(text[:length]))[3:]
    data, values, at = base64.b64decode(text[length:]), b"", 0
    for size in sizes:
        values += zlib.decompress(data[at:at + size])
        at += size
    return list(struct.unpack(f"<{len(values) // 8}" + ("q" if array.get("type") == "Int64" else "d"), values))


def arrays(data):
    """The attributes of <Piece>, and {"Lines": {"offsets": [...]}}."""
    piece = xml.fromstring(data).find("PolyData/Piece")
    return piece.attrib, {part.tag: {array.get("Name"): numbers(array) for array in part} for part in piece}
