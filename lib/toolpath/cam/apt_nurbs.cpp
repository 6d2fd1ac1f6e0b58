// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/cam/apt_nurbs.hpp"

#include <algorithm>

namespace millpose {
namespace {

using Vector = Eigen::Vector3d;
using Homogeneous = Eigen::Vector4d;

constexpr size_t kMostDegree = 25;
constexpr size_t kMostControl = 100'000;
constexpr size_t kMostPoints = 1'000'000;
constexpr int kMostHalvings = 40;  // 2^-40 of a span is below the rounding of coordinates

Vector Place3(const Homogeneous& h) { return h.head<3>() / h[3]; }

std::vector<Homogeneous> Homogeneously(const std::vector<Vector>& control,
                                       const std::vector<double>& weights) {
  std::vector<Homogeneous> points;
  for (size_t i = 0; i < control.size(); ++i) {
    const double w = weights.empty() ? 1 : weights[i];
    points.emplace_back(w * control[i].x(), w * control[i].y(), w * control[i].z(), w);
  }
  return points;
}

double DistanceFromChord(const Vector& p, const Vector& a, const Vector& b) {
  const Vector ab = b - a;
  const double length = ab.squaredNorm();
  const double share = length > 0 ? std::clamp((p - a).dot(ab) / length, 0.0, 1.0) : 0;
  return (p - a - share * ab).norm();
}

// With weights above 0 the curve stays in the hull of its control points.
bool IsFlat(const std::vector<Homogeneous>& bezier, double tolerance) {
  const Vector a = Place3(bezier.front()), b = Place3(bezier.back());
  return std::ranges::all_of(
      bezier, [&](const Homogeneous& h) { return DistanceFromChord(Place3(h), a, b) <= tolerance; });
}

class Flattener {
 public:
  Flattener(double tolerance, const SourceLocation& place, std::vector<Vector>& points)
      : tolerance_(tolerance), place_(place), points_(points) {}

  void Append(std::vector<Homogeneous> left, int halvings) {
    if (halvings >= kMostHalvings || IsFlat(left, tolerance_)) {
      if (points_.size() >= kMostPoints)
        throw InputError(place_,
                         fmt::format("a NURBS of more than {} points: is the chord tolerance of {} mm "
                                     "meant?",
                                     kMostPoints, tolerance_));
      points_.push_back(Place3(left.back()));
      return;
    }
    // De Casteljau: `left` becomes the first half.
    std::vector<Homogeneous> right = left;
    for (size_t round = 1; round < left.size(); ++round) {
      for (size_t i = 0; i + round < right.size(); ++i) right[i] = 0.5 * (right[i] + right[i + 1]);
      left[round] = right[0];
    }
    Append(std::move(left), halvings + 1);
    Append(std::move(right), halvings + 1);
  }

 private:
  double tolerance_;
  const SourceLocation& place_;
  std::vector<Vector>& points_;
};

}  // namespace

AptNurbs::AptNurbs(const AptStatement& statement) : place_(statement.major.place) {
  header_ = Numbers(statement, 1, 8);
}

void AptNurbs::Add(const AptStatement& statement) {
  if (statement.major.text == "CNTRL") {
    const std::vector<double> v = Numbers(statement, 3, 4);
    control_.emplace_back(v[0], v[1], v[2]);
    if (v.size() == 4) weights_.push_back(v[3]);
    if (control_.size() > kMostControl)
      throw InputError(statement.major.place, fmt::format("more than {} control points", kMostControl));
    return;
  }
  std::vector<double>& list = statement.major.text == "KNOT" ? knots_ : weights_;
  const std::vector<double> v = Numbers(statement, 1, kMostControl);
  list.insert(list.end(), v.begin(), v.end());
}

const std::vector<Vector>& AptNurbs::Check() {
  const size_t n = control_.size(), k = knots_.size();
  const auto refuse = [&](const std::string& why) { throw InputError(place_, "the NURBS " + why); };
  if (n < 2 || k < n + 2 || k - n - 1 > kMostDegree || k - n - 1 >= n)
    refuse(fmt::format("has {} control points and {} knots, which make no curve", n, k));
  degree_ = k - n - 1;
  const double d = static_cast<double>(degree_);
  if (header_[0] != d && header_[0] != d + 1)
    refuse(fmt::format("states a degree or order of {}; {} control points and {} knots are of degree {}",
                       header_[0], n, k, degree_));
  for (size_t i = 1; i < header_.size(); ++i)
    if (header_[i] != static_cast<double>(n) && header_[i] != static_cast<double>(k))
      refuse(fmt::format("states {}, and there are {} control points and {} knots", header_[i], n, k));
  for (size_t i = 1; i < k; ++i)
    if (!(knots_[i] >= knots_[i - 1])) refuse("has knots that fall");
  for (size_t i = 1; i + degree_ + 1 < k; ++i)
    if (degree_ > 0 && knots_[i] == knots_[i + degree_])
      refuse("has an inner knot that is there more often than its degree allows");
  if (!(knots_[n] > knots_[degree_])) refuse("has knots that span nothing");
  if (!weights_.empty() && weights_.size() != n)
    refuse(fmt::format("has {} weights for {} control points", weights_.size(), n));
  for (const double w : weights_)
    if (!(w > 1e-9 && w < 1e9)) refuse(fmt::format("has a weight of {}; they must be above 0", w));
  return control_;
}

// The control points of the span between the knots `span` and `span` + 1: blossoms, by de Boor's scheme with
// the span's two ends as arguments.
std::vector<Homogeneous> AptNurbs::Bezier(const std::vector<Homogeneous>& control, size_t span) const {
  std::vector<Homogeneous> bezier;
  for (size_t ends = 0; ends <= degree_; ++ends) {  // how many arguments are the span's end
    std::vector<Homogeneous> d(control.begin() + static_cast<long>(span - degree_),
                               control.begin() + static_cast<long>(span + 1));
    for (size_t r = 1; r <= degree_; ++r) {
      const double u = knots_[r <= ends ? span + 1 : span];
      for (size_t j = degree_; j >= r; --j) {
        const double low = knots_[j + span - degree_], high = knots_[j + 1 + span - r];
        const double share = (u - low) / (high - low);
        d[j] = (1 - share) * d[j - 1] + share * d[j];
      }
    }
    bezier.push_back(d[degree_]);
  }
  return bezier;
}

Vector AptNurbs::Start(const std::vector<Vector>& control) const {
  const std::vector<Homogeneous> points = Homogeneously(control, weights_);
  size_t span = degree_;
  while (!(knots_[span + 1] > knots_[span])) ++span;
  return Place3(Bezier(points, span).front());
}

std::vector<Vector> AptNurbs::Points(const std::vector<Vector>& control, double tolerance) const {
  const std::vector<Homogeneous> points = Homogeneously(control, weights_);
  std::vector<Vector> chords;
  Flattener flattener(tolerance, place_, chords);
  for (size_t span = degree_; span < control.size(); ++span)
    if (knots_[span + 1] > knots_[span]) flattener.Append(Bezier(points, span), 0);
  return chords;
}

}  // namespace millpose
