// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/import/ply_reader.hpp"

#include <bit>

#include "base/error.hpp"
#include "geometry/import/ply_header.hpp"
#include "geometry/import/text_scanner.hpp"
#include "geometry/slice/polygon.hpp"

namespace millpose {
namespace {

// Values one after the other, whatever the format.
class Values {
 public:
  virtual ~Values() = default;
  virtual double Next(PlyType type) = 0;
  virtual SourceLocation place() const = 0;  // of the value taken last
};

class TextValues : public Values {
 public:
  TextValues(std::string_view bytes, const std::string& name, int lines)
      : scanner_(bytes, name), lines_(lines) {}
  double Next(PlyType) override {
    try {
      return scanner_.Number();
    } catch (const InputError& error) {
      throw InputError(place(), error.problems()[0].message);
    }
  }
  SourceLocation place() const override {
    SourceLocation place = scanner_.place();
    place.line += lines_;
    return place;
  }

 private:
  TextScanner scanner_;
  int lines_;  // of the header
};

class BinaryValues : public Values {
 public:
  BinaryValues(std::string_view bytes, std::string name, size_t header, bool big)
      : bytes_(bytes), name_(std::move(name)), at_(header), big_(big) {}

  double Next(PlyType type) override {
    const auto size = static_cast<size_t>(SizeOf(type));
    last_ = at_;
    if (bytes_.size() - at_ < size) throw InputError(place(), "the file ends within its values");
    uint64_t bits = 0;
    for (size_t i = 0; i < size; ++i) {
      const auto byte = static_cast<unsigned char>(bytes_[at_ + (big_ ? i : size - 1 - i)]);
      bits = bits << 8 | byte;
    }
    at_ += size;
    switch (type) {
      case PlyType::kInt8:
        return static_cast<int8_t>(bits);
      case PlyType::kInt16:
        return static_cast<int16_t>(bits);
      case PlyType::kInt32:
        return static_cast<int32_t>(bits);
      case PlyType::kFloat:
        return std::bit_cast<float>(static_cast<uint32_t>(bits));
      case PlyType::kDouble:
        return std::bit_cast<double>(bits);
      default:
        return static_cast<double>(bits);
    }
  }
  SourceLocation place() const override { return {name_, 0, 0, static_cast<long long>(last_)}; }

 private:
  std::string_view bytes_;
  std::string name_;
  size_t at_, last_ = 0;
  bool big_;
};

class PlyReader {
 public:
  PlyReader(const PlyHeader& header, Values& values, const std::string& name)
      : header_(header), values_(values), name_(name) {}

  RawMesh Read() {
    for (const PlyElement& element : header_.elements) {
      if (element.name == "vertex") {
        ReadVertices(element);
      } else if (element.name == "face") {
        ReadFaces(element);
      } else {
        for (long long i = 0; i < element.count; ++i)
          for (const PlyProperty& property : element.properties) Skip(property);
        if (element.count > 0)
          mesh_.notes.push_back(fmt::format("{} elements \"{}\" were ignored", element.count, element.name));
      }
    }
    return std::move(mesh_);
  }

 private:
  void Skip(const PlyProperty& property) {
    const double count = property.list ? values_.Next(property.count_type) : 1;
    for (double i = 0; i < count; ++i) values_.Next(property.type);
  }

  void ReadVertices(const PlyElement& element) {
    std::array<int, 3> coordinates{-1, -1, -1};
    for (size_t i = 0; i < element.properties.size(); ++i)
      for (int axis = 0; axis < 3; ++axis)
        if (element.properties[i].name == std::string(1, "xyz"[axis]) && !element.properties[i].list)
          coordinates[axis] = static_cast<int>(i);
    if (std::ranges::min(coordinates) < 0) throw InputError({name_}, "the vertices lack x, y or z");
    mesh_.triangles.vertices.reserve(element.count);
    for (long long k = 0; k < element.count; ++k) {
      Eigen::Vector3d p = Eigen::Vector3d::Zero();
      for (size_t i = 0; i < element.properties.size(); ++i) {
        const auto axis = std::ranges::find(coordinates, static_cast<int>(i));
        if (axis == coordinates.end()) {
          Skip(element.properties[i]);
          continue;
        }
        const double value = values_.Next(element.properties[i].type);
        if (!std::isfinite(value))
          throw InputError(values_.place(), fmt::format("vertex {}: {} is not finite", k, value));
        p[axis - coordinates.begin()] = value;
      }
      mesh_.triangles.vertices.push_back(p);
    }
  }

  void ReadFaces(const PlyElement& element) {
    for (long long k = 0; k < element.count; ++k)
      for (const PlyProperty& property : element.properties) {
        if (property.list && (property.name == "vertex_indices" || property.name == "vertex_index")) {
          ReadFace(property);
        } else {
          Skip(property);
        }
      }
  }

  void ReadFace(const PlyProperty& property) {
    const double count = values_.Next(property.count_type);
    if (!(count >= 0 && count <= kMaxCorners))
      throw InputError(values_.place(),
                       fmt::format("a face of {} corners; 0 to {} are possible", count, kMaxCorners));
    corners_.clear();
    for (int i = 0; i < static_cast<int>(count); ++i) {
      const double index = values_.Next(property.type);
      const auto vertices = static_cast<double>(mesh_.triangles.vertices.size());
      if (!(index >= 0 && index < vertices) || index != std::floor(index))
        throw InputError(values_.place(),
                         fmt::format("a face's vertex must be from 0 to {}, found {}", vertices - 1, index));
      corners_.push_back(static_cast<int>(index));
    }
    AppendPolygon(mesh_.triangles, corners_);
  }

  const PlyHeader& header_;
  Values& values_;
  const std::string& name_;
  RawMesh mesh_;
  std::vector<int> corners_;
};

}  // namespace

bool LooksLikePly(std::string_view bytes) {
  return bytes.size() > 4 && bytes.starts_with("ply") && (bytes[3] == '\n' || bytes[3] == '\r');
}

RawMesh ReadPly(std::string_view bytes, const std::string& name) {
  const PlyHeader header = ReadPlyHeader(bytes, name);
  if (header.format == PlyFormat::kAscii) {
    TextValues values(bytes.substr(header.size), name, header.lines);
    return PlyReader(header, values, name).Read();
  }
  BinaryValues values(bytes, name, header.size, header.format == PlyFormat::kBigEndian);
  return PlyReader(header, values, name).Read();
}

}  // namespace millpose
