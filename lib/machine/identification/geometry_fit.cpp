// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "base/decompositions.hpp"
#include "base/error.hpp"
#include "machine/identification/geometry_point.hpp"
#include "machine/motion/rotation_vector.hpp"

namespace millpose {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using geometry_fit::Aligned;
using geometry_fit::Cross;
using geometry_fit::kCount;
using geometry_fit::kLookedFor;
using geometry_fit::kOfBase;
using geometry_fit::kOfFrame;
using geometry_fit::kOfReflector;

namespace {

constexpr double kReflectorPrior = 1000;  // mm, about the flange's centre

double Square(double x) { return x * x; }

}  // namespace

/// Finds the unknowns of a GeometryFit.
class GeometryFitter {
 public:
  GeometryFitter(GeometryFit& fit, const std::vector<TrackedPose>& poses) : fit_(fit), poses_(poses) {
    size_t sets = 0, reflectors = 0;
    for (const TrackedPose& pose : poses_) {
      sets = std::max(sets, pose.set + 1);
      reflectors = std::max(reflectors, pose.reflectors.size());
    }
    fit_.bases_.assign(sets, Pose::Identity());
    fit_.reflectors_.assign(reflectors, Vector3d::Zero());
    for (size_t i = 0; i < poses_.size(); ++i)
      for (size_t k = 0; k < poses_[i].reflectors.size(); ++k) seen_.push_back({i, k});
    first_reflector_ = kOfBase * static_cast<Eigen::Index>(sets);
    first_coupling_ = first_reflector_ + kOfReflector * static_cast<Eigen::Index>(reflectors);
    first_frame_ = first_coupling_;
    if (fit_.options_.deviations) first_frame_ += static_cast<Eigen::Index>(fit_.options_.couplings.size());
    unknowns_ = first_frame_ + (fit_.options_.deviations ? kCount : 0);
    fit_.readings_ = seen_.size();
    if (3 * static_cast<Eigen::Index>(seen_.size()) <= first_coupling_)
      throw InputError(SourceLocation{},
                       fmt::format("{} readings; needed: more than {}, for where the base stands and the "
                                   "reflectors sit",
                                   seen_.size(), first_coupling_ / 3));
  }

  void Run() {
    Begin();
    // First the nominal arm, then all of it; the level of the residuals says how much the prior weighs.
    level_ = std::max(Settle(first_coupling_), 1e-6);
    if (unknowns_ > first_coupling_)
      for (int round = 0; round < 8; ++round) {
        Settle(unknowns_);
        level_ = std::max(Level(), 1e-9);
      }
    Finish();
  }

 private:
  struct Seen {
    size_t pose, reflector;
  };

  Vector3d Sag(const Seen& seen) const {
    if (!fit_.options_.sag) return Vector3d::Zero();
    return fit_.options_.sag(poses_[seen.pose].q, fit_.reflectors_[seen.reflector]);
  }

