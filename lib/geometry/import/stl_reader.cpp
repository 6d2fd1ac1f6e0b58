// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/import/stl_reader.hpp"

#include <bit>
#include <cstring>

#include "base/error.hpp"
#include "geometry/import/text_scanner.hpp"

namespace millpose {
namespace {

constexpr size_t kHeader = 84;  // 80 bytes of text and the count
constexpr size_t kFacet = 50;   // normal, three vertices, two bytes of attributes
constexpr size_t kMaxProblems = 20;

uint32_t LittleEndian32(const char* bytes) {
  const auto* b = reinterpret_cast<const unsigned char*>(bytes);
  return uint32_t{b[0]} | uint32_t{b[1]} << 8 | uint32_t{b[2]} << 16 | uint32_t{b[3]} << 24;
}

float LittleEndianFloat(const char* bytes) { return std::bit_cast<float>(LittleEndian32(bytes)); }

// Files written as text are told by their second word: binary headers may begin with "solid" too.
bool IsTextStl(std::string_view bytes) {
  TextScanner scanner(bytes.substr(0, std::min<size_t>(bytes.size(), 4096)), "");
  if (!scanner.Accept("solid")) return false;
  scanner.SkipLine();
  const std::string_view word = scanner.Peek();
  return EqualsIgnoringCase(word, "facet") || EqualsIgnoringCase(word, "endsolid") ||
         EqualsIgnoringCase(word, "solid") || (word.empty() && bytes.size() < kHeader);
}

RawMesh ReadBinary(std::string_view bytes, const std::string& name) {
  if (bytes.size() < kHeader)
    throw InputError(
        {name, 0, 0, static_cast<long long>(bytes.size())},
        fmt::format("the file ends after {} bytes; a binary STL has at least {}", bytes.size(), kHeader));
  const size_t count = LittleEndian32(bytes.data() + 80);
  const size_t held = (bytes.size() - kHeader) / kFacet;
  if (count > held)
    throw InputError(
        {name, 0, 0, 80},
        fmt::format("the header promises {} facets, the {} bytes of the file hold {}: the file is cut "
                    "off or not an STL",
                    count, bytes.size(), held));
  RawMesh mesh;
  mesh.triangles.vertices.reserve(3 * count);
  mesh.triangles.faces.reserve(count);
  std::vector<Problem> problems;
  for (size_t i = 0; i < count; ++i) {
    const size_t facet = kHeader + i * kFacet;
    const int first = static_cast<int>(mesh.triangles.vertices.size());
    for (size_t corner = 0; corner < 3; ++corner) {
      const size_t at = facet + 12 + 12 * corner;
      const Eigen::Vector3f p(LittleEndianFloat(&bytes[at]), LittleEndianFloat(&bytes[at + 4]),
                              LittleEndianFloat(&bytes[at + 8]));
      if (!p.allFinite() && problems.size() < kMaxProblems)
        problems.push_back(
            {{name, 0, 0, static_cast<long long>(at)},
             fmt::format("facet {}: vertex ({}, {}, {}) is not finite", i + 1, p.x(), p.y(), p.z())});
      mesh.triangles.vertices.push_back(p.cast<double>());
    }
    mesh.triangles.faces.push_back({first, first + 1, first + 2});
  }
  if (!problems.empty()) throw InputError(std::move(problems));
  const size_t rest = bytes.size() - kHeader - count * kFacet;
  if (rest > 0) mesh.notes.push_back(fmt::format("{} bytes behind the last facet were ignored", rest));
  return mesh;
}

// One "facet … endfacet"; the word "facet" is already taken. 1 when words behind it were passed over, else 0.
size_t ReadFacet(TextScanner& scanner, RawMesh& mesh) {
  if (scanner.Accept("normal"))
    for (int i = 0; i < 3; ++i) scanner.Next();  // ignored, so they may be anything
  scanner.Expect("outer");
  scanner.Expect("loop");
  const int first = static_cast<int>(mesh.triangles.vertices.size());
  for (int corner = 0; corner < 3; ++corner) {
    scanner.Expect("vertex");
    const double x = scanner.Number(), y = scanner.Number(), z = scanner.Number();
    mesh.triangles.vertices.emplace_back(x, y, z);
  }
  mesh.triangles.faces.push_back({first, first + 1, first + 2});
  scanner.Expect("endloop");
  scanner.Expect("endfacet");
  // Some programs write an attribute behind it; files on one line go on with a word of their own.
  if (!scanner.MoreInLine()) return 0;
  const std::string_view next = scanner.Peek();
  if (EqualsIgnoringCase(next, "facet") || EqualsIgnoringCase(next, "endsolid")) return 0;
  scanner.SkipLine();
  return 1;
}

RawMesh ReadText(std::string_view bytes, const std::string& name) {
  TextScanner scanner(bytes, name);
  RawMesh mesh;
  size_t attributes = 0;
  while (!scanner.AtEnd()) {
    scanner.Expect("solid");
    scanner.SkipLine();  // the solid's name
    while (scanner.Accept("facet")) attributes += ReadFacet(scanner, mesh);
    if (scanner.AtEnd()) {
      mesh.notes.emplace_back("\"endsolid\" is missing at the end");
    } else {
      scanner.Expect("endsolid");
      scanner.SkipLine();
    }
  }
  if (attributes > 0)
    mesh.notes.push_back(fmt::format("words behind {} \"endfacet\" were ignored", attributes));
  return mesh;
}

}  // namespace

bool IsExactBinaryStl(std::string_view bytes) {
  return bytes.size() >= kHeader && bytes.size() == kHeader + kFacet * size_t{LittleEndian32(&bytes[80])};
}

RawMesh ReadStl(std::string_view bytes, const std::string& name) {
  return !IsExactBinaryStl(bytes) && IsTextStl(bytes) ? ReadText(bytes, name) : ReadBinary(bytes, name);
}

}  // namespace millpose
