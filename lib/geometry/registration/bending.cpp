// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/registration/bending.hpp"

#include <cmath>
#include <map>

#include "base/decompositions.hpp"

namespace millpose {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

/// A mode with its derivatives by u and v.
struct ModeValue {
  double value, by_u, by_v, by_uu, by_uv, by_vv;
};

/// P₂ and P₃ with their derivatives.
double P2(double x) { return 1.5 * x * x - 0.5; }
double P3(double x) { return x * (2.5 * x * x - 1.5); }

ModeValue ModeAt(size_t mode, double u, double v) {
  switch (mode) {
    case 0:
      return {P2(u), 3 * u, 0, 3, 0, 0};
    case 1:
      return {u * v, v, u, 0, 1, 0};
    case 2:
      return {P2(v), 0, 3 * v, 0, 0, 3};
    case 3:
      return {P3(u), 7.5 * u * u - 1.5, 0, 15 * u, 0, 0};
    case 4:
      return {P2(u) * v, 3 * u * v, P2(u), 3 * v, 3 * u, 0};
    default:
      return {u * P2(v), P2(v), 3 * u * v, 0, 3 * v, 3 * u};
  }
}

/// d, ∇d (mm/mm) and its second derivatives (1/mm) at a point.
struct FieldValue {
  double d = 0, z = 0;
  Vector3d slope = Vector3d::Zero();
  Matrix3d curvature = Matrix3d::Zero();
};

/// Coordinates of a point in the frame of a bending.
class PlateCoordinates {
 public:
  explicit PlateCoordinates(const PartBending& bending)
      : origin_(bending.origin),
        w_(bending.Across()),
        by_u_(bending.u / bending.u.squaredNorm()),
        by_v_(bending.v / bending.v.squaredNorm()) {}

  const Vector3d& w() const { return w_; }
  Vector3d Slope(const ModeValue& mode) const { return mode.by_u * by_u_ + mode.by_v * by_v_; }
  double z(const Vector3d& p) const { return w_.dot(p - origin_); }
  ModeValue Mode(size_t mode, const Vector3d& p) const {
    return ModeAt(mode, by_u_.dot(p - origin_), by_v_.dot(p - origin_));
  }
  FieldValue At(const std::vector<double>& modes, const Vector3d& p) const {
    FieldValue field;
    field.z = z(p);
    for (size_t i = 0; i < modes.size(); ++i) {
      const ModeValue mode = Mode(i, p);
      field.d += modes[i] * mode.value;
      field.slope += modes[i] * Slope(mode);
      field.curvature += modes[i] * (mode.by_uu * by_u_ * by_u_.transpose() +
                                     mode.by_uv * (by_u_ * by_v_.transpose() + by_v_ * by_u_.transpose()) +
                                     mode.by_vv * by_v_ * by_v_.transpose());
    }
    return field;
  }
  /// As At() has it, without curvature: it is asked often.
  Vector3d Shift(const std::vector<double>& modes, const Vector3d& p) const {
    const double u = by_u_.dot(p - origin_), v = by_v_.dot(p - origin_);
    double d = 0, along_u = 0, along_v = 0;
    for (size_t i = 0; i < modes.size(); ++i) {
      const ModeValue mode = ModeAt(i, u, v);
      d += modes[i] * mode.value;
      along_u += modes[i] * mode.by_u;
      along_v += modes[i] * mode.by_v;
    }
    return d * w_ - z(p) * (along_u * by_u_ + along_v * by_v_);
  }

 private:
  Vector3d origin_, w_, by_u_, by_v_;
};

/// The rotation by the shortest way from one unit vector to another near it.
Matrix3d ShortestTurn(const Vector3d& from, const Vector3d& to) {
  const Vector3d axis = from.cross(to);
  Matrix3d cross;
  cross << 0, -axis.z(), axis.y(), axis.z(), 0, -axis.x(), -axis.y(), axis.x(), 0;
  return Matrix3d::Identity() + cross + cross * cross / (1 + from.dot(to));
}

}  // namespace

Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, kMostModes> PartBending::ModeShifts(const Vector3d& p) const {
  const PlateCoordinates plate(*this);
  Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, kMostModes> shifts(3, modes.size());
  for (size_t i = 0; i < modes.size(); ++i) {
    const ModeValue mode = plate.Mode(i, p);
    shifts.col(static_cast<Eigen::Index>(i)) = mode.value * plate.w() - plate.z(p) * plate.Slope(mode);
  }
  return shifts;
}

double PartBending::Height(const Vector3d& p) const { return PlateCoordinates(*this).At(modes, p).d; }

double PartBending::Slope(const Vector3d& p) const {
  return PlateCoordinates(*this).At(modes, p).slope.norm();
}