  /// Bases and reflectors in turns, each with the other given.
  void Begin() {
    for (int round = 0; round < 60; ++round) {
      for (size_t set = 0; set < fit_.bases_.size(); ++set) {
        std::vector<Vector3d> from, to;
        for (const Seen& seen : seen_) {
          const TrackedPose& pose = poses_[seen.pose];
          if (pose.set != set) continue;
          from.push_back(TrueFlange(fit_.arm_, fit_.deviations_, pose.q) * fit_.reflectors_[seen.reflector]);
          to.push_back(pose.reflectors[seen.reflector]);
        }
        if (from.size() < 3)
          throw InputError(SourceLocation{},
                           fmt::format("set {} has {} readings; needed: at least 3", set + 1, from.size()));
        fit_.bases_[set] = Aligned(from, to);
      }
      // Of a base's place and the reflectors together, its orientation given: linear.
      const auto sets = static_cast<Eigen::Index>(fit_.bases_.size());
      const auto count = static_cast<Eigen::Index>(fit_.reflectors_.size());
      MatrixXd A = MatrixXd::Zero(3 * static_cast<Eigen::Index>(seen_.size()), 3 * (sets + count));
      VectorXd b(A.rows());
      for (size_t i = 0; i < seen_.size(); ++i) {
        const TrackedPose& pose = poses_[seen_[i].pose];
        const Pose X_BF = TrueFlange(fit_.arm_, fit_.deviations_, pose.q);
        const auto row = 3 * static_cast<Eigen::Index>(i);
        const Matrix3d R = fit_.bases_[pose.set].linear();
        A.block<3, 3>(row, 3 * static_cast<Eigen::Index>(pose.set)) = Matrix3d::Identity();
        A.block<3, 3>(row, 3 * (sets + static_cast<Eigen::Index>(seen_[i].reflector))) = R * X_BF.linear();
        b.segment<3>(row) = pose.reflectors[seen_[i].reflector] - R * X_BF.translation();
      }
      // Where the tool hardly turns nothing tells a reflector from the base: then it is at the flange.
      MatrixXd N = A.transpose() * A;
      N.diagonal().tail(3 * count).array() += Square(1 / kReflectorPrior);
      const VectorXd x = SolveSymmetric(N, A.transpose() * b);
      for (Eigen::Index set = 0; set < sets; ++set)
        fit_.bases_[static_cast<size_t>(set)].translation() = x.segment<3>(3 * set);
      for (Eigen::Index k = 0; k < count; ++k)
        fit_.reflectors_[static_cast<size_t>(k)] = x.segment<3>(3 * (sets + k));
    }
  }

  Eigen::Index LookedFor(Eigen::Index unknown) const {
    return kLookedFor[static_cast<size_t>(unknown - first_frame_)];
  }

  /// Standard deviation by what is known beforehand.
  double Prior(Eigen::Index unknown) const {
    if (unknown < first_coupling_) return kReflectorPrior;
    if (unknown < first_frame_) return fit_.options_.coupling_prior;
    const Eigen::Index component = LookedFor(unknown) % kOfFrame;
    return component < 3 ? fit_.options_.shift_prior : fit_.options_.turn_prior;
  }

  double ValueOf(Eigen::Index unknown) const {
    if (unknown < first_coupling_) {
      const Eigen::Index at = unknown - first_reflector_;
      return fit_.reflectors_[static_cast<size_t>(at / kOfReflector)][at % kOfReflector];
    }
    if (unknown < first_frame_) return fit_.Looked(static_cast<size_t>(unknown - first_coupling_)).factor;
    const Eigen::Index at = LookedFor(unknown), component = at % kOfFrame;
    const auto frame = static_cast<size_t>(at / kOfFrame) + 1;
    return component < 3 ? fit_.deviations_.shift[frame][component]
                         : fit_.deviations_.turn[frame][component - 3];
  }

  /// Residuals (mm) and their derivatives by the first `count` unknowns. Bases turn about the middle of what
  /// was seen from them, where turns and shifts have least to do with each other.
  void Linearise(Eigen::Index count, MatrixXd& J, VectorXd& r) {
    fit_.centres_.assign(fit_.bases_.size(), Vector3d::Zero());
    std::vector<double> counts(fit_.bases_.size(), 0);
    for (const Seen& seen : seen_) ++counts[poses_[seen.pose].set];
    for (const Seen& seen : seen_)
      fit_.centres_[poses_[seen.pose].set] += TrueFlange(fit_.arm_, fit_.deviations_, poses_[seen.pose].q) *
                                              fit_.reflectors_[seen.reflector] /
                                              counts[poses_[seen.pose].set];
    J = MatrixXd::Zero(3 * static_cast<Eigen::Index>(seen_.size()), count);
    r.resize(J.rows());
    for (size_t i = 0; i < seen_.size(); ++i) {
      const TrackedPose& pose = poses_[seen_[i].pose];
      const Pose& X_TB = fit_.bases_[pose.set];
      const Matrix3d R = X_TB.linear();
      GeometryFit::Pointed point = fit_.PointAt(pose.q, fit_.reflectors_[seen_[i].reflector]);
      point.place += Sag(seen_[i]);
      const auto row = 3 * static_cast<Eigen::Index>(i);
      r.segment<3>(row) = X_TB * point.place - pose.reflectors[seen_[i].reflector];
      const Eigen::Index base = kOfBase * static_cast<Eigen::Index>(pose.set);
      J.block<3, 3>(row, base) = Matrix3d::Identity();
      J.block<3, 3>(row, base + 3) = -Cross(R * (point.place - fit_.centres_[pose.set]));
      J.block<3, 3>(row, first_reflector_ + kOfReflector * static_cast<Eigen::Index>(seen_[i].reflector)) =
          R * point.by_reflector;
      if (count == first_coupling_) continue;
      J.block(row, first_coupling_, 3, point.by_couplings.cols()) = R * point.by_couplings;
      J.rightCols(kCount).middleRows<3>(row) = R * point.by_frames;
    }
  }

