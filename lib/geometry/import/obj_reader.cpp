// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/import/obj_reader.hpp"

#include "base/error.hpp"
#include "geometry/import/text_scanner.hpp"
#include "geometry/slice/polygon.hpp"

namespace millpose {
namespace {

// Keywords that say nothing about the shape.
constexpr std::array<std::string_view, 10> kHarmless{"vn",     "vt",     "o",      "g",   "s",
                                                     "usemtl", "mtllib", "usemap", "lod", "maplib"};

class ObjReader {
 public:
  ObjReader(std::string_view bytes, const std::string& name) : scanner_(bytes, name, '#') {}

  RawMesh Read() {
    while (!scanner_.AtEnd()) {
      const std::string_view keyword = scanner_.Next();
      if (keyword == "v") {
        ReadVertex();
      } else if (keyword == "f" || keyword == "fo") {
        ReadFace();
      } else if (std::ranges::find(kHarmless, keyword) == kHarmless.end()) {
        ++unknown_[std::string(keyword.substr(0, 20))];
        if (unknown_.size() > 100)
          throw InputError(scanner_.place(), "too many unknown keywords: this is no OBJ");
      }
      while (scanner_.MoreInLine()) scanner_.Next();
    }
    for (const auto& [keyword, count] : unknown_)
      mesh_.notes.push_back(fmt::format("{} lines \"{}\" were ignored", count, keyword));
    return std::move(mesh_);
  }

 private:
  void ReadVertex() {
    const double x = scanner_.Number(), y = scanner_.Number(), z = scanner_.Number();
    mesh_.triangles.vertices.emplace_back(x, y, z);
  }

  // "7", "7/1", "7/1/3", "7//3", each also negative: counted back from the last vertex so far.
  void ReadFace() {
    corners_.clear();
    while (scanner_.MoreInLine()) {
      const std::string_view word = scanner_.Next();
      const auto count = static_cast<long long>(mesh_.triangles.vertices.size());
      const std::string digits(word.substr(0, word.find('/')));
      TextScanner index(digits, "");
      long long value = 0;
      try {
        value = index.Integer(-count, count, "");
      } catch (const InputError&) {
        value = 0;
      }
      if (value == 0)
        throw InputError(scanner_.place(),
                         fmt::format("a face needs vertices from 1 to {} (or -1 to -{}), found \"{}\"", count,
                                     count, word.substr(0, 40)));
      corners_.push_back(static_cast<int>(value > 0 ? value - 1 : count + value));
      if (corners_.size() > kMaxCorners)
        throw InputError(scanner_.place(), fmt::format("a face has more than {} corners", kMaxCorners));
    }
    if (corners_.size() < 3)
      throw InputError(scanner_.place(),
                       fmt::format("a face needs three vertices or more, found {}", corners_.size()));
    AppendPolygon(mesh_.triangles, corners_);
  }

  TextScanner scanner_;
  RawMesh mesh_;
  std::vector<int> corners_;
  std::map<std::string, size_t> unknown_;
};

}  // namespace

bool LooksLikeObj(std::string_view bytes) {
  TextScanner scanner(bytes.substr(0, 65536), "", '#');
  const std::string_view word = scanner.Peek();
  return word == "v" || word == "f" || std::ranges::find(kHarmless, word) != kHarmless.end();
}

RawMesh ReadObj(std::string_view bytes, const std::string& name) { return ObjReader(bytes, name).Read(); }

}  // namespace millpose
