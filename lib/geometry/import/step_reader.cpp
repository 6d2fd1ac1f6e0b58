// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/import/step_reader.hpp"

#include <bit>
#include <csignal>
#include <cstring>
#include <filesystem>

#include "base/error.hpp"
#include "base/process.hpp"
#include "base/shown.hpp"
#include "base/text.hpp"
#include "geometry/import/text_scanner.hpp"

namespace millpose {
namespace {

constexpr const char* kProgram = "millpose-step";

std::filesystem::path FindProgram() {
  const std::filesystem::path folder = std::filesystem::path(OwnProgram()).parent_path();
  for (const auto& path : {folder / kProgram, folder / ".." / "libexec" / "millpose" / kProgram})
    if (std::filesystem::exists(path)) return path;
  return {};
}

constexpr std::string_view kProgress = "progress ";

// What the child said last, for the user; its progress apart.
std::string LastLine(std::string_view text) {
  std::string_view last;
  while (!text.empty()) {
    const std::string_view line = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(line.size() + 1, text.size()));
    if (!line.starts_with(kProgress) && line.find_first_not_of(' ') != std::string_view::npos) last = line;
  }
  return Shown(last, 300);
}

[[noreturn]] void TellFailure(const ProcessResult& result, const char* format, const std::string& name,
                              const StepOptions& options) {
  const int signal = result.status - 128;
  if (result.status == 2) throw InputError({name}, LastLine(result.errors));
  if (result.status == 3)
    throw InputError({name}, fmt::format("reading the {} file takes more than {} MB of memory", format,
                                         options.memory_MB));
  if (signal == SIGXCPU || signal == SIGALRM || signal == SIGKILL)
    throw InputError({name}, fmt::format("reading the {} file took more than {} s", format, options.seconds));
  throw InputError({name}, signal > 0
                               ? fmt::format("the {} reader crashed on this file (signal {})", format, signal)
                               : fmt::format("the {} reader failed (status {}): {}", format, result.status,
                                             LastLine(result.errors)));
}

template <typename T>
void Append(std::string& bytes, const T* values, size_t count) {
  bytes.append(reinterpret_cast<const char*>(values), count * sizeof(T));
}

static_assert(std::endian::native == std::endian::little);  // answers may go to another machine

// DataValues behind the header.
class DataValues {
 public:
  DataValues(std::string_view bytes, const std::string& name) : bytes_(bytes), name_(name) {}
  template <typename T>
  T Next() {
    if (bytes_.size() < sizeof(T)) throw InputError({name_}, "millpose-step's answer is cut off");
    T value;
    std::memcpy(&value, bytes_.data(), sizeof(T));
    bytes_.remove_prefix(sizeof(T));
    return value;
  }

 private:
  std::string_view bytes_;
  const std::string& name_;
};

}  // namespace

const char* NameOf(CadFormat format) {
  switch (format) {
    case CadFormat::kIges:
      return "IGES";
    case CadFormat::kThreeMf:
      return "3MF";
    default:
      return "STEP";
  }
}

std::optional<CadFormat> CadFormatOf(std::string_view bytes) {
  if (bytes.substr(0, 200).find("ISO-10303-21") != std::string_view::npos) return CadFormat::kStep;
  if (bytes.starts_with("PK\x03\x04")) return CadFormat::kThreeMf;
  // Of the first line's 80 columns the last 8 are its section and its number: S      1.
  const std::string_view end = bytes.substr(std::min<size_t>(72, bytes.size()), 8);
  if (end.size() == 8 && end.front() == 'S' && end.back() == '1' &&
      std::ranges::all_of(end.substr(1, 6), [](char c) { return c == ' ' || c == '0'; }))
    return CadFormat::kIges;
  return std::nullopt;
}

bool IsStepTriangles(std::string_view bytes) {
  return bytes.starts_with(kStepTriangles) && bytes.substr(kStepTriangles.size()).starts_with('\n');
}

RawMesh ReadStep(std::string_view bytes, const std::string& name, const StepOptions& options) {
  return ReadStepTriangles(CutStep(bytes, name, options), name);
}

std::string CutStep(std::string_view bytes, const std::string& name, const StepOptions& options) {
  const std::filesystem::path program = options.program.empty() ? FindProgram() : options.program;
  const char* format = NameOf(CadFormatOf(bytes).value_or(CadFormat::kStep));
  if (program.empty())
    throw InputError(
        {name},
        fmt::format("this is a {} file, and the program that reads it, millpose-step, is not next to "
                    "millpose: keep both together, or install libocct-data-exchange-dev and build again, or "
                    "export STL, OBJ, PLY or OFF",
                    format));
  ProcessResult result = RunProcess({program.string(), format, ShortestNumber(options.chord_tolerance),
                                     std::to_string(options.memory_MB), std::to_string(options.seconds)},
                                    options.stop, bytes, [&](std::string_view line) {
                                      if (!options.percent || !line.starts_with(kProgress)) return;
                                      const auto percent = ParseNumber(line.substr(kProgress.size()));
                                      if (percent && *percent >= 0 && *percent <= 100)
                                        options.percent(static_cast<int>(*percent));
                                    });
  if (result.status != 0) TellFailure(result, format, name, options);
  return std::move(result.output);
}