  /// ½ of the sum of squares that is made least, in units of the level.
  double Cost(Eigen::Index count, const VectorXd& r) const {
    double cost = r.squaredNorm() / (level_ * level_);
    for (Eigen::Index k = first_reflector_; k < count; ++k) cost += Square(ValueOf(k) / Prior(k));
    return cost;
  }

  void Step(const VectorXd& x) {
    for (size_t set = 0; set < fit_.bases_.size(); ++set) {
      const auto at = kOfBase * static_cast<Eigen::Index>(set);
      Pose& X = fit_.bases_[set];
      const Vector3d middle = X * fit_.centres_[set] + x.segment<3>(at);
      X.linear() = FromRotationVector(x.segment<3>(at + 3)) * X.linear();
      X.translation() = middle - X.linear() * fit_.centres_[set];
    }
    for (size_t k = 0; k < fit_.reflectors_.size(); ++k)
      fit_.reflectors_[k] += x.segment<3>(first_reflector_ + kOfReflector * static_cast<Eigen::Index>(k));
    for (Eigen::Index k = first_coupling_; k < std::min(first_frame_, x.size()); ++k)
      fit_.Looked(static_cast<size_t>(k - first_coupling_)).factor += x[k];
    for (Eigen::Index k = first_frame_; k < x.size(); ++k) {
      const Eigen::Index at = LookedFor(k), component = at % kOfFrame;
      const auto frame = static_cast<size_t>(at / kOfFrame) + 1;
      (component < 3 ? fit_.deviations_.shift[frame][component]
                     : fit_.deviations_.turn[frame][component - 3]) += x[k];
    }
  }

  /// Normal matrix with the prior, in units of the level.
  MatrixXd Normal(Eigen::Index count, const MatrixXd& J) const {
    MatrixXd N = J.transpose() * J / (level_ * level_);
    for (Eigen::Index k = first_reflector_; k < count; ++k) N(k, k) += 1 / Square(Prior(k));
    return N;
  }

  /// Least squares of the first `count` unknowns; returns the root mean square of a coordinate's residual,
  /// mm.
  double Settle(Eigen::Index count) {
    constexpr int kMost = 100;
    double damping = 1e-6;
    MatrixXd J;
    VectorXd r;
    Linearise(count, J, r);
    double cost = Cost(count, r);
    for (int step = 0; step < kMost; ++step) {
      const MatrixXd N = Normal(count, J);
      VectorXd g = J.transpose() * r / (level_ * level_);
      for (Eigen::Index k = first_reflector_; k < count; ++k) g[k] += ValueOf(k) / Square(Prior(k));
      const VectorXd scale = N.diagonal().cwiseSqrt().cwiseInverse();
      MatrixXd M = scale.asDiagonal() * N * scale.asDiagonal();
      M.diagonal().array() += damping;
      const VectorXd x = -scale.cwiseProduct(SolveSymmetric(M, scale.cwiseProduct(g)));
      const GeometryFit before = fit_;
      Step(x);
      MatrixXd next_J;
      VectorXd next_r;
      Linearise(count, next_J, next_r);
      const double next = Cost(count, next_r);
      if (!(next <= cost * (1 + 1e-14))) {
        fit_ = before;
        damping *= 10;
        if (damping > 1e6) break;
        continue;
      }
      const bool done = cost - next <= 1e-13 * cost;
      J = std::move(next_J), r = std::move(next_r), cost = next;
      damping = std::max(damping / 10, 1e-12);
      if (done) break;
    }
    return std::sqrt(r.squaredNorm() / static_cast<double>(r.size()));
  }

