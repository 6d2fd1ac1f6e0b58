// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/registration/place_fit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/decompositions.hpp"
#include "base/parallel.hpp"
#include "base/rotation.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;

/// Huber's bound by the number of equations of a point: 1.345 keeps 82.1 % of normal residuals whole, and so
/// do the others of vectors of two and three.
constexpr double kHuber[] = {0, 1.345, 1.856, 2.213};
/// Median length of a standard normal vector of one, two, three.
constexpr double kMedian[] = {1, 0.6745, 1.1774, 1.5382};
constexpr double kEfficiency = 0.95;  // of Huber's weights at that bound
constexpr double kOutlier = 4;        // standard deviations of a residual
constexpr double kStill = 1e-6;       // mm: a step that moves no point farther ends the search
constexpr int kMostSteps = 60, kWholeSteps = 30, kMostRounds = 8;
constexpr double kShorter = 0.7, kNoMatter = 0.2;  // of the smallest stated deviation
constexpr double kUndetermined = 0.002;            // of the part's size, and
constexpr double kHardly = 4;     // deviations of one point: more than both, and a direction is not known
constexpr size_t kSample = 2000;  // points of a scan that find the place roughly

class Fit {
 public:
  Fit(const ProbedPart& part, const std::vector<ProbedPoint>& points, const PartBending* frame, int threads,
      std::stop_token stop)
      : part_(part), points_(points), threads_(threads), stop_(std::move(stop)) {
    if (frame) found_.bending = *frame;
    unknowns_ = 6 + (frame ? static_cast<int>(frame->modes.size()) : 0);
    length_ = std::max(1.0, part.size());
    open_ = std::max(kUndetermined * length_, kHardly * std::ranges::max(points, {}, &ProbedPoint::sd).sd);
  }

  FittedPlace Run(const Eigen::Isometry3d& start) {
    found_.X = start;
    found_.residuals.resize(points_.size());
    equations_.resize(points_.size());
    places_.resize(points_.size());
    for (size_t stride = points_.size() / kSample; stride > 1; stride = 0) {
      Take(stride);
      Converge();
    }
    Take(1);
    for (int round = 0; round < kMostRounds; ++round) {
      found_.converged = Converge();
      if (!FlagOutliers()) break;
    }
    Judge();
    return {std::move(found_), std::move(squares_)};
  }

 private:
  void Take(size_t stride) {
    taken_.clear();
    for (size_t i = 0; i < points_.size(); i += stride) taken_.push_back(i);
  }

  /// Where the points lie on the part with the pose as it is, and their centre.
  void Look() {
    constexpr size_t kChunk = 256;
    const Eigen::Isometry3d back = found_.X.inverse(Eigen::Isometry);
    ParallelFor((taken_.size() + kChunk - 1) / kChunk, threads_, stop_, [&](size_t chunk) {
      const size_t end = std::min(taken_.size(), (chunk + 1) * kChunk);
      for (size_t k = chunk * kChunk; k < end; ++k) {
        const size_t i = taken_[k];
        std::optional<Vector3d> normal;
        if (points_[i].normal) normal = back.linear() * *points_[i].normal;
        places_[i] = back * points_[i].measured;
        equations_[i] = found_.bending ? OfBentPart(points_[i], places_[i], normal)
                                       : part_.Equations(points_[i], places_[i], normal);
      }
    });
    Vector3d sum = Vector3d::Zero();
    for (const size_t i : taken_) sum += places_[i];
    found_.centre = sum / static_cast<double>(taken_.size());
  }

  /// What a point says of the bent part: the unbent one is asked, and answers are bent with it.
  ProbeEquations OfBentPart(const ProbedPoint& point, const Vector3d& p,
                            const std::optional<Vector3d>& normal) const {
    const PartBending& bending = *found_.bending;
    const Vector3d q = bending.Unbent(p);
    const ProbeEquations flat = part_.Equations(point, q, normal);
    Vector3d foot = q;
    for (int e = 0; e < flat.count; ++e) foot -= (flat.distance[e] + point.radius) * flat.direction[e];
    const Vector3d away = p - bending.Bent(foot);
    const Eigen::Matrix3d turn = bending.Turn(foot, bending.Across());
    ProbeEquations bent;
    for (int e = 0; e < flat.count; ++e) {
      const Vector3d d = point.on == ProbedOn::kFace ? bending.BentNormal(foot, flat.direction[e])
                                                     : turn * flat.direction[e];
      bent.Add(d, d.dot(away) - point.radius);
    }
    return bent;
  }

