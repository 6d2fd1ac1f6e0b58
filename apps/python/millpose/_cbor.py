# SPDX-License-Identifier: GPL-3.0-or-later
"""CBOR (RFC 8949), as much of it as plan.cbor.gz has."""
import struct


def decode(data):
    """The one item that `data` is. Raises ValueError for anything else."""
    try:
        value, end = _item(memoryview(data), 0)
    except (IndexError, struct.error, UnicodeDecodeError) as error:
        raise ValueError("not CBOR, or cut off") from error
    if end != len(data):
        raise ValueError("something follows the end")
    return value


def _item(data, at):
    major, info = data[at] >> 5, data[at] & 31
    at += 1
    if major == 7 and info in (20, 21):
        return info == 21, at
    if major == 7 and info in (25, 26, 27):
        form = {25: ">e", 26: ">f", 27: ">d"}[info]
        return struct.unpack_from(form, data, at)[0], at + struct.calcsize(form)
    if major not in (0, 1, 3, 4, 5) or info > 27:
        raise ValueError(f"an item of kind {major}.{info}, which plans do not have")
    number = info
    if info >= 24:
        form = {24: ">B", 25: ">H", 26: ">I", 27: ">Q"}[info]
        number = struct.unpack_from(form, data, at)[0]
        at += struct.calcsize(form)
    if major == 0:
        return number, at
    if major == 1:
        return -1 - number, at
    if major == 3:
        if at + number > len(data):
            raise ValueError("cut off")
        return str(data[at:at + number], "utf-8"), at + number
    values = []
    for _ in range(number if major == 4 else 2 * number):
        value, at = _item(data, at)
        values.append(value)
    return (values, at) if major == 4 else (dict(zip(values[::2], values[1::2])), at)