  /// mm, standard deviation of a coordinate by the residuals and the unknowns that they determine.
  double Level() {
    MatrixXd J;
    VectorXd r;
    Linearise(unknowns_, J, r);
    const MatrixXd inverse = InverseOf(Normal(unknowns_, J));
    const double effective = (inverse * (J.transpose() * J / (level_ * level_))).trace();
    return std::sqrt(r.squaredNorm() / std::max(1.0, static_cast<double>(r.size()) - effective));
  }

  static MatrixXd InverseOf(const MatrixXd& N) {
    const VectorXd scale = N.diagonal().cwiseSqrt().cwiseInverse();
    const MatrixXd M = scale.asDiagonal() * N * scale.asDiagonal();
    return scale.asDiagonal() * SolveSymmetricFor(M, MatrixXd::Identity(N.rows(), N.cols())) *
           scale.asDiagonal();
  }

  void Finish() {
    MatrixXd J;
    VectorXd r;
    Linearise(unknowns_, J, r);
    fit_.level_ = level_;
    fit_.covariance_ = InverseOf(Normal(unknowns_, J));
    fit_.effective_ = (fit_.covariance_ * (J.transpose() * J / (level_ * level_))).trace();
    fit_.rms_ = std::sqrt(r.squaredNorm() / static_cast<double>(seen_.size()));
    std::vector<double> squares(fit_.bases_.size(), 0), counts(fit_.bases_.size(), 0);
    for (size_t i = 0; i < seen_.size(); ++i) {
      const size_t set = poses_[seen_[i].pose].set;
      squares[set] += r.segment<3>(3 * static_cast<Eigen::Index>(i)).squaredNorm();
      ++counts[set];
    }
    for (size_t set = 0; set < squares.size(); ++set)
      fit_.rms_of_set_.push_back(std::sqrt(squares[set] / counts[set]));
    LeaveOut(J, r);
    Conditions(J);
  }

  /// Of a pose's readings rᵢ the others leave (1 − Hᵢᵢ)⁻¹ rᵢ, H the hat matrix.
  void LeaveOut(const MatrixXd& J, const VectorXd& r) {
    double square = 0;
    for (size_t i = 0; i < seen_.size();) {
      size_t end = i;
      while (end < seen_.size() && seen_[end].pose == seen_[i].pose) ++end;
      const auto row = 3 * static_cast<Eigen::Index>(i), rows = 3 * static_cast<Eigen::Index>(end - i);
      const MatrixXd own = J.middleRows(row, rows);
      const MatrixXd left =
          MatrixXd::Identity(rows, rows) - own * fit_.covariance_ * own.transpose() / (level_ * level_);
      const double of_pose = SolveSymmetric(left, r.segment(row, rows)).squaredNorm();
      fit_.left_out_squares_.push_back(of_pose / static_cast<double>(end - i));
      square += of_pose;
      i = end;
    }
    fit_.left_out_ = std::sqrt(square / static_cast<double>(seen_.size()));
  }