  /// Length of a point's residual in stated standard deviations.
  double Relative(size_t i) const { return equations_[i].Length() / points_[i].sd; }
  bool Counts(size_t i) const { return equations_[i].count > 0 && !found_.residuals[i].outlier; }

  /// By how much the points scatter more than stated, by their median; at least 1.
  double RobustScale() const {
    std::vector<double> sizes;
    for (const size_t i : taken_)
      if (Counts(i)) sizes.push_back(Relative(i) / kMedian[equations_[i].count]);
    if (sizes.empty()) return 1;
    const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
    std::ranges::nth_element(sizes, middle);
    const auto n = static_cast<double>(sizes.size());
    return std::max(1.0, *middle * (n > unknowns_ ? std::sqrt(n / (n - unknowns_)) : 1.0));
  }

  /// AᵀWA and AᵀWe with w's part in mm at `length_` from the centre; weights are set.
  void Assemble(double scale) {
    normal_matrix_.setZero(unknowns_, unknowns_);
    right_.setZero(unknowns_);
    for (const size_t i : taken_) {
      ProbeResidual& residual = found_.residuals[i];
      residual.weight = 0;
      if (!Counts(i)) continue;
      const double size = Relative(i), bound = kHuber[equations_[i].count] * scale;
      residual.weight = size > bound ? bound / size : 1;
      for (int e = 0; e < equations_[i].count; ++e) {
        const ProbeVector a = Row(i, e);
        normal_matrix_ += residual.weight * a * a.transpose();
        right_ += residual.weight * equations_[i].distance[e] / points_[i].sd * a;
      }
    }
  }

  /// In stated standard deviations, w's part by mm at `length_`.
  ProbeVector Row(size_t i, int e) const {
    ProbeVector a =
        ProbeRow(equations_[i].direction[e], places_[i], found_.centre, found_.Bending()) / points_[i].sd;
    a.segment<3>(3) /= length_;
    return a;
  }

  /// Steps until the points lie still; whether they did. Between facets the nearest one may change with every
  /// step for ever: later steps become shorter, and what the last whole one would have been must not matter.
  bool Converge() {
    double step = 1, wanted = 0;
    for (int i = 0; i < kMostSteps && step > kStill; ++i) {
      Look();
      Assemble(RobustScale());
      const ProbeVector move = Solved();
      wanted = move.head<3>().norm() + move.segment<3>(3).norm() + move.tail(unknowns_ - 6).norm();
      Move(step * move);
      if (wanted < kStill) return true;
      if (i >= kWholeSteps) step *= kShorter;
    }
    return wanted < kNoMatter * LeastDeviation();
  }

  /// The smallest that is stated, mm.
  double LeastDeviation() const { return std::ranges::min(points_, {}, &ProbedPoint::sd).sd; }

  /// The step; nothing in directions that no point tells.
  ProbeVector Solved() const {
    const EigenPairs eigen = EigenOfSymmetric(normal_matrix_);
    const double least = LeastEigenvalue();
    ProbeVector move = ProbeVector::Zero(unknowns_);
    for (int k = 0; k < unknowns_; ++k) {
      const ProbeVector v = eigen.vectors.col(k);
      if (eigen.values[k] > least) move += v.dot(right_) / eigen.values[k] * v;
    }
    return move;
  }

  /// Below it a direction counts as not known: no point looks its way.
  double LeastEigenvalue() const { return 1 / (open_ * open_); }

