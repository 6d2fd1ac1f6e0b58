// SPDX-License-Identifier: GPL-3.0-or-later
// VTK XML PolyData (the VTK file format specification, "vtkPolyData serial"): what ParaView opens.
#include <bit>
#include <span>

#include "base/gzip.hpp"
#include "base/units.hpp"
#include "planning/result/station.hpp"
#include "report/leans.hpp"
#include "report/packed.hpp"
#include "report/report.hpp"

namespace millpose {
namespace {

// All points of the plan in order, on the part as it stands with the external axes at 0; skipped ones have 0
// in every array that describes a pose.
std::vector<const PlannedPoint*> AllPoints(const PlanResult& plan) {
  std::vector<const PlannedPoint*> points;
  for (const PassResult& pass : plan.passes)
    for (const PlannedPoint& point : pass.points) points.push_back(&point);
  return points;
}

// The plan with its vectors brought there.
PlanResult OnPart(PlanResult plan) {
  for (PassResult& pass : plan.passes) {
    if (pass.external.empty()) continue;
    for (size_t i = 0; i < pass.points.size(); ++i) {
      const Pose to_zero = ToZero(plan, ExternalAt(pass, i));
      MillingPoint& point = pass.points[i].point;
      point.position = to_zero * point.position;
      for (Eigen::Vector3d* direction : {&point.normal, &point.tool_axis, &point.feed})
        *direction = to_zero.linear() * *direction;
    }
  }
  return plan;
}

static_assert(std::endian::native == std::endian::little, "arrays are written as they lie in memory");

/// Numbers as the text of a compressed binary array: how many blocks, their size, that of a shorter last one,
/// the packed size of each, then all blocks packed; both in base64.
template <class T>
class PackedArray {
 public:
  void Add(T value) {
    block_.push_back(value);
    if (block_.size() == kBlock) EndBlock();
  }
  std::string Text() {
    header_[2] = sizeof(T) * block_.size();
    if (!block_.empty()) EndBlock();
    return Base64(Bytes(header_.data(), header_.size())) + Base64(Bytes(packed_.data(), packed_.size()));
  }

 private:
  static constexpr size_t kBlock = 8192;  // values

  template <class V>
  static std::span<const uint8_t> Bytes(const V* values, size_t count) {
    return {reinterpret_cast<const uint8_t*>(values), count * sizeof(V)};
  }
  void EndBlock() {
    const std::string packed =
        ZlibBytes({reinterpret_cast<const char*>(block_.data()), sizeof(T) * block_.size()});
    packed_ += packed;
    ++header_[0];
    header_.push_back(packed.size());
    block_.clear();
  }

  std::vector<uint64_t> header_{0, sizeof(T) * kBlock, 0};
  std::vector<T> block_;
  std::string packed_;
};

/// Collects the parts of the file, each of which is written when its turn comes.
class ArrayWriter {
 public:
  explicit ArrayWriter(const std::vector<const PlannedPoint*>& points) : points_(points) {}

  template <class Get>
  void Numbers(const std::string& name, Get get) {
    Array<double>("Float64", name, 1, points_.size(),
                  [this, get](size_t i, auto& array) { array.Add(get(*points_[i])); });
  }
  template <class Get>
  void PoseNumbers(const std::string& name, Get get) {
    Numbers(name, [get](const PlannedPoint& point) {
      return point.skip == Infeasibility::kNone ? static_cast<double>(get(point)) : 0.0;
    });
  }
  template <class Get>
  void Vectors(const std::string& name, Get get) {
    Array<double>("Float64", name, 3, points_.size(), [this, get](size_t i, auto& array) {
      for (const double value : Eigen::Vector3d(get(*points_[i]))) array.Add(value);
    });
  }
  /// `values` outlives this.
  void Indices(const std::string& name, const std::vector<size_t>& values) {
    Array<int64_t>("Int64", name, 1, values.size(),
                   [&values](size_t i, auto& array) { array.Add(static_cast<int64_t>(values[i])); });
  }
  void Line(std::string line) {
    parts_.push_back([line = std::move(line) + '\n'] { return line; });
  }
  void Write(int threads, const ByteSink& sink) const {
    WriteInOrder(
        parts_.size(), threads, {}, [&](size_t i) { return parts_[i](); }, sink);
  }

 private:
  /// `add(i, array)` adds value i of `count`.
  template <class T, class AddTo>
  void Array(const char* type, const std::string& name, int components, size_t count, const AddTo& add) {
    Line(fmt::format("<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"binary\">", type,
                     name, components));
    parts_.push_back([add, count] {
      PackedArray<T> array;
      for (size_t i = 0; i < count; ++i) add(i, array);
      return array.Text();
    });
    Line("\n</DataArray>");
  }

