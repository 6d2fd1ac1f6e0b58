// SPDX-License-Identifier: GPL-3.0-or-later
// OBJ, PLY and OFF; STL has a file of its own.
#include "base/error.hpp"
#include "geometry/import/mesh_import.hpp"
#include "geometry/slice/polygon.hpp"
#include "tests/base/refusal.hpp"
#include "tests/base/replaced.hpp"
#include "tests/geometry/shapes.hpp"

namespace millpose {
namespace {

const Triangles kReadBox = BoxShape({0, 0, 0}, {1, 2, 3});

void ExpectBox(const std::string& bytes) {
  const RawMesh mesh = ReadMesh(bytes, "part");
  EXPECT_EQ(mesh.triangles.faces, kReadBox.faces);
  EXPECT_EQ(mesh.triangles.vertices, kReadBox.vertices);
  EXPECT_TRUE(mesh.notes.empty());
}

std::string MeshError(const std::string& bytes) {
  return RefusalOf([&] { ReadMesh(bytes, "part"); });
}

std::string ObjBox(const std::string& face_format) {
  std::string text = "# a box\nmtllib x.mtl\no box\n";
  for (const auto& p : kReadBox.vertices) text += fmt::format("v {} {} {} 1.0\n", p.x(), p.y(), p.z());
  for (const auto& [a, b, c] : kReadBox.faces)
    text += fmt::format(fmt::runtime(face_format), a + 1, b + 1, c + 1);
  return text;
}

TEST(ObjReader, ReadsAllKindsOfCorners) {
  ExpectBox(ObjBox("f {} {} {}\n"));
  ExpectBox(ObjBox("f {}/1 {}/2 {}/3 # end\n"));
  ExpectBox(ObjBox("f {}//1 {}//2 {}//3\n"));
  ExpectBox(ObjBox("f {}/1/1 {}/2/2 \\\n {}/3/3\r\n"));
  std::string negative = ObjBox("");
  for (const auto& [a, b, c] : kReadBox.faces) negative += fmt::format("f {} {} {}\n", a - 8, b - 8, c - 8);
  ExpectBox(negative);
}

TEST(ObjReader, CutsPolygonsIntoTriangles) {
  const RawMesh mesh = ReadMesh("v 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\nf 1 2 3 4\ncurv 1\ncurv 2\n", "part");
  EXPECT_EQ(mesh.triangles.faces.size(), 2);
  EXPECT_EQ(mesh.notes, std::vector<std::string>{"2 lines \"curv\" were ignored"});
}

TEST(ObjReader, TellsThePlaceOfErrors) {
  EXPECT_EQ(MeshError("v 0 0 0\nv 1 0\nf 1 2 3\n"), "part:3:1: expected a finite number, found \"f\"");
  EXPECT_EQ(MeshError("v 0 0 0\nf 1 1 2\n"),
            "part:2:7: a face needs vertices from 1 to 1 (or -1 to -1), found \"2\"");
  EXPECT_EQ(MeshError("v 0 0 0\nf 0 1 1\n").substr(0, 9), "part:2:3:");
  EXPECT_EQ(MeshError("v 0 0 0\nf 1 1\n"), "part:2:5: a face needs three vertices or more, found 2");
  EXPECT_EQ(MeshError("v 0 0 nan\n"), "part:1:7: expected a finite number, found \"nan\"");
  EXPECT_EQ(MeshError("v 0 0 0\n"), "part: the file holds no triangles");
}

std::string OffBox(const std::string& magic) {
  std::string text = magic + "\n# box\n8 12 18\n";
  for (const auto& p : kReadBox.vertices) text += fmt::format("{} {} {}\n", p.x(), p.y(), p.z());
  for (const auto& [a, b, c] : kReadBox.faces) text += fmt::format("3 {} {} {} 0.5 0.5 0.5\n", a, b, c);
  return text;
}

TEST(OffReader, ReadsBoxes) {
  ExpectBox(OffBox("OFF"));
  ExpectBox(Everywhere(OffBox("COFF"), "\n", "\r\n"));
  ExpectBox(Everywhere(OffBox("OFF"), "OFF\n# box\n", "OFF "));
}

TEST(OffReader, TellsThePlaceOfErrors) {
  EXPECT_EQ(
      MeshError("OFF\n1000000 2 0\n0 0 0\n"),
      "part:2:1: the number of vertices (by the size of the file) must be a whole number from 0 to 3, found "
      "\"1000000\"");
  EXPECT_EQ(MeshError("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n"),
            "part:6:7: a face's vertex must be a whole number from 0 to 2, found \"3\"");
  EXPECT_EQ(MeshError("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1\n"),
            "part:7:1: a face's vertex must be a whole number from 0 to 2, found the end of the file");
  EXPECT_EQ(MeshError("OFF BINARY\n").substr(0, 9), "part:1:5:");
}

std::string PlyHeaderText(const std::string& format) {
  return "ply\nformat " + format +
         " 1.0\ncomment a box\nelement vertex 8\nproperty float x\nproperty float y\nproperty double "
         "z\nproperty uchar "
         "red\nelement face 12\nproperty list uchar int vertex_indices\nend_header\n";
}

std::string TextPly() {
  std::string text = PlyHeaderText("ascii");
  for (const auto& p : kReadBox.vertices) text += fmt::format("{} {} {} 255\n", p.x(), p.y(), p.z());
  for (const auto& [a, b, c] : kReadBox.faces) text += fmt::format("3 {} {} {}\n", a, b, c);
  return text;
}

std::string BinaryPly(bool big) {
  std::string bytes = PlyHeaderText(big ? "binary_big_endian" : "binary_little_endian");
  const auto append = [&](auto value) {
    std::string raw(reinterpret_cast<const char*>(&value), sizeof value);
    if (big) std::ranges::reverse(raw);
    bytes += raw;
  };
  for (const auto& p : kReadBox.vertices) {
    append(static_cast<float>(p.x()));
    append(static_cast<float>(p.y()));
    append(p.z());
    append(static_cast<uint8_t>(255));
  }
  for (const auto& face : kReadBox.faces) {
    append(static_cast<uint8_t>(3));
    for (const int v : face) append(static_cast<int32_t>(v));
  }
  return bytes;
}

TEST(PlyReader, ReadsTextAndBothByteOrders) {
  ExpectBox(TextPly());
  ExpectBox(Everywhere(TextPly(), "\n", "\r\n"));
  ExpectBox(BinaryPly(false));
  ExpectBox(BinaryPly(true));
}

TEST(PlyReader, NotesOtherElements) {
  const std::string text =
      Everywhere(TextPly(), "end_header\n", "element edge 1\nproperty int a\nend_header\n") + "7\n";
  EXPECT_EQ(ReadMesh(text, "part").notes, std::vector<std::string>{"1 elements \"edge\" were ignored"});
}

TEST(PlyReader, TellsThePlaceOfErrors) {
  EXPECT_EQ(MeshError("ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\n"),
            "part:5:1: the header has no \"end_header\"");
  EXPECT_EQ(MeshError(Everywhere(TextPly(), "vertex 8", "vertex 4000000")).substr(0, 69),
            "part:4:16: 4000000 elements \"vertex\" do not fit into the 176 bytes be");
  EXPECT_EQ(MeshError(Everywhere(BinaryPly(true), "face 12", "face 200000000")).substr(0, 10), "part:9:14:");
  EXPECT_EQ(MeshError(BinaryPly(false).substr(0, BinaryPly(false).size() - 2)).substr(0, 10), "part, byte");
  EXPECT_EQ(MeshError(Everywhere(TextPly(), "3 0 2 3", "3 0 2 8")),
            "part:20:7: a face's vertex must be from 0 to 7, found 8");
  EXPECT_EQ(MeshError(Everywhere(TextPly(), "1 2 3 255", "1 inf 3 255")),
            "part:19:3: expected a finite number, found \"inf\"");
  EXPECT_EQ(MeshError(Everywhere(TextPly(), "property float y\n", "")).substr(0, 30),
            "part: the vertices lack x, y o");
  EXPECT_EQ(MeshError(Everywhere(TextPly(), "float x", "real x")), "part:5:10: \"real\" is no PLY type");
}

TEST(Polygon, ConcaveOnesKeepTheirArea) {
  // An L, both ways round, and a star-like comb.
  for (const bool reverse : {false, true}) {
    Triangles mesh;
    mesh.vertices = {{0, 0, 0}, {4, 0, 0}, {4, 1, 0}, {1, 1, 0}, {1, 3, 0}, {0, 3, 0}};
    std::vector<int> corners{0, 1, 2, 3, 4, 5};
    if (reverse) std::ranges::reverse(corners);
    AppendPolygon(mesh, corners);
    ASSERT_EQ(mesh.faces.size(), 4);
    double area = 0;
    for (const auto& [a, b, c] : mesh.faces) {
      const double part =
          (mesh.vertices[b] - mesh.vertices[a]).cross(mesh.vertices[c] - mesh.vertices[a]).z() / 2 *
          (reverse ? -1 : 1);
      EXPECT_GT(part, 0);
      area += part;
    }
    EXPECT_NEAR(area, 6, 1e-12);
  }
}

const std::string kTetrahedron = "v 0 0 0\nv 9 0 0\nv 0 9 0\nv 0 0 9\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";

TEST(ReadMesh, TakesTheMarkOfUtf8Away) {
  EXPECT_EQ(ReadMesh("\xef\xbb\xbf" + kTetrahedron, "part").triangles.faces.size(), 4);
  EXPECT_EQ(ReadMesh("\xef\xbb\xbfOFF 3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", "part").triangles.faces.size(),
            1);
}

TEST(ReadMesh, SaysWhatTextIsNoMesh) {
  std::string wide = "\xff\xfe";
  for (const char c : kTetrahedron) wide += std::string{c, '\0'};
  EXPECT_EQ(
      MeshError(wide),
      "part: the file is text in UTF-16; save it as UTF-8. STL, OBJ, PLY, OFF, STEP, IGES and 3MF are read");
  std::string prose;
  for (int i = 0; i < 20; ++i) prose += "This part is milled from 5A06.\n";
  EXPECT_EQ(MeshError(prose),
            "part:1:1: text of no known mesh format begins with \"This\"; STL, OBJ, PLY, OFF, STEP, IGES and "
            "3MF are read");
}

TEST(ReadMesh, MessagesSurviveZeroBytes) {
  EXPECT_EQ(MeshError(Everywhere(kTetrahedron, "f 1 3 2", std::string("f 1 \0q 2", 8))),
            "part:5:5: a face needs vertices from 1 to 4 (or -1 to -4), found \"?q\"");
}

}  // namespace
}  // namespace millpose
