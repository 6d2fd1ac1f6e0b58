// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/strategies/level_lines.hpp"

#include "base/error.hpp"
#include "base/parallel.hpp"
#include "geometry/slice/link_chains.hpp"

namespace millpose {
namespace {

constexpr size_t kMostTriangles = 4'000'000;  // half a gigabyte

uint64_t KeyOf(int a, int b) {
  const auto [low, high] = std::minmax(a, b);
  return (static_cast<uint64_t>(low) << 32) | static_cast<uint64_t>(high);
}

// Where a function changes its sign between two points, by the false position (Illinois: Dowell and Jarratt
// 1971); on the side of `high`, where it is not negative.
Eigen::Vector3d Root(const std::function<double(const Eigen::Vector3d&)>& value, const Eigen::Vector3d& low,
                     double at_low, const Eigen::Vector3d& high, double at_high) {
  constexpr double kAccuracy = 1e-10;  // mm
  double from = 0, to = 1;
  int side = 0;
  for (int i = 0; i < 100 && at_high > kAccuracy && (to - from) * (high - low).norm() > kAccuracy; ++i) {
    const double share = (from * at_high - to * at_low) / (at_high - at_low);
    const double here = value(low + share * (high - low));
    if (here >= 0) {
      to = share;
      at_high = here;
      if (side > 0) at_low /= 2;
      side = 1;
    } else {
      from = share;
      at_low = here;
      if (side < 0) at_high /= 2;
      side = -1;
    }
  }
  return low + to * (high - low);
}

/// Marches through triangles that are fine enough.
class March {
 public:
  March(const Region& region, std::function<double(int, const Eigen::Vector3d&)> relative, double jump,
        double tolerance)
      : region_(region), relative_(std::move(relative)), jump_(jump), tolerance_(tolerance) {}

  /// A triangle with the relative values of its corners.
  void Cross(const std::array<int, 3>& corners, const std::array<Eigen::Vector3d, 3>& places, int face,
             const std::array<double, 3>& values) {
    uint64_t from = 0, to = 0;
    Eigen::Vector3d start, end;
    int crossings = 0;
    for (int k = 0; k < 3; ++k) {
      const int next = (k + 1) % 3;
      const bool in = values[k] >= 0;
      if (in == (values[next] >= 0)) continue;
      ++crossings;
      // At a seam the function jumps: there is no crossing, and the line goes on in the next turn.
      if (std::abs(values[k] - values[next]) >= jump_) return;
      const uint64_t key = KeyOf(corners[k], corners[next]);
      (in ? from : to) = key;
      const int low = in ? next : k, high = in ? k : next;
      (in ? start : end) = Crossing(key, face, places[low], values[low], places[high], values[high]);
    }
    if (crossings == 2) parts_.push_back({LinePiece(face, start, end), from, to});
  }

  /// The pieces end to end: open lines first, then closed ones.
  std::vector<Curve> Chains() const {
    std::vector<Curve> curves;
    for (const LinkChain& chain : ChainLinks<std::unordered_map<uint64_t, size_t>>(parts_)) {
      Curve curve;
      curve.closed = chain.closed;
      for (const size_t i : chain.links)
        AddRefined(parts_[i].piece.face, parts_[i].piece.start, parts_[i].piece.end, 8, curve);
      if (!curve.pieces.empty()) curves.push_back(std::move(curve));
    }
    return curves;
  }

 private:
  struct Part {
    CurvePiece piece;
    uint64_t from, to;
  };

  Eigen::Vector3d Crossing(uint64_t edge, int face, const Eigen::Vector3d& low, double at_low,
                           const Eigen::Vector3d& high, double at_high) {
    const auto [entry, added] = crossings_.try_emplace(edge);
    if (added)
      entry->second =
          Root([&](const Eigen::Vector3d& p) { return relative_(face, p); }, low, at_low, high, at_high);
    return entry->second;
  }

  // A line with a corner or a bend between two edges: points are added where the chord misses the level.
  void AddRefined(int face, const Eigen::Vector3d& a, const Eigen::Vector3d& b, int depth,
                  Curve& curve) const {
    if (a == b) return;
    Eigen::Vector3d middle = (a + b) / 2;
    if (depth > 0 && std::abs(relative_(face, middle)) > tolerance_ && MoveToLevel(face, b - a, middle)) {
      AddRefined(face, a, middle, depth - 1, curve);
      AddRefined(face, middle, b, depth - 1, curve);
    } else {
      curve.pieces.push_back(LinePiece(face, a, b));
    }
  }

