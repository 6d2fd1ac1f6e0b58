#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""3MF parts beside the same parts as STL. Usage: threemf_test.py MILLPOSE TOP"""
import json
import random
import struct
import unittest
import zipfile

from cli_fixture import InFolder, run

RELS = ('<?xml version="1.0" encoding="UTF-8"?>\n<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/'
        'relationships"><Relationship Target="/3D/part.model" Id="rel0" '
        'Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>')
CORNERS = [(x, y, z) for z in (0, 1) for y in (0, 1) for x in (0, 1)]
FACES = [(0, 2, 3), (0, 3, 1), (4, 5, 7), (4, 7, 6), (0, 1, 5), (0, 5, 4), (2, 6, 7), (2, 7, 3), (0, 4, 6), (0, 6, 2),
         (1, 3, 7), (1, 7, 5)]


def mesh(size, corners=CORNERS, faces=FACES):
    vertices = "\n".join(f'<vertex x="{x * size[0]}" y="{y * size[1]}" z="{z * size[2]}"/>' for x, y, z in corners)
    triangles = "\n".join(f'<triangle v1="{a}" v2="{b}" v3="{c}"/>' for a, b, c in faces)
    return f"<mesh><vertices>\n{vertices}\n</vertices><triangles>\n{triangles}\n</triangles></mesh>"


def model(objects, items, attributes='unit="millimeter"'):
    return (f'<?xml version="1.0" encoding="UTF-8"?>\n<model {attributes} xml:lang="en-US" '
            'xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02">\n'
            f"<resources>\n{objects}\n</resources>\n<build>{items}</build></model>")


BLOCK = f'<object id="3" type="model" name="block">{mesh((100, 60, 20))}</object>'