  void Conditions(const MatrixXd& J) {
    std::vector<Eigen::Index> told;
    for (Eigen::Index k = 0; k < unknowns_; ++k)
      if (k < first_coupling_ || std::sqrt(fit_.covariance_(k, k)) < 0.5 * Prior(k)) told.push_back(k);
    MatrixXd columns(J.rows(), static_cast<Eigen::Index>(told.size()));
    for (size_t k = 0; k < told.size(); ++k)
      columns.col(static_cast<Eigen::Index>(k)) = J.col(told[k]).normalized();
    const VectorXd values = SingularValues(columns);
    fit_.condition_ = values[0] / values[values.size() - 1];
  }

  GeometryFit& fit_;
  const std::vector<TrackedPose>& poses_;
  std::vector<Seen> seen_;
  Eigen::Index first_reflector_ = 0, first_coupling_ = 0, first_frame_ = 0, unknowns_ = 0;
  double level_ = 1;
};

GeometryFit::GeometryFit(const Arm& arm, const std::vector<TrackedPose>& poses,
                         const GeometryFitOptions& options)
    : arm_(arm), options_(options) {
  deviations_.law = options.law;
  for (const JointPair& pair : options.couplings)
    deviations_.law.couplings.push_back({pair.joint, pair.follows, 0});
  GeometryFitter(*this, poses).Run();
}

double GeometryFit::AloneAt(Eigen::Index unknown) const {
  const Eigen::Index first = FirstCoupling(), count = covariance_.cols() - first;
  const MatrixXd information =
      SolveSymmetricFor(covariance_.bottomRightCorner(count, count), MatrixXd::Identity(count, count));
  return 1 / std::sqrt(information(unknown - first, unknown - first));
}

DeviationEstimate GeometryFit::Coupling(size_t number) const {
  const Eigen::Index at = FirstCoupling() + static_cast<Eigen::Index>(number);
  return {Looked(number).factor, std::sqrt(covariance_(at, at)), options_.coupling_prior, AloneAt(at)};
}

DeviationEstimate GeometryFit::Estimate(size_t frame, size_t component) const {
  const double prior = component < 3 ? options_.shift_prior : options_.turn_prior;
  const auto found = std::ranges::find(
      kLookedFor, kOfFrame * static_cast<Eigen::Index>(frame - 1) + static_cast<Eigen::Index>(component));
  if (found == kLookedFor.end()) return {0, prior, prior, prior};
  const Eigen::Index at = covariance_.cols() - kCount + (found - kLookedFor.begin());
  const auto axis = static_cast<Eigen::Index>(component % 3);
  return {component < 3 ? deviations_.shift[frame][axis] : deviations_.turn[frame][axis],
          std::sqrt(covariance_(at, at)), prior, AloneAt(at)};
}

namespace {

/// Of couplings, and of what is looked for in the frames.
ArmDeviations DeviationsFrom(const std::vector<JointPair>& couplings, const VectorXd& values) {
  ArmDeviations deviations;
  const auto first = static_cast<Eigen::Index>(couplings.size());
  for (size_t k = 0; k < couplings.size(); ++k)
    deviations.law.couplings.push_back(
        {couplings[k].joint, couplings[k].follows, values[static_cast<Eigen::Index>(k)]});
  for (Eigen::Index k = 0; k < kCount; ++k) {
    const Eigen::Index number = kLookedFor[static_cast<size_t>(k)], component = number % kOfFrame;
    const auto frame = static_cast<size_t>(number / kOfFrame) + 1;
    (component < 3 ? deviations.shift[frame][component] : deviations.turn[frame][component - 3]) =
        values[first + k];
  }
  return deviations;
}

}  // namespace

std::vector<ArmDeviations> GeometryFit::Patterns() const {
  const Eigen::Index count = kCount + static_cast<Eigen::Index>(options_.couplings.size());
  const MatrixXd root = CholeskyOf(covariance_.bottomRightCorner(count, count));
  std::vector<ArmDeviations> patterns;
  for (Eigen::Index k = 0; k < count; ++k)
    patterns.push_back(DeviationsFrom(options_.couplings, root.col(k)));
  return patterns;
}

}  // namespace millpose
