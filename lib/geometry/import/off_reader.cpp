// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/import/off_reader.hpp"

#include "base/error.hpp"
#include "geometry/import/text_scanner.hpp"
#include "geometry/slice/polygon.hpp"

namespace millpose {

bool LooksLikeOff(std::string_view bytes) {
  TextScanner scanner(bytes.substr(0, 65536), "", '#');
  const std::string_view word = scanner.Peek();
  return word.size() <= 7 && word.ends_with("OFF") &&
         word.find_first_not_of("STCN4nOF") == std::string_view::npos;
}

RawMesh ReadOff(std::string_view bytes, const std::string& name) {
  TextScanner scanner(bytes, name, '#');
  const std::string_view magic = scanner.Next();
  if (magic.find_first_of("4n") != std::string_view::npos)
    throw InputError(scanner.place(), fmt::format("\"{}\" has more than three dimensions", magic));
  if (scanner.Accept("BINARY"))
    throw InputError(scanner.place(), "binary OFF is not supported; export STL or PLY");
  // A vertex takes six bytes at least ("0 0 0\n"), a face two ("0\n").
  const auto size = static_cast<long long>(bytes.size());
  const long long vertices = scanner.Integer(0, size / 6, "the number of vertices (by the size of the file)");
  const long long faces = scanner.Integer(0, size / 2, "the number of faces (by the size of the file)");
  while (scanner.MoreInLine()) scanner.Next();  // the number of edges, which nobody needs
  RawMesh mesh;
  mesh.triangles.vertices.reserve(vertices);
  for (long long i = 0; i < vertices; ++i) {
    const double x = scanner.Number(), y = scanner.Number(), z = scanner.Number();
    mesh.triangles.vertices.emplace_back(x, y, z);
    while (scanner.MoreInLine()) scanner.Next();
  }
  std::vector<int> corners;
  for (long long i = 0; i < faces; ++i) {
    corners.resize(scanner.Integer(1, kMaxCorners, "the number of a face's corners"));
    for (int& corner : corners)
      corner = static_cast<int>(scanner.Integer(0, vertices - 1, "a face's vertex"));
    AppendPolygon(mesh.triangles, corners);
    while (scanner.MoreInLine()) scanner.Next();
  }
  return mesh;
}

}  // namespace millpose