std::string WriteStepTriangles(const RawMesh& mesh) {
  const Triangles& triangles = mesh.triangles;
  const auto plain = [](std::string text) {
    for (char& c : text)
      if (c < ' ' || c > '~') c = '?';
    return text;
  };
  std::string bytes = fmt::format("{}\n{} {} {} {} {} {}\n", kStepTriangles, mesh.stated_unit.value_or(0),
                                  triangles.vertices.size(), triangles.faces.size(),
                                  triangles.source_faces.size(), mesh.notes.size(), mesh.bodies.size());
  for (size_t i = 0; i < triangles.source_faces.size(); ++i) {
    const SourceFace& face = triangles.source_faces[i];
    const int body = i < mesh.body_of_source.size() ? mesh.body_of_source[i] : -1;
    bytes += fmt::format("{} {} {} {} {} {} {} {} {} {} {} {}\n", plain(face.id), face.kind, face.area,
                         face.lost ? 1 : 0, face.lower.x(), face.lower.y(), face.lower.z(), face.upper.x(),
                         face.upper.y(), face.upper.z(), body + 1, plain(face.name));
  }
  for (const std::string& name : mesh.bodies) bytes += plain(name) + "\n";
  for (const std::string& note : mesh.notes) bytes += plain(note) + "\n";
  for (const Eigen::Vector3d& p : triangles.vertices) Append(bytes, p.data(), 3);
  for (size_t f = 0; f < triangles.faces.size(); ++f) {
    Append(bytes, triangles.faces[f].data(), 3);
    const int source = triangles.source.empty() ? 0 : triangles.source[f];
    Append(bytes, &source, 1);
  }
  return bytes;
}

RawMesh ReadStepTriangles(std::string_view bytes, const std::string& name) {
  TextScanner scanner(bytes, name);
  scanner.Expect(kStepTriangles);
  RawMesh mesh;
  if (const double unit = scanner.Number(); unit > 0) mesh.stated_unit = unit;
  const auto size = static_cast<long long>(bytes.size());
  const long long vertices = scanner.Integer(0, size / 24, "vertices"),
                  faces = scanner.Integer(0, size / 16, "faces");
  const long long sources = scanner.Integer(0, size / 4, "faces of the model"),
                  notes = scanner.Integer(0, size, "notes"), bodies = scanner.Integer(0, size, "bodies");
  scanner.SkipLine();
  Triangles& triangles = mesh.triangles;
  for (long long i = 0; i < sources; ++i) {
    SourceFace& face = triangles.source_faces.emplace_back();
    face.id = scanner.Next();
    face.kind = scanner.Next();
    face.area = scanner.Number();
    face.lost = scanner.Integer(0, 1, "lost") == 1;
    for (Eigen::Vector3d* corner : {&face.lower, &face.upper})
      for (int k = 0; k < 3; ++k) (*corner)[k] = scanner.Number();
    mesh.body_of_source.push_back(static_cast<int>(scanner.Integer(0, bodies, "body")) - 1);
    std::string_view rest = scanner.Line();
    while (rest.starts_with(' ')) rest.remove_prefix(1);
    face.name = rest;
  }
  for (long long i = 0; i < bodies; ++i) mesh.bodies.emplace_back(scanner.Line());
  for (long long i = 0; i < notes; ++i) mesh.notes.emplace_back(scanner.Line());
  DataValues values(bytes.substr(scanner.position()), name);
  triangles.vertices.reserve(vertices);
  for (long long i = 0; i < vertices; ++i) {
    const double x = values.Next<double>(), y = values.Next<double>(), z = values.Next<double>();
    triangles.vertices.emplace_back(x, y, z);
    if (!triangles.vertices.back().allFinite())
      throw InputError({name}, "the file gives a point that is not finite");
  }
  triangles.faces.reserve(faces);
  triangles.source.reserve(faces);
  for (long long i = 0; i < faces; ++i) {
    std::array<int, 3>& face = triangles.faces.emplace_back();
    for (int& corner : face) corner = values.Next<int>();
    const int source = values.Next<int>();
    if (sources > 0) triangles.source.push_back(source);
    if (std::ranges::min(face) < 0 || std::ranges::max(face) >= vertices || source < 0 ||
        source >= std::max(1LL, sources))
      throw InputError({name}, "millpose-step's answer is damaged");
  }
  return mesh;
}

}  // namespace millpose