  /// Turns about the centre, then shifts; and bends.
  void Move(const ProbeVector& move) {
    for (int k = 6; k < unknowns_; ++k) found_.bending->modes[static_cast<size_t>(k - 6)] += move[k];
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    const Vector3d w = move.segment<3>(3) / length_;
    const double angle = w.norm();
    if (angle > 0) T.linear() = RotationAbout(w / angle, angle);
    T.translation() = move.head<3>() + found_.centre - T.linear() * found_.centre;
    found_.X = found_.X * T;
    // Rounding of many products; Gram and Schmidt.
    Eigen::Matrix3d R = found_.X.linear();
    R.col(0).normalize();
    R.col(1) = (R.col(1) - R.col(0).dot(R.col(1)) * R.col(0)).normalized();
    R.col(2) = R.col(0).cross(R.col(1));
    found_.X.linear() = R;
  }

  /// Residuals in their own standard deviations; whether other points are outliers than before.
  bool FlagOutliers() {
    Look();
    const double scale = RobustScale();
    Assemble(scale);
    const ProbeMatrix inverse = Inverse(normal_matrix_);
    bool changed = false;
    for (const size_t i : taken_) {
      const ProbeEquations& equations = equations_[i];
      ProbeResidual& residual = found_.residuals[i];
      residual.no_feature = equations.count == 0;
      residual.distance = equations.count == 1 ? equations.distance[0] : equations.Length();
      double leverage = 0;  // of the pose on the residual, mean of the equations
      for (int e = 0; e < equations.count; ++e) {
        const ProbeVector a = Row(i, e);
        leverage += a.dot(inverse * a) / equations.count;
      }
      const double share = residual.outlier ? 1 + leverage : std::max(0.05, 1 - residual.weight * leverage);
      residual.standardised = Relative(i) / (scale * std::sqrt(share));
      // Two and three equations have longer residuals by chance.
      const bool outlier = residual.standardised > kOutlier * kHuber[equations.count] / kHuber[1];
      changed = changed || (outlier != residual.outlier);
      residual.outlier = outlier && equations.count > 0;
    }
    return changed;
  }

  /// Inverse on the directions that points tell.
  ProbeMatrix Inverse(const ProbeMatrix& matrix) const {
    const EigenPairs eigen = EigenOfSymmetric(matrix);
    ProbeMatrix inverse = ProbeMatrix::Zero(unknowns_, unknowns_);
    for (int k = 0; k < unknowns_; ++k)
      if (eigen.values[k] > LeastEigenvalue())
        inverse += eigen.vectors.col(k) * eigen.vectors.col(k).transpose() / eigen.values[k];
    return inverse;
  }

  /// Covariance and what cannot be told.
  void Judge() {
    // AᵀA, Aᵀe and eᵀe of the points that count, without Huber's weights.
    ProbeMatrix all = ProbeMatrix::Zero(unknowns_, unknowns_);
    ProbeVector right = ProbeVector::Zero(unknowns_);
    double squares = 0, whole = 0, plain = 0;
    for (const size_t i : taken_) {
      if (!Counts(i)) continue;
      const ProbeResidual& residual = found_.residuals[i];
      const int count = equations_[i].count;
      for (int e = 0; e < count; ++e) {
        const ProbeVector a = Row(i, e);
        const double off = equations_[i].distance[e] / points_[i].sd;
        all += a * a.transpose();
        right += off * a;
        plain += off * off;
      }
      const double psi = residual.weight * Relative(i);
      squares += psi * psi;
      whole += residual.weight == 1 ? count : 0;
      found_.used += count;
    }
    found_.covariance = Inverse(all);
    SumSquares(right, plain);
    const double kappa = Kappa(squares, whole);
    found_.covariance *= kappa;
    found_.covariance.middleRows<3>(3) /= length_;
    found_.covariance.middleCols<3>(3) /= length_;
    Undetermined(all);
  }