  // Moves p across the way, within its face, to where the level is; false when it is not found there.
  bool MoveToLevel(int face, const Eigen::Vector3d& way, Eigen::Vector3d& p) const {
    const Mesh& mesh = region_.mesh();
    const double value = relative_(face, p);
    const bool inside = value >= 0;
    // The function grows to the left of the way.
    Eigen::Vector3d across = mesh.FaceNormal(face).cross(way).normalized();
    across *= (inside ? -1 : 1) * std::min(2 * std::abs(value), way.norm());
    Eigen::Vector3d far = p + across;
    double at_far = relative_(face, far);
    if ((at_far >= 0) == inside) {
      far = p + across.normalized() * way.norm();
      at_far = relative_(face, far);
    }
    if ((at_far >= 0) == inside) return false;
    const auto here = [&](const Eigen::Vector3d& q) { return relative_(face, q); };
    const Eigen::Vector3d near =
        inside ? Root(here, far, at_far, p, value) : Root(here, p, value, far, at_far);
    if (mesh.ClosestOnFace(near, face).distance > 1e-9) return false;
    p = near;
    return true;
  }

  const Region& region_;
  std::function<double(int, const Eigen::Vector3d&)> relative_;
  double jump_, tolerance_;
  std::vector<Part> parts_;
  std::unordered_map<uint64_t, Eigen::Vector3d> crossings_;
};

}  // namespace

LevelLines::LevelLines(const Region& region, LevelField field, double longest, double tolerance,
                       std::stop_token stop)
    : region_(region), field_(std::move(field)), longest_(longest), tolerance_(tolerance) {
  const Triangles& mesh = region.mesh().triangles();
  std::vector<int> numbers(mesh.vertices.size(), -1);
  double area = 0;
  for (int face = 0; face < region.mesh().face_count(); ++face) {
    if (!region.HasFace(face)) continue;
    Triangle triangle{{}, face};
    for (int k = 0; k < 3; ++k) {
      int& number = numbers[mesh.faces[face][k]];
      if (number < 0) number = AddVertex(mesh.vertices[mesh.faces[face][k]], face);
      triangle.corners[k] = number;
    }
    triangles_.push_back(triangle);
    area += (region.mesh().Corner(face, 1) - region.mesh().Corner(face, 0))
                .cross(region.mesh().Corner(face, 2) - region.mesh().Corner(face, 0))
                .norm() /
            2;
  }
  // None will be larger than an equilateral one.
  if (area > std::sqrt(3) / 4 * longest_ * longest_ * kMostTriangles) Refuse();
  Halve(nullptr, stop);
}

double LevelLines::Relative(double value, double level) const {
  const double relative = value - level;
  return std::isfinite(field_.period) ? relative - field_.period * std::round(relative / field_.period)
                                      : relative;
}

int LevelLines::AddVertex(const Eigen::Vector3d& p, int face) {
  vertices_.push_back(p);
  values_.push_back(field_.value(face, p));
  largest_ = std::max(largest_, values_.back());
  return static_cast<int>(vertices_.size()) - 1;
}

// Whether the level may lie near an edge on which the function is not straight. Looked at in the quarters: a
// bend just in the middle would not show there.
bool LevelLines::Bends(int a, int b, const Eigen::Vector3d& middle, int face, double level) const {
  const double length = (vertices_[a] - vertices_[b]).norm();
  if (length <= 2 * tolerance_) return false;
  const double at_a = Relative(values_[a], level), at_b = Relative(values_[b], level);
  if (std::abs(at_a - at_b) >= field_.period / 2 || std::min(std::abs(at_a), std::abs(at_b)) > length)
    return false;
  double error = 0;
  for (const double share : {0.25, 0.5, 0.75}) {
    const Eigen::Vector3d p = share == 0.5 ? middle : vertices_[a] + share * (vertices_[b] - vertices_[a]);
    const double here = Relative(field_.value(face, p), level);
    error = std::max(error, std::abs(here - at_a - share * (at_b - at_a)));
  }
  return error > tolerance_ && std::min(at_a, at_b) <= 2 * error && std::max(at_a, at_b) >= -2 * error;
}

// Whether a spiral winds on by so much along an edge that its turns could be mistaken for each other.
bool LevelLines::Winds(int a, int b, const Eigen::Vector3d& middle) const {
  if (!field_.winding) return false;
  const double at_a = field_.winding(vertices_[a]), at_b = field_.winding(vertices_[b]);
  const double at_middle = field_.winding(middle);
  const auto [low, high] = std::minmax({at_a, at_middle, at_b});
  return high - low > field_.period / 4;
}

// The vertex in the middle of a side, or -1 when the side is short enough.
int LevelLines::Middle(const Triangle& triangle, int k, const double* level, EdgeMap& middles) {
  const int a = triangle.corners[k], b = triangle.corners[(k + 1) % 3];
  const auto [entry, added] = middles.try_emplace(KeyOf(a, b), -1);
  if (added) {
    const Eigen::Vector3d middle = (vertices_[a] + vertices_[b]) / 2;
    if ((vertices_[a] - vertices_[b]).norm() > longest_ || Winds(a, b, middle) ||
        (level != nullptr && Bends(a, b, middle, triangle.face, *level)))
      entry->second = AddVertex(middle, triangle.face);
  }
  return entry->second;
}

bool LevelLines::Split(const Triangle& triangle, const double* level, EdgeMap& middles,
                       std::vector<Triangle>& halves) {
  std::array<int, 3> corner = triangle.corners, middle{};
  for (int k = 0; k < 3; ++k) middle[k] = Middle(triangle, k, level, middles);
  const int halved = static_cast<int>(std::ranges::count_if(middle, [](int m) { return m >= 0; }));
  // Turn it so that side 0 is halved and, of two, side 1 is the other.
  for (int turn = 0;
       halved < 3 && halved > 0 && turn < 3 && !(middle[0] >= 0 && (halved == 1 || middle[1] >= 0)); ++turn) {
    std::rotate(corner.begin(), corner.begin() + 1, corner.end());
    std::rotate(middle.begin(), middle.begin() + 1, middle.end());
  }
  const auto [a, b, c] = corner;
  const auto add = [&](int p, int q, int r) { halves.push_back({{p, q, r}, triangle.face}); };
  if (halved == 1) {
    add(a, middle[0], c);
    add(middle[0], b, c);
  } else if (halved == 2) {
    add(middle[0], b, middle[1]);
    add(a, middle[0], middle[1]);
    add(a, middle[1], c);
  } else if (halved == 3) {
    for (int k = 0; k < 3; ++k) add(corner[k], middle[k], middle[(k + 2) % 3]);
    add(middle[0], middle[1], middle[2]);
  }
  return halved > 0;
}

void LevelLines::Refuse() const {
  throw InputError({},
                   fmt::format("toolpath: passes this close need more than {} triangles (edges of {:.3f} mm) "
                               "on the region; give a larger step-over, measure it on planes "
                               "(stepover_on), move the axis, or narrow the region",
                               kMostTriangles, longest_));
}

void LevelLines::Halve(const double* level, const std::stop_token& stop) {
  EdgeMap middles;
  std::vector<Triangle> pending;
  pending.swap(triangles_);
  // What an edge needs is known from the edge alone: a triangle that was not halved never will be.
  while (!pending.empty()) {
    CheckStop(stop);
    std::vector<Triangle> halves;
    for (const Triangle& triangle : pending) {
      const bool far = level != nullptr && std::ranges::all_of(triangle.corners, [&](int v) {
                         return std::abs(Relative(values_[v], *level)) > longest_;
                       });
      if (far || !Split(triangle, level, middles, halves)) triangles_.push_back(triangle);
    }
    pending = std::move(halves);
    if (triangles_.size() + pending.size() > kMostTriangles) Refuse();
  }
}

std::vector<Curve> LevelLines::At(double level, std::stop_token stop) {
  Halve(&level, stop);
  March march(
      region_, [&](int face, const Eigen::Vector3d& p) { return Relative(field_.value(face, p), level); },
      field_.period / 2, tolerance_);
  for (const Triangle& triangle : triangles_) {
    std::array<Eigen::Vector3d, 3> places;
    std::array<double, 3> values;
    for (int k = 0; k < 3; ++k) {
      places[k] = vertices_[triangle.corners[k]];
      values[k] = Relative(values_[triangle.corners[k]], level);
    }
    march.Cross(triangle.corners, places, triangle.face, values);
  }
  return march.Chains();
}

}  // namespace millpose
