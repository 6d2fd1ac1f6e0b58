// SPDX-License-Identifier: GPL-3.0-or-later
// 3MF core specification: https://github.com/3MFConsortium/spec_core
#include "threemf_file.hpp"

#include <fmt/format.h>
#include <tinyxml2.h>

#include <cmath>
#include <map>
#include <stdexcept>

#include "base/text.hpp"
#include "step_progress.hpp"
#include "zip_archive.hpp"

namespace millpose {
namespace {

using tinyxml2::XMLElement;
using Transform = Eigen::Matrix<double, 3, 4>;

constexpr std::string_view kModelType = "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel";

/// An XML file of the archive.
class Part {
 public:
  Part(const ZipArchive& archive, std::string name) : name_(std::move(name)) {
    const std::string text = archive.Read(name_);
    if (document_.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS)
      throw std::runtime_error(fmt::format("{} line {}: no sound XML ({})", name_, document_.ErrorLineNum(),
                                           document_.ErrorName()));
  }

  const XMLElement& Root(const char* wanted) const {
    const XMLElement* root = document_.RootElement();
    if (!root || std::string_view(root->Name()) != wanted)
      throw std::runtime_error(fmt::format("{}: its first element is not {}", name_, wanted));
    return *root;
  }
  [[noreturn]] void Refuse(const XMLElement& at, const std::string& what) const {
    throw std::runtime_error(fmt::format("{} line {}: {}", name_, at.GetLineNum(), what));
  }
  const char* Text(const XMLElement& at, const char* attribute) const {
    const char* text = at.Attribute(attribute);
    if (!text) Refuse(at, fmt::format("{} has no {}", at.Name(), attribute));
    return text;
  }
  double Number(const XMLElement& at, const char* attribute) const {
    const char* text = Text(at, attribute);
    const std::optional<double> number = ParseNumber(text);
    if (!number || !std::isfinite(*number))
      Refuse(at, fmt::format("{} of {} is \"{}\"; allowed: a finite number", attribute, at.Name(), text));
    return *number;
  }
  /// A whole number from 0 to below `end`.
  int Index(const XMLElement& at, const char* attribute, size_t end) const {
    const double number = Number(at, attribute);
    if (number < 0 || number >= static_cast<double>(end) || number != std::floor(number))
      Refuse(at, fmt::format("{} of {} is {}; allowed: 0 to {}", attribute, at.Name(), Text(at, attribute),
                             static_cast<long long>(end) - 1));
    return static_cast<int>(number);
  }
  /// Twelve numbers, row by row of the matrix that stands behind a row of coordinates.
  Transform TransformOf(const XMLElement& at) const {
    Transform transform = Transform::Identity();
    const char* text = at.Attribute("transform");
    if (!text) return transform;
    std::string_view rest = text;
    for (int i = 0; i < 12; ++i) {
      while (rest.starts_with(' ')) rest.remove_prefix(1);
      const std::string_view word = rest.substr(0, rest.find(' '));
      rest.remove_prefix(word.size());
      const std::optional<double> number = ParseNumber(word);
      if (!number || !std::isfinite(*number))
        Refuse(at, fmt::format("transform of {} is \"{}\"; allowed: 12 finite numbers", at.Name(), text));
      transform(i % 3, i / 3) = *number;
    }
    if (rest.find_first_not_of(' ') != std::string_view::npos || transform.leftCols<3>().determinant() == 0)
      Refuse(at, fmt::format("transform of {} is \"{}\"; allowed: 12 finite numbers that keep a volume",
                             at.Name(), text));
    return transform;
  }

 private:
  std::string name_;
  tinyxml2::XMLDocument document_;
};

Transform Times(const Transform& outer, const Transform& inner) {
  Transform both;
  both.leftCols<3>() = outer.leftCols<3>() * inner.leftCols<3>();
  both.col(3) = outer.leftCols<3>() * inner.col(3) + outer.col(3);
  return both;
}

std::string ModelName(const ZipArchive& archive) {
  const Part part(archive, "_rels/.rels");
  const XMLElement& root = part.Root("Relationships");
  for (const XMLElement* it = root.FirstChildElement("Relationship"); it;
       it = it->NextSiblingElement("Relationship"))
    if (part.Text(*it, "Type") == kModelType) {
      std::string target = part.Text(*it, "Target");
      return target.starts_with('/') ? target.substr(1) : target;
    }
  throw std::runtime_error("the zip archive holds no 3MF model: _rels/.rels names none");
}

/// What the model's items become.
class Builder {
 public:
  explicit Builder(const Part& part) : part_(part), root_(part.Root("model")) {}

  RawMesh Run() {
    if (const char* wanted = root_.Attribute("requiredextensions"); wanted && *wanted != '\0')
      part_.Refuse(
          root_,
          fmt::format("the model requires the extensions \"{}\"; read is the core of 3MF alone", wanted));
    TakeUnit();
    if (const XMLElement* resources = root_.FirstChildElement("resources"))
      for (const XMLElement* it = resources->FirstChildElement("object"); it;
           it = it->NextSiblingElement("object"))
        if (!objects_.emplace(part_.Text(*it, "id"), Object{it, static_cast<int>(objects_.size())}).second)
          part_.Refuse(*it, "two objects have one id");
    if (const XMLElement* build = root_.FirstChildElement("build"))
      for (const XMLElement* it = build->FirstChildElement("item"); it; it = it->NextSiblingElement("item"))
        Add(Named(*it, static_cast<int>(objects_.size())), part_.TransformOf(*it), "");
    if (left_out_ > 0)
      mesh_.notes.push_back(fmt::format("{} of the 3MF file's objects for support {} left out", left_out_,
                                        left_out_ == 1 ? "is" : "are"));
    if (mesh_.triangles.faces.empty()) throw std::runtime_error("the 3MF file builds no triangles");
    if (mesh_.bodies.size() == 1) {  // as an STL file: its faces are told by their creases
      mesh_.bodies.clear();
      mesh_.body_of_source.clear();
      mesh_.triangles.source.clear();
      mesh_.triangles.source_faces.clear();
    }
    return std::move(mesh_);
  }