Vector3d PartBending::Bent(const Vector3d& p) const { return p + PlateCoordinates(*this).Shift(modes, p); }

Vector3d PartBending::Unbent(const Vector3d& p) const {
  // Every step leaves a share of the error as large as the slope; the shift is far below the part's size.
  constexpr int kSteps = 60;
  constexpr double kStill = 1e-11;  // mm
  const PlateCoordinates plate(*this);
  Vector3d unbent = p;
  for (int i = 0; i < kSteps; ++i) {
    const Vector3d next = p - plate.Shift(modes, unbent);
    const double moved = (next - unbent).norm();
    unbent = next;
    if (moved < kStill) break;
  }
  return unbent;
}

Matrix3d PartBending::Gradient(const Vector3d& p) const {
  const PlateCoordinates plate(*this);
  const FieldValue field = plate.At(modes, p);
  return Matrix3d::Identity() + plate.w() * field.slope.transpose() - field.slope * plate.w().transpose() -
         field.z * field.curvature;
}

Vector3d PartBending::SmallTurn(const Vector3d& p) const {
  const PlateCoordinates plate(*this);
  return plate.At(modes, p).slope.cross(plate.w());
}

Vector3d PartBending::BentNormal(const Vector3d& p, const Vector3d& n) const {
  return (Gradient(p).inverse().transpose() * n).normalized();
}

Matrix3d PartBending::Turn(const Vector3d& p, const Vector3d& n) const {
  const PlateCoordinates plate(*this);
  const Vector3d across = (plate.w() - plate.At(modes, p).slope).normalized();
  const Matrix3d with_plate = ShortestTurn(plate.w(), across);
  return ShortestTurn(with_plate * n, BentNormal(p, n)) * with_plate;
}

namespace {

constexpr double kAlike = 0.98;  // of the moments of the two widest axes

/// Of a surface: its centre and second moments, by area.
std::pair<Vector3d, Matrix3d> Moments(const Triangles& part) {
  const auto corner = [&](const std::array<int, 3>& face, size_t k) -> const Vector3d& {
    return part.vertices[static_cast<size_t>(face[k])];
  };
  double area = 0;
  Vector3d centre = Vector3d::Zero();
  Matrix3d moments = Matrix3d::Zero();
  const auto area_of = [&](const std::array<int, 3>& face) {
    return 0.5 * (corner(face, 1) - corner(face, 0)).cross(corner(face, 2) - corner(face, 0)).norm();
  };
  for (const auto& face : part.faces) {
    area += area_of(face);
    centre += area_of(face) / 3 * (corner(face, 0) + corner(face, 1) + corner(face, 2));
  }
  centre /= area;
  for (const auto& face : part.faces) {
    Vector3d sum = Vector3d::Zero();
    Matrix3d squares = Matrix3d::Zero();
    for (size_t k = 0; k < 3; ++k) {
      const Vector3d p = corner(face, k) - centre;
      sum += p;
      squares += p * p.transpose();
    }
    moments += area_of(face) / 12 * (sum * sum.transpose() + squares);
  }
  return {centre, moments};
}

/// The same line, its largest coordinate above 0.
Vector3d Signed(const Vector3d& axis) {
  int largest = 0;
  axis.cwiseAbs().maxCoeff(&largest);
  return axis[largest] < 0 ? -axis : axis;
}

Vector3d RoundedAxis(const Vector3d& p) {
  constexpr double kDecimals = 1e4;
  return (kDecimals * p).array().round().matrix() / kDecimals + Vector3d::Zero();
}

}  // namespace

PartBending PlateFrame(const Mesh& mesh) {
  const Triangles& part = mesh.triangles();
  const auto [centre, moments] = Moments(part);
  const EigenPairs3 axes = EigenOfSymmetric3(moments);
  const Vector3d w = Signed(axes.vectors.col(0));
  Vector3d u = axes.vectors.col(2);
  if (axes.values[1] > kAlike * axes.values[2]) {
    constexpr double kSame = 1e-6;
    int best = 0;
    while (std::abs(w[best]) > w.cwiseAbs().minCoeff() + kSame) ++best;
    u = (Vector3d::Unit(best) - w[best] * w).normalized();
  }
  u = Signed(u);
  const Vector3d v = w.cross(u);
  Vector2d lower(1e300, 1e300), upper(-1e300, -1e300);
  for (const auto& face : part.faces)
    for (const int vertex : face) {
      const Vector3d p = part.vertices[static_cast<size_t>(vertex)] - centre;
      lower = lower.cwiseMin(Vector2d(u.dot(p), v.dot(p)));
      upper = upper.cwiseMax(Vector2d(u.dot(p), v.dot(p)));
    }
  const Vector2d middle = 0.5 * (lower + upper), half = 0.5 * (upper - lower);
  PartBending frame;
  frame.origin = RoundedAxis(centre + middle[0] * u + middle[1] * v);
  frame.u = RoundedAxis(half[0] * u);
  frame.v = RoundedAxis(half[1] * v);
  return frame;
}

