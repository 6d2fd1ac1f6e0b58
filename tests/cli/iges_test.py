#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""IGES written here, byte by byte: a block of six trimmed surfaces that share no edge. Usage: iges_test.py MILLPOSE TOP"""
import json
import random
import unittest

from cli_fixture import InFolder, run

X, Y, Z = 100, 60, 20
FACES = [[(0, 0, 0), (0, Y, 0), (X, 0, 0), (X, Y, 0)], [(0, 0, Z), (X, 0, Z), (0, Y, Z), (X, Y, Z)],
         [(0, 0, 0), (X, 0, 0), (0, 0, Z), (X, 0, Z)], [(0, Y, 0), (0, Y, Z), (X, Y, 0), (X, Y, Z)],
         [(0, 0, 0), (0, 0, Z), (0, Y, 0), (0, Y, Z)], [(X, 0, 0), (X, Y, 0), (X, 0, Z), (X, Y, Z)]]


def section(letter, number, text):
    return f"{text:<72}{letter}{number:7d}\n"


def split(text, width):
    """At commas, as a number must not be broken."""
    while len(text) > width:
        end = text.rfind(",", 0, width) + 1
        yield text[:end]
        text = text[end:]
    yield text


def block(flag=2, unit="MM", scale=1.0, faces=FACES):
    entities = []  # type, parameters, whether another one holds it
    for corners in faces:
        bilinear = [128, 1, 1, 1, 1, 0, 0, 1, 0, 0, *[0., 0., 1., 1.] * 2, *[1.] * 4]
        places = [coordinate * scale for corner in corners for coordinate in map(float, corner)]
        entities.append((128, ",".join(map(str, [*bilinear, *places, 0., 1., 0., 1.])) + ";", True))
        entities.append((144, f"144,{2 * len(entities) - 1},0,0,0;", False))
    head = (f"1H,,1H;,5Hblock,5Hblock,4Htest,4Htest,32,38,6,308,15,5Hblock,1.,{flag},{len(unit)}H{unit},1,0.01,"
            "15H20260101.000000,1E-07,1000.,1Hx,1Hx,11,0,15H20260101.000000;")
    start = [section("S", 1, "block")]
    head = [section("G", i // 72 + 1, head[i:i + 72]) for i in range(0, len(head), 72)]
    directory, parameters = [], []
    for k, (kind, text, held) in enumerate(entities):
        lines, entry, first = list(split(text, 64)), 2 * k + 1, len(parameters) + 1
        status = "00010000" if held else "00000000"
        directory.append(f"{kind:8d}{first:8d}" + f"{0:8d}" * 6 + f"{status}D{entry:7d}\n")
        directory.append(f"{kind:8d}{0:8d}{0:8d}{len(lines):8d}{0:8d}{'':24}{0:8d}D{entry + 1:7d}\n")
        parameters += [f"{line:<64}{entry:8d}P{first + i:7d}\n" for i, line in enumerate(lines)]
    counts = f"S{len(start):7d}G{len(head):7d}D{len(directory):7d}P{len(parameters):7d}"
    return "".join([*start, *head, *directory, *parameters, section("T", 1, counts)])


class Iges(InFolder):
    def check(self, text, *more):
        (self.folder / "part.igs").write_bytes(text if isinstance(text, bytes) else text.encode("ascii"))
        return run("check", self.folder / "part.igs", "--json", "-q", *more)

    def test_surfaces_become_a_closed_part_in_the_files_unit(self):
        for flag, unit, factor in ((2, "MM", 1), (1, "IN", 25.4), (10, "CM", 10), (6, "M", 1000)):
            done = self.check(block(flag, unit, 1 / factor))
            self.assertLess(done.returncode, 2, done.stderr)
            found = json.loads(done.stdout)
            self.assertEqual(found["unit_mm"], factor)
            self.assertEqual((found["pieces"], found["closed_pieces"], found["rims"], len(found["bodies"])), (1, 1, 0, 1), unit)
            self.assertAlmostEqual(found["area_mm2"], 2 * (X * Y + Y * Z + X * Z), 4)
            for got, want in zip(found["lower_mm"] + found["upper_mm"], (0, 0, 0, X, Y, Z)):
                self.assertAlmostEqual(got, want, 6)
            normals = sorted(tuple(round(x) for x in face["normal"]) for face in found["step_faces"])
            self.assertEqual(normals, [(-1, 0, 0), (0, -1, 0), (0, 0, -1), (0, 0, 1), (0, 1, 0), (1, 0, 0)])
            # An entity's number is that of its line in the directory; the surfaces stand at every fourth.
            self.assertEqual({face["id"] for face in found["step_faces"]}, {f"#{4 * i + 3}" for i in range(6)})
        done = self.check(block(1, "IN", 1 / 25.4), "--unit", "mm")
        self.assertEqual(done.returncode, 2)
        self.assertIn("the file states that its unit is 25.4 mm, given 1 mm", done.stderr)

    def test_a_missing_face_is_a_rim_and_gaps_are_not_sewn(self):
        found = json.loads(self.check(block(faces=FACES[:5])).stdout)
        self.assertEqual((found["rims"], found["closed_pieces"]), (1, 0))
        moved = [[(x + 0.05, y, z) for x, y, z in FACES[5]] if i == 5 else face for i, face in enumerate(FACES)]
        self.assertGreater(json.loads(self.check(block(faces=moved)).stdout)["rims"], 0)

    def test_what_was_cut_off_is_no_smaller_part(self):
        sound = block()
        for share in (0.2, 0.5, 0.9):
            done = self.check(sound[:int(share * len(sound))])
            self.assertEqual(done.returncode, 2)
            self.assertIn("part.igs: the IGES file is cut off: its last section (T) is missing", done.stderr)
        lines = sound.splitlines(keepends=True)
        done = self.check("".join(lines[:20] + lines[21:]))
        self.assertEqual(done.returncode, 2)
        self.assertRegex(done.stderr, 'the IGES file is damaged: its last line states "D +24", and section D has 23 lines')
        done = self.check(block(3, "3HFUR"))
        self.assertEqual(done.returncode, 2)
        self.assertIn("the IGES file states unit flag 3; read are 1 (in), 2 (mm), 4 to 11", done.stderr)

    def test_damage_is_an_error_or_a_part(self):
        sound, stream = block().encode("ascii"), random.Random(11)
        for i in range(12):
            damaged = bytearray(sound)
            for _ in range(3):
                damaged[stream.randrange(81, len(sound))] = stream.randrange(32, 127)
            done = self.check(bytes(damaged))
            self.assertIn(done.returncode, (0, 1, 2), (i, done.stderr))


if __name__ == "__main__":
    unittest.main(argv=["iges_test"])
