# SPDX-License-Identifier: GPL-3.0-or-later
"""usage: vtk_test.py MILLPOSE TOP: VTK's own reader, which ParaView uses, reads path.vtp of a plan; every array says what
points.csv says."""
import csv
import pathlib
import subprocess
import sys
import tempfile
import unittest

from vtkmodules.vtkIOXML import vtkXMLPolyDataReader

MILLPOSE, TOP = sys.argv[1], pathlib.Path(sys.argv[2])


def tuples(array):
    return [array.GetTuple(i) for i in range(array.GetNumberOfTuples())]


class PathInVtk(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory(prefix="millpose-vtk-test.")
        cls.addClassCleanup(folder.cleanup)
        subprocess.run([MILLPOSE, "plan", TOP / "toolpaths/support_pad/job.yaml", "-o", folder.name, "-q"], check=True,
                       stdout=subprocess.DEVNULL)
        reader = vtkXMLPolyDataReader()
        reader.SetFileName(folder.name + "/path.vtp")
        reader.Update()
        assert reader.GetErrorCode() == 0
        cls.path = reader.GetOutput()
        with open(folder.name + "/points.csv", encoding="ascii") as file:
            cls.rows = list(csv.DictReader(file))

    def test_points_and_lines(self):
        self.assertEqual(self.path.GetNumberOfPoints(), len(self.rows))
        positions = tuples(self.path.GetPoints().GetData())
        for row, position in zip(self.rows, positions):
            self.assertEqual([float(row[axis + "_mm"]) for axis in "xyz"], list(position))
        on_lines = sum(self.path.GetCell(i).GetNumberOfPoints() for i in range(self.path.GetNumberOfLines()))
        self.assertEqual(on_lines, len(self.rows))

    def test_every_array_is_that_of_points_csv(self):
        data = self.path.GetPointData()
        self.assertEqual(data.GetScalars().GetName(), "objective")
        names = {data.GetArrayName(i) for i in range(data.GetNumberOfArrays())}
        compared = names & self.rows[0].keys()
        indices = {"objective", "lambda_t1_mm_N", "lambda_t2_mm_N", "lambda_n_mm_N", "mu", "dexterity", "clearance_mm",
                   "rotation_deg", "a1_deg", "a6_deg", "normal_compliance_mm_N", "pass", "point"}
        self.assertLessEqual(indices, compared)
        for name in compared:
            self.assertEqual([(float(row[name]),) for row in self.rows], tuples(data.GetArray(name)), name)
        normals = [tuple(float(row[key]) for key in ("nx", "ny", "nz")) for row in self.rows]
        self.assertEqual(normals, tuples(data.GetArray("normal")))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