namespace {

/// Divides sides at their middles until all lie on the bent surface.
class Divider {
 public:
  Divider(const Triangles& part, const PartBending& bending, double within)
      : done_(part), bending_(bending), within_(within) {
    for (const Vector3d& p : part.vertices) bent_.push_back(bending.Bent(p));
  }

  Triangles Run() {
    constexpr int kMostRounds = 24;
    for (int round = 0; round < kMostRounds && Divide(); ++round) {
    }
    done_.vertices = std::move(bent_);
    return std::move(done_);
  }

 private:
  using Side = std::pair<int, int>;

  /// Whether the bent side leaves the straight one, in its middle or at a quarter of it.
  bool IsOff(int a, int b) const {
    const auto at = [&](double t) {
      const Vector3d p =
          (1 - t) * done_.vertices[static_cast<size_t>(a)] + t * done_.vertices[static_cast<size_t>(b)];
      const Vector3d line = (1 - t) * bent_[static_cast<size_t>(a)] + t * bent_[static_cast<size_t>(b)];
      return (bending_.Bent(p) - line).norm() > within_;
    };
    return at(0.5) || at(0.25) || at(0.75);
  }

  /// The new corner in the middle of a side; −1 where it need not be divided.
  int MiddleOf(int a, int b) {
    const auto [found, is_new] = middles_.try_emplace({std::min(a, b), std::max(a, b)}, -1);
    if (!is_new || !IsOff(found->first.first, found->first.second)) return found->second;
    found->second = static_cast<int>(done_.vertices.size());
    done_.vertices.push_back(
        0.5 * (done_.vertices[static_cast<size_t>(a)] + done_.vertices[static_cast<size_t>(b)]));
    bent_.push_back(bending_.Bent(done_.vertices.back()));
    return found->second;
  }

  bool Divide() {
    middles_.clear();
    const std::vector<std::array<int, 3>> faces = std::move(done_.faces);
    const std::vector<int> source = std::move(done_.source);
    done_.faces.clear();
    done_.source.clear();
    for (size_t f = 0; f < faces.size(); ++f) {
      DivideFace(faces[f]);
      if (!source.empty()) done_.source.resize(done_.faces.size(), source[f]);
    }
    return done_.faces.size() > faces.size();
  }

  void DivideFace(const std::array<int, 3>& face) {
    std::array<int, 3> middle{};
    int count = 0;
    for (size_t k = 0; k < 3; ++k) {
      middle[k] = MiddleOf(face[k], face[(k + 1) % 3]);
      count += middle[k] >= 0 ? 1 : 0;
    }
    auto& faces = done_.faces;
    if (count == 0) {
      faces.push_back(face);
      return;
    }
    // From here on the first side is divided, and of two the last one is not.
    size_t k = 0;
    while (middle[k] < 0 || (count == 2 && middle[(k + 2) % 3] >= 0)) ++k;
    const int a = face[k], b = face[(k + 1) % 3], c = face[(k + 2) % 3];
    const int ab = middle[k], bc = middle[(k + 1) % 3], ca = middle[(k + 2) % 3];
    if (count == 1) {
      faces.insert(faces.end(), {{a, ab, c}, {ab, b, c}});
    } else if (count == 2) {
      faces.insert(faces.end(), {{ab, b, bc}, {a, ab, bc}, {a, bc, c}});
    } else {
      faces.insert(faces.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
  }

  Triangles done_;  ///< unbent
  std::vector<Vector3d> bent_;
  const PartBending& bending_;
  double within_;
  std::map<Side, int> middles_;
};

}  // namespace

Triangles BentTriangles(const Triangles& part, const PartBending& bending, double within) {
  return Divider(part, bending, within).Run();
}

Triangles UnbentTriangles(Triangles bent, const PartBending& bending) {
  for (Vector3d& p : bent.vertices) p = bending.Unbent(p);
  return bent;
}

std::pair<double, Vector3d> LargestBending(const Triangles& part, const PartBending& bending) {
  std::pair<double, Vector3d> largest{0, bending.origin};
  for (const Vector3d& p : part.vertices)
    if (const double d = std::abs(bending.Height(p)); d > largest.first) largest = {d, p};
  return largest;
}

double SteepestBending(const Triangles& part, const PartBending& bending) {
  double steepest = 0;
  for (const Vector3d& p : part.vertices) steepest = std::max(steepest, bending.Slope(p));
  return steepest;
}

}  // namespace millpose