class ThreeMf(InFolder):
    def write(self, text, name="part.3mf", rels=RELS):
        path = self.folder / name
        with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
            archive.writestr("[Content_Types].xml", "<Types/>")
            archive.writestr("_rels/.rels", rels)
            if text is not None:
                archive.writestr("3D/part.model", text)
        return path

    def write_stl(self, size, name="part.stl"):
        facets = b"".join(struct.pack("<12fH", 0, 0, 0, *(c * s for corner in face for c, s in zip(CORNERS[corner], size)), 0)
                          for face in FACES)
        path = self.folder / name
        path.write_bytes(b"part".ljust(80) + struct.pack("<I", len(FACES)) + facets)
        return path

    def check(self, path, *more):
        done = run("check", path, "--json", "-q", *more)
        self.assertLess(done.returncode, 2, done.stderr)
        return json.loads(done.stdout)

    def refused(self, text, words, **options):
        done = run("check", self.write(text, **options), "-q")
        self.assertEqual(done.returncode, 2, done.stdout)
        self.assertIn("part.3mf: ", done.stderr)
        self.assertIn(words, done.stderr)

    def test_one_mesh_is_the_stl_of_it(self):
        threemf = self.check(self.write(model(BLOCK, '<item objectid="3"/>')))
        stl = self.check(self.write_stl((100, 60, 20)))
        for found in (threemf, stl):
            found.pop("file")
        self.assertEqual(threemf, stl)
        self.assertEqual((threemf["upper_mm"], threemf["closed_pieces"]), ([100, 60, 20], 1))

    def test_the_files_unit_counts(self):
        for unit, factor in (("inch", 25.4), ("meter", 1000), ("centimeter", 10), ("foot", 304.8), ("micron", 1e-3)):
            path = self.write(model(BLOCK, '<item objectid="3"/>', f'unit="{unit}"'))
            found = self.check(path)
            self.assertAlmostEqual(found["upper_mm"][0] / (100 * factor), 1, 12, unit)
        self.assertIn("unit \"micron\" was converted to mm", " ".join(found["warnings"]))
        inches = self.write(model(BLOCK, '<item objectid="3"/>', 'unit="inch"'))
        done = run("check", inches, "--unit", "mm", "-q")
        self.assertEqual(done.returncode, 2)
        self.assertIn("the file states that its unit is 25.4 mm, given 1 mm", done.stderr)

    def test_components_stand_where_their_transforms_put_them(self):
        # A plate and two ribs, one of them mirrored in x, all turned by a quarter about z and moved.
        objects = (f'<object id="1" name="plate">{mesh((100, 60, 10))}</object>'
                   f'<object id="2" name="rib">{mesh((10, 60, 30))}</object>'
                   '<object id="9"><components><component objectid="1"/>'
                   '<component objectid="2" transform="1 0 0 0 1 0 0 0 1 20 0 10"/>'
                   '<component objectid="2" transform="-1 0 0 0 1 0 0 0 1 100 0 10"/></components></object>')
        found = self.check(self.write(model(objects, '<item objectid="9" transform="0 1 0 -1 0 0 0 0 1 500 0 7"/>')))
        self.assertEqual([body["name"] for body in found["bodies"]], ["plate", "rib", "rib (2)"])
        self.assertEqual([body["closed_pieces"] for body in found["bodies"]], [1, 1, 1])
        self.assertEqual(found["repairs"]["turned_pieces"], 0)  # mirrored ones are turned as they are read
        self.assertEqual((found["lower_mm"], found["upper_mm"]), ([440, 0, 7], [500, 100, 47]))
        places = [face["place_mm"][1] for face in found["step_faces"]]
        self.assertTrue(20 <= places[1] <= 30 and 90 <= places[2] <= 100, places)

    def test_supports_are_left_out_and_told(self):
        objects = BLOCK + f'<object id="4" type="support">{mesh((10, 10, 50))}</object>'
        found = self.check(self.write(model(objects, '<item objectid="3"/><item objectid="4"/>')))
        self.assertEqual(found["upper_mm"], [100, 60, 20])
        self.assertIn("1 of the 3MF file's objects for support is left out", found["warnings"])

    def test_what_is_wrong_is_told_with_its_line(self):
        item = '<item objectid="3"/>'
        for objects, items, words in (
                (BLOCK, '<item objectid="7"/>', "there is no object 7"),
                (BLOCK, "", "builds no triangles"),
                (BLOCK + BLOCK, item, "two objects have one id"),
                (BLOCK.replace('v1="0"', 'v1="8"', 1), item, "v1 of triangle is 8; allowed: 0 to 7"),
                (BLOCK.replace('x="0"', 'x="nan"', 1), item, 'x of vertex is "nan"'),
                (BLOCK.replace('y="0"', "", 1), item, "vertex has no y"),
                (BLOCK, '<item objectid="3" transform="1 0 0 0 1 0 0 0 1 5 5"/>', "allowed: 12 finite numbers"),
                (BLOCK, '<item objectid="3" transform="1 0 0 0 1 0 0 0 0 5 5 5"/>', "that keep a volume"),
                ('<object id="1"><components><component objectid="1"/></components></object>', '<item objectid="1"/>',
                 "object 1 does not stand before")):
            self.refused(model(objects, items), words)
        self.refused(model(BLOCK.replace('v1="0"', 'v1="8"', 1), item), "3D/part.model line 14")
        self.refused(model(BLOCK, item, 'unit="furlong"'), "allowed: micron, millimeter")
        self.refused(model(BLOCK, item, 'requiredextensions="p"'), 'requires the extensions "p"')
        self.refused(model(BLOCK, item)[:-20], "no sound XML")
        self.refused(None, "holds no 3D/part.model")
        self.refused(model(BLOCK, item), "holds no 3MF model", rels="<Relationships/>")

    def test_damaged_archives_are_errors_or_the_part(self):
        sound = self.write(model(BLOCK, '<item objectid="3"/>')).read_bytes()
        stream = random.Random(5)
        damaged = [sound[:length] for length in (4, 30, len(sound) // 2, len(sound) - 3)]
        for _ in range(12):
            bytes_ = bytearray(sound)
            bytes_[stream.randrange(len(sound))] ^= 1 << stream.randrange(8)
            damaged.append(bytes(bytes_))
        refused = 0
        for i, data in enumerate(damaged):
            path = self.folder / "part.3mf"
            path.write_bytes(data)
            done = run("check", path, "-q", "--json")
            self.assertIn(done.returncode, (0, 1, 2), (i, done.stderr))
            refused += done.returncode == 2
            if done.returncode < 2:
                self.assertEqual(json.loads(done.stdout)["upper_mm"], [100, 60, 20], i)
        self.assertGreater(refused, 8)


if __name__ == "__main__":
    unittest.main(argv=["threemf_test"])