  const std::vector<const PlannedPoint*>& points_;
  std::vector<std::function<std::string()>> parts_;
};

struct Cells {
  std::vector<size_t> connectivity, offsets;
};

Cells Skipped(const std::vector<const PlannedPoint*>& points) {
  Cells cells;
  for (size_t i = 0; i < points.size(); ++i) {
    if (points[i]->skip == Infeasibility::kNone) continue;
    cells.connectivity.push_back(i);
    cells.offsets.push_back(cells.connectivity.size());
  }
  return cells;
}

Cells Pieces(const PlanResult& plan) {
  Cells cells;
  size_t first_of_pass = 0;
  for (const PassResult& pass : plan.passes) {
    for (const Segment& piece : pass.pieces) {
      for (int i = piece.first; i <= piece.last; ++i)
        cells.connectivity.push_back(first_of_pass + static_cast<size_t>(i));
      if (piece.closed) cells.connectivity.push_back(first_of_pass + static_cast<size_t>(piece.first));
      cells.offsets.push_back(cells.connectivity.size());
    }
    first_of_pass += pass.points.size();
  }
  return cells;
}

void AddCells(const char* tag, const Cells& cells, ArrayWriter* out) {
  out->Line(fmt::format("<{}>", tag));
  out->Indices("connectivity", cells.connectivity);
  out->Indices("offsets", cells.offsets);
  out->Line(fmt::format("</{}>", tag));
}

/// Of every point: its number and its pass.
struct PointIndices {
  explicit PointIndices(const PlanResult& plan) {
    for (const PassResult& pass : plan.passes)
      for (size_t i = 0; i < pass.points.size(); ++i) {
        numbers.push_back(numbers.size());
        passes.push_back(static_cast<size_t>(pass.pass));
      }
  }
  std::vector<size_t> numbers, passes;
};

void AddPointData(const PlanResult& plan, const PointIndices& indices, ArrayWriter* out) {
  using P = const PlannedPoint&;
  out->Line("<PointData Scalars=\"objective\">");
  out->Indices("point", indices.numbers);
  out->Indices("pass", indices.passes);
  out->Numbers("planned", [](P p) { return p.skip == Infeasibility::kNone ? 1.0 : 0.0; });
  out->Numbers("skip_reason", [](P p) { return static_cast<double>(p.skip); });
  out->PoseNumbers("piece", [](P p) { return p.piece; });
  out->Numbers("s_mm", [](P p) { return p.point.arc_length; });
  out->PoseNumbers("objective", [](P p) { return p.objective; });
  out->PoseNumbers("lambda_t1_mm_N", [](P p) { return p.indices.lambda_t1; });
  out->PoseNumbers("lambda_t2_mm_N", [](P p) { return p.indices.lambda_t2; });
  out->PoseNumbers("lambda_n_mm_N", [](P p) { return p.indices.lambda_n; });
  out->PoseNumbers("normal_compliance_mm_N", [](P p) { return p.indices.normal_compliance; });
  out->PoseNumbers("mu", [](P p) { return p.indices.mu; });
  out->PoseNumbers("dexterity", [](P p) { return p.dexterity; });
  out->PoseNumbers("clearance_mm", [](P p) { return p.clearance; });
  out->PoseNumbers("rotation_deg", [](P p) { return RadToDeg(p.freedoms.at(0)); });
  if (HasLeans(plan)) {
    out->PoseNumbers("lead_deg", [](P p) { return RadToDeg(LeansOf(p).lead); });
    out->PoseNumbers("tilt_deg", [](P p) { return RadToDeg(LeansOf(p).tilt); });
  }
  out->PoseNumbers("branch", [](P p) { return p.branch; });
  for (int i = 0; i < 6; ++i)
    out->PoseNumbers(fmt::format("a{}_deg", i + 1), [i](P p) { return RadToDeg(p.q[i]); });
  out->Numbers("feed_mm_min", [](P p) { return p.point.feed_rate * 60; });
  out->Vectors("normal", [](P p) { return p.point.normal; });
  out->Vectors("tool_axis", [](P p) { return p.point.tool_axis; });
  out->Vectors("feed_direction", [](P p) { return p.point.feed; });
  out->Line("</PointData>");
}

}  // namespace

void WritePathVtp(const PlanResult& planned, int threads, const ByteSink& sink) {
  std::optional<PlanResult> moved;
  if (!planned.external_axes.empty()) moved = OnPart(planned);
  const PlanResult& plan = moved ? *moved : planned;
  const std::vector<const PlannedPoint*> points = AllPoints(plan);
  const Cells skipped = Skipped(points), pieces = Pieces(plan);
  const PointIndices indices(plan);
  ArrayWriter out(points);
  out.Line("<?xml version=\"1.0\"?>");
  out.Line(
      "<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\" "
      "compressor=\"vtkZLibDataCompressor\">");
  out.Line("<PolyData>");
  out.Line(
      fmt::format("<Piece NumberOfPoints=\"{}\" NumberOfVerts=\"{}\" NumberOfLines=\"{}\" "
                  "NumberOfStrips=\"0\" NumberOfPolys=\"0\">",
                  points.size(), skipped.offsets.size(), pieces.offsets.size()));
  AddPointData(plan, indices, &out);
  out.Line("<Points>");
  out.Vectors("position_mm", [](const PlannedPoint& p) { return p.point.position; });
  out.Line("</Points>");
  AddCells("Verts", skipped, &out);
  AddCells("Lines", pieces, &out);
  out.Line("</Piece>\n</PolyData>\n</VTKFile>");
  out.Write(threads, sink);
}

}  // namespace millpose
