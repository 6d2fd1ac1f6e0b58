// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/import/raw_mesh.hpp"

#include <algorithm>

#include "base/error.hpp"
#include "geometry/import/obj_reader.hpp"
#include "geometry/import/off_reader.hpp"
#include "geometry/import/ply_reader.hpp"
#include "geometry/import/step_reader.hpp"
#include "geometry/import/stl_reader.hpp"
#include "geometry/import/text_scanner.hpp"

namespace millpose {
namespace {

constexpr const char* kFormats = "STL, OBJ, PLY, OFF, STEP, IGES and 3MF are read";

bool IsUtf16(std::string_view bytes) {
  return bytes.starts_with("\xff\xfe") || bytes.starts_with("\xfe\xff");
}

// No binary STL: its numbers hold bytes that no text has.
bool HoldsNoControls(std::string_view bytes) {
  return std::ranges::all_of(bytes.substr(0, 512), [](char c) {
    const auto b = static_cast<unsigned char>(c);
    return b >= 0x20 || c == '\t' || c == '\n' || c == '\r' || c == '\f';
  });
}

/// What people give in place of a mesh, and what they may have meant; empty for anything else.
std::string OtherKind(std::string_view bytes, const std::string& name) {
  const std::string_view head = bytes.substr(0, 4096);
  const auto has = [&](std::string_view word) { return head.find(word) != std::string_view::npos; };
  const std::string_view named = name;
  if (has("<robot"))
    return "this is a URDF, the description of an arm, not a mesh; a cell names it under arm.urdf";
  if (has("millpose_job:")) return "this is a millpose job, not a mesh";
  if (has("millpose_cell:")) return "this is a millpose cell, not a mesh";
  if (named.ends_with(".md") || named.ends_with(".txt")) return "this is a text for people, not a mesh";
  if (head.starts_with("<?xml") || head.starts_with("<"))
    return "this is XML, not a mesh; Collada must be converted, a 3MF file is a zip archive";
  return "";
}

RawMesh ReadLastResort(std::string_view bytes, const std::string& name) {
  if (const std::string kind = OtherKind(bytes, name); !kind.empty() && HoldsNoControls(bytes))
    throw InputError({name}, fmt::format("{}; {}", kind, kFormats));
  TextScanner scanner(bytes, name);
  const std::string_view word = scanner.Peek();
  if (HoldsNoControls(bytes) && !EqualsIgnoringCase(word, "solid"))
    throw InputError(scanner.place(),
                     fmt::format("text of no known mesh format begins with {}; {}", Quoted(word), kFormats));
  return ReadStl(bytes, name);
}

RawMesh Read(std::string_view bytes, const std::string& name, const StepOptions& step) {
  if (bytes.empty()) throw InputError({name}, "the file is empty");
  if (IsExactBinaryStl(bytes)) return ReadStl(bytes, name);  // its header may begin with any word
  if (IsUtf16(bytes))
    throw InputError({name}, fmt::format("the file is text in UTF-16; save it as UTF-8. {}", kFormats));
  if (bytes.starts_with("\xef\xbb\xbf"))
    bytes.remove_prefix(3);  // the mark that some editors put before UTF-8
  if (IsStepTriangles(bytes)) return ReadStepTriangles(bytes, name);
  if (LooksLikeCad(bytes)) return ReadStep(bytes, name, step);
  if (LooksLikePly(bytes)) return ReadPly(bytes, name);
  if (LooksLikeOff(bytes)) return ReadOff(bytes, name);
  if (LooksLikeObj(bytes)) return ReadObj(bytes, name);
  return ReadLastResort(bytes, name);
}

}  // namespace

RawMesh ReadMesh(std::string_view bytes, const std::string& name, const StepOptions& step) {
  RawMesh mesh = Read(bytes, name, step);
  if (mesh.triangles.faces.empty()) throw InputError({name}, "the file holds no triangles");
  return mesh;
}

}  // namespace millpose