 private:
  void TakeUnit() {
    const char* given = root_.Attribute("unit");
    const std::string unit = given ? given : "millimeter";
    const std::map<std::string, std::pair<double, bool>> known{
        {"micron", {1e-3, false}}, {"millimeter", {1, true}}, {"centimeter", {10, true}},
        {"inch", {25.4, true}},    {"foot", {304.8, false}},  {"meter", {1000, true}}};
    const auto found = known.find(unit);
    if (found == known.end())
      part_.Refuse(
          root_,
          fmt::format("unit is \"{}\"; allowed: micron, millimeter, centimeter, inch, foot, meter", unit));
    const auto& [factor, keys_know] = found->second;
    mesh_.stated_unit = keys_know ? factor : 1;
    scale_ = keys_know ? 1 : factor;
    if (!keys_know)
      mesh_.notes.push_back(fmt::format("the 3MF file's unit \"{}\" was converted to mm", unit));
  }

  struct Object {
    const XMLElement* element;
    int number;  // in the order of the file
  };

  /// What an item or a component names. A component's stands before the object `within`, by its number, that
  /// it is part of, so that none holds itself.
  const Object& Named(const XMLElement& user, int within) const {
    const std::string id = part_.Text(user, "objectid");
    const auto found = objects_.find(id);
    if (found == objects_.end()) part_.Refuse(user, fmt::format("there is no object {}", id));
    if (found->second.number >= within)
      part_.Refuse(user, fmt::format("object {} does not stand before the one that it is part of", id));
    return found->second;
  }

  void Add(const Object& added, const Transform& place, const std::string& above) {
    const XMLElement& object = *added.element;
    const char* named = object.Attribute("name");
    const std::string name = named && *named != '\0' ? named : above;
    const std::string_view type = object.Attribute("type") ? object.Attribute("type") : "model";
    if (type == "support" || type == "solidsupport") {
      ++left_out_;
      return;
    }
    if (const XMLElement* components = object.FirstChildElement("components"))
      for (const XMLElement* it = components->FirstChildElement("component"); it;
           it = it->NextSiblingElement("component"))
        Add(Named(*it, added.number), Times(place, part_.TransformOf(*it)), name);
    if (const XMLElement* mesh = object.FirstChildElement("mesh")) AddMesh(object, *mesh, place, name);
  }

  void AddMesh(const XMLElement& object, const XMLElement& mesh, const Transform& place,
               const std::string& name) {
    Triangles& triangles = mesh_.triangles;
    const size_t first = triangles.vertices.size();
    const XMLElement* vertices = mesh.FirstChildElement("vertices");
    const XMLElement* faces = mesh.FirstChildElement("triangles");
    if (!vertices || !faces) part_.Refuse(mesh, "mesh has no vertices or no triangles");
    for (const XMLElement* it = vertices->FirstChildElement("vertex"); it;
         it = it->NextSiblingElement("vertex")) {
      const Eigen::Vector3d p(part_.Number(*it, "x"), part_.Number(*it, "y"), part_.Number(*it, "z"));
      triangles.vertices.push_back(scale_ * (place.leftCols<3>() * p + place.col(3)));
    }
    const size_t count = triangles.vertices.size() - first;
    const bool mirrored = place.leftCols<3>().determinant() < 0;
    const int body = AddBody(object, name);
    double area = 0;
    for (const XMLElement* it = faces->FirstChildElement("triangle"); it;
         it = it->NextSiblingElement("triangle")) {
      const auto corner = [&](const char* which) {
        return static_cast<int>(first) + part_.Index(*it, which, count);
      };
      std::array<int, 3> face{corner("v1"), corner("v2"), corner("v3")};
      if (mirrored) std::swap(face[1], face[2]);
      const auto& [a, b, c] = face;
      area += (triangles.vertices[b] - triangles.vertices[a])
                  .cross(triangles.vertices[c] - triangles.vertices[a])
                  .norm() /
              2;
      triangles.faces.push_back(face);
      triangles.source.push_back(body);
    }
    const double mm = *mesh_.stated_unit;
    triangles.source_faces[static_cast<size_t>(body)].area = area * mm * mm;
  }

  /// One body and one source face, of one number.
  int AddBody(const XMLElement& object, const std::string& name) {
    const std::string base = name.empty() ? "body" : name;
    const int use = ++uses_[base];
    mesh_.bodies.push_back(use == 1 ? base : fmt::format("{} ({})", base, use));
    const int number = static_cast<int>(mesh_.bodies.size()) - 1;
    mesh_.body_of_source.push_back(number);
    SourceFace& source = mesh_.triangles.source_faces.emplace_back();
    source.id = fmt::format("#{}", part_.Index(object, "id", size_t{1} << 31));
    source.name = name;
    source.kind = "mesh";
    return number;
  }

  const Part& part_;
  const XMLElement& root_;
  RawMesh mesh_;
  double scale_ = 1;
  std::map<std::string, Object> objects_;
  std::map<std::string, int> uses_;
  int left_out_ = 0;
};

}  // namespace

RawMesh ReadThreeMf(std::string_view bytes) {
  TellPercent(0);
  const ZipArchive archive(bytes);
  const Part part(archive, ModelName(archive));
  TellPercent(50);
  return Builder(part).Run();
}

}  // namespace millpose
