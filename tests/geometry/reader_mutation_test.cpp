// SPDX-License-Identifier: GPL-3.0-or-later
// Thousands of spoilt files: each is read or refused with an InputError, and what is read can be repaired.
#include "base/error.hpp"
#include "geometry/import/mesh_import.hpp"
#include "tests/geometry/mutate.hpp"
#include "tests/geometry/shapes.hpp"

namespace millpose {
namespace {

std::string PlyTetrahedron(const std::string& format) {
  std::string bytes = "ply\nformat " + format +
                      " 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
                      "element face 4\nproperty list uchar int vertex_indices\nend_header\n";
  if (format == "ascii") return bytes + "0 0 0\n9 0 0\n0 9 0\n0 0 9\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";
  const bool big = format == "binary_big_endian";
  const auto append = [&](auto value) {
    std::string raw(reinterpret_cast<const char*>(&value), sizeof value);
    if (big) std::ranges::reverse(raw);
    bytes += raw;
  };
  for (const float x : {0.F, 0.F, 0.F, 9.F, 0.F, 0.F, 0.F, 9.F, 0.F, 0.F, 0.F, 9.F}) append(x);
  for (const auto& [a, b, c] : {std::array<int, 3>{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}) {
    append(static_cast<uint8_t>(3));
    for (const int v : {a, b, c}) append(static_cast<int32_t>(v));
  }
  return bytes;
}

TEST(ReaderMutation, SpoiltFilesAreReadOrRefused) {
  const Triangles box = BoxShape({0, 0, 0}, {1, 2, 3});
  const std::string obj =
      "# tetra\nv 0 0 0\nv 9 0 0\nv 0 9 0\nv 0 0 9\nf 1/1 3/1 2/1\nf 1 2 4\nf -4 -1 -2\nf 2 3 4\n";
  const std::string off = "OFF\n4 4 6\n0 0 0\n9 0 0\n0 9 0\n0 0 9\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";
  size_t read = 0, refused = 0;
  for (const std::string& seed :
       {BinaryStl(box), TextStl(box), obj, off, PlyTetrahedron("ascii"),
        PlyTetrahedron("binary_little_endian"), PlyTetrahedron("binary_big_endian")}) {
    ASSERT_NO_THROW(ReadMesh(seed, "seed"));
    for (uint64_t i = 0; i < 2000; ++i) {
      RandomStream random(i, 23);
      const std::string bytes = Mutated(seed, random);
      try {
        const RawMesh raw = ReadMesh(bytes, "spoilt");
        for (const auto& p : raw.triangles.vertices) ASSERT_TRUE(p.allFinite());
        for (const auto& face : raw.triangles.faces)
          for (const int v : face) ASSERT_LT(static_cast<size_t>(v), raw.triangles.vertices.size());
        ++read;
        ImportMesh(raw, {}, "spoilt");
      } catch (const InputError& error) {
        ++refused;
        ASSERT_FALSE(error.problems().empty());
      }
    }
  }
  EXPECT_GT(read, 500);
  EXPECT_GT(refused, 1000);
}

}  // namespace
}  // namespace millpose