  /// Sums of squares that least squares leave with the first modes alone (of a linear fit: what is left out
  /// is 0, by its covariance).
  void SumSquares(const ProbeVector& right, double plain) {
    const ProbeMatrix& inverse = found_.covariance;
    const ProbeVector step = inverse * right;
    const double least = std::max(0.0, plain - right.dot(step));
    for (int kept = 6; kept <= unknowns_; ++kept) {
      const int out = unknowns_ - kept;
      ProbeVector left_out(out);
      for (int k = 0; k < out; ++k)
        left_out[k] =
            found_.bending->modes[static_cast<size_t>(kept) + static_cast<size_t>(k) - 6] + step[kept + k];
      const ProbeMatrix of = inverse.bottomRightCorner(out, out);
      squares_.push_back(out == 0 ? least : least + left_out.dot(SolveSymmetric(of, left_out)));
    }
  }

  /// By how much (AᵀA)⁻¹ is too small.
  double Kappa(double squares, double whole) {
    constexpr double kLeast = 1 / kEfficiency;
    const double freedom = found_.used - unknowns_;
    if (freedom < 1 || whole < 1) return kLeast;
    const double m = whole / found_.used;
    const double finite = 1 + static_cast<double>(unknowns_) / found_.used * (1 - m) / m;
    const double kappa = finite * finite * squares / freedom / (m * m);
    found_.scatter = std::sqrt(kappa / kLeast);
    // A variance of f degrees of freedom scatters by √(2/f); 1.645: 95 % on one side.
    found_.scatters_more = kappa / kLeast > 1 + 1.645 * std::sqrt(2 / freedom);
    return std::max(kLeast, kappa);
  }

  /// Names what is not known: shifts first, then turns with the shifts that go with them.
  void Undetermined(const ProbeMatrix& all) {
    const EigenPairs eigen = EigenOfSymmetric(all);
    Eigen::Index count = 0;  // eigenvalues ascend
    while (count < unknowns_ && eigen.values[count] <= LeastEigenvalue()) ++count;
    if (count == 0) return;
    const Eigen::MatrixXd open = eigen.vectors.leftCols(count);
    const Eigen::MatrixXd turns = open.middleRows(3, 3);
    const EigenPairs by_turn = EigenOfSymmetric(turns.transpose() * turns);
    for (Eigen::Index k = 0; k < count; ++k)
      found_.undetermined.push_back(NameOf(open * by_turn.vectors.col(k)));
  }

  static std::string NameOf(const ProbeVector& way) {
    constexpr double kMostly = 0.05;  // of the square
    const auto words = [](const Vector3d& d) {
      int largest = 0;
      d.cwiseAbs().maxCoeff(&largest);
      const Vector3d unit = (d[largest] < 0 ? -d : d).normalized();
      const auto shown = [](double x) { return std::round(100 * x) / 100 + 0.0; };  // no "-0.00"
      return fmt::format("({:.2f}, {:.2f}, {:.2f})", shown(unit.x()), shown(unit.y()), shown(unit.z()));
    };
    if (way.tail(way.size() - 6).squaredNorm() > 0.5) return "a bending";
    if (way.segment<3>(3).squaredNorm() < kMostly) return "a shift along " + words(way.head<3>());
    std::string turn = "a turn about " + words(way.segment<3>(3));
    if (way.head<3>().squaredNorm() < kMostly) return turn;
    return turn + " with a shift along " + words(way.head<3>());
  }

  const ProbedPart& part_;
  const std::vector<ProbedPoint>& points_;
  int threads_;
  std::stop_token stop_;
  double length_ = 1;  ///< mm: a turn counts by what it moves there
  double open_ = 1;    ///< mm: a direction with a larger deviation is not known
  Registration found_;
  std::vector<size_t> taken_;
  std::vector<ProbeEquations> equations_;
  std::vector<Vector3d> places_;  ///< in P
  int unknowns_ = 6;
  ProbeMatrix normal_matrix_;
  ProbeVector right_;
  std::vector<double> squares_;  ///< FittedPlace::squares
};

}  // namespace

FittedPlace FitPlace(const ProbedPart& part, const std::vector<ProbedPoint>& points,
                     const Eigen::Isometry3d& start, const PartBending* frame, int threads,
                     std::stop_token stop) {
  return Fit(part, points, frame, threads, std::move(stop)).Run(start);
}

}  // namespace millpose
