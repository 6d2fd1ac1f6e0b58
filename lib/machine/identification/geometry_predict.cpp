// SPDX-License-Identifier: GPL-3.0-or-later
// What a GeometryFit foretells.
#include <utility>

#include "base/decompositions.hpp"
#include "base/error.hpp"
#include "machine/identification/geometry_point.hpp"

namespace millpose {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using geometry_fit::Aligned;
using geometry_fit::Cross;
using geometry_fit::kCount;
using geometry_fit::kFrames;
using geometry_fit::kLookedFor;
using geometry_fit::kOfBase;
using geometry_fit::kOfFrame;
using geometry_fit::kOfReflector;

/// The rigid motion that takes `from` to `to` with the least squares (Arun, Huang, Blostein 1987).
Pose geometry_fit::Aligned(const std::vector<Vector3d>& from, const std::vector<Vector3d>& to) {
  Vector3d a = Vector3d::Zero(), b = Vector3d::Zero();
  for (size_t i = 0; i < from.size(); ++i) a += from[i], b += to[i];
  a /= static_cast<double>(from.size());
  b /= static_cast<double>(from.size());
  Matrix3d H = Matrix3d::Zero();
  for (size_t i = 0; i < from.size(); ++i) H += (from[i] - a) * (to[i] - b).transpose();
  const SingularTriples3 svd = SingularOf3(H);
  Matrix3d flip = Matrix3d::Identity();
  flip(2, 2) = (svd.V * svd.U.transpose()).determinant() < 0 ? -1 : 1;
  Pose X = Pose::Identity();
  X.linear() = svd.V * flip * svd.U.transpose();
  X.translation() = b - X.linear() * a;
  return X;
}

const JointCoupling& GeometryFit::Looked(size_t number) const {
  const std::vector<JointCoupling>& all = deviations_.law.couplings;
  return all[all.size() - options_.couplings.size() + number];
}

JointCoupling& GeometryFit::Looked(size_t number) {
  return const_cast<JointCoupling&>(std::as_const(*this).Looked(number));
}

GeometryFit::Pointed GeometryFit::PointAt(const Joints& q, const Vector3d& p_F) const {
  constexpr Eigen::Index kOwn[] = {2, 1, 1, 0, 1, 2};  // the joint's axis, of the frame that it turns
  const LinkPoses frames = TrueLinkFrames(arm_, deviations_, q);
  const Pose X_BF = frames[6] * DeviationOf(deviations_, 6);
  Pointed point{X_BF * p_F, X_BF.linear(), {}, {}};
  point.by_couplings.resize(3, static_cast<Eigen::Index>(options_.couplings.size()));
  for (size_t k = 0; k < options_.couplings.size(); ++k) {
    const auto joint = static_cast<size_t>(options_.couplings[k].joint);
    const Pose& frame = frames[joint];
    const Vector3d axis = arm_.sign[joint - 1] * frame.linear().col(kOwn[joint - 1]);
    point.by_couplings.col(static_cast<Eigen::Index>(k)) =
        q[options_.couplings[k].follows - 1] * axis.cross(point.place - frame.translation());
  }
  Eigen::Matrix<double, 3, kOfFrame * kFrames> all;
  for (Eigen::Index k = 0; k < kFrames; ++k) {
    const Pose& frame = frames[static_cast<size_t>(k) + 1];
    // A shift is one in the frame's axes; a turn, about the frame's place where its deviation has moved that.
    const Vector3d arm_of = point.place - frame * deviations_.shift[static_cast<size_t>(k) + 1];
    all.block<3, 3>(0, kOfFrame * k) = frame.linear();
    all.block<3, 3>(0, kOfFrame * k + 3) = -Cross(arm_of) * frame.linear();
  }
  for (Eigen::Index k = 0; k < kCount; ++k)
    point.by_frames.col(k) = all.col(kLookedFor[static_cast<size_t>(k)]);
  return point;
}

Eigen::Index GeometryFit::FirstCoupling() const {
  return kOfBase * static_cast<Eigen::Index>(bases_.size()) +
         kOfReflector * static_cast<Eigen::Index>(reflectors_.size());
}

MatrixXd GeometryFit::RowsOf(const Pointed& point, size_t reflector) const {
  MatrixXd J = MatrixXd::Zero(3, covariance_.cols());
  const Eigen::Index first = kOfBase * static_cast<Eigen::Index>(bases_.size());
  J.middleCols<3>(first + kOfReflector * static_cast<Eigen::Index>(reflector)) = point.by_reflector;
  if (!options_.deviations) return J;
  J.middleCols(FirstCoupling(), point.by_couplings.cols()) = point.by_couplings;
  J.rightCols(kCount) = point.by_frames;
  return J;
}

GeometryFit::Foretold GeometryFit::Predict(const Joints& q, size_t reflector) const {
  Pointed point = PointAt(q, reflectors_[reflector]);
  if (options_.sag) point.place += options_.sag(q, reflectors_[reflector]);
  const MatrixXd J = RowsOf(point, reflector);
  return {point.place, J * covariance_ * J.transpose()};
}

MatrixXd GeometryFit::Rows(const Joints& q) const {
  MatrixXd J = MatrixXd::Zero(3 * static_cast<Eigen::Index>(reflectors_.size()), covariance_.cols());
  const Matrix3d R = bases_[0].linear();
  for (size_t k = 0; k < reflectors_.size(); ++k) {
    const Pointed point = PointAt(q, reflectors_[k]);
    const auto row = 3 * static_cast<Eigen::Index>(k);
    J.middleRows<3>(row) = R * RowsOf(point, k);
    J.block<3, 3>(row, 0) = Matrix3d::Identity();
    J.block<3, 3>(row, 3) = -Cross(R * (point.place - centres_[0]));
  }
  return J;
}

std::vector<GeometryFit::Foretold> GeometryFit::PredictSet(const std::vector<TrackedPose>& poses) const {
  const auto rows = 3 * static_cast<Eigen::Index>(poses.size() * reflectors_.size());
  std::vector<Foretold> foretold;
  Vector3d centre = Vector3d::Zero();
  MatrixXd J = MatrixXd::Zero(rows, covariance_.cols()), base(rows, kOfBase);
  for (const TrackedPose& pose : poses)
    for (size_t k = 0; k < reflectors_.size(); ++k) {
      Pointed point = PointAt(pose.q, reflectors_[k]);
      if (options_.sag) point.place += options_.sag(pose.q, reflectors_[k]);
      J.middleRows<3>(3 * static_cast<Eigen::Index>(foretold.size())) = RowsOf(point, k);
      foretold.push_back({point.place, Matrix3d::Zero()});
      centre += 3 * point.place / static_cast<double>(rows);
    }
  for (size_t i = 0; i < foretold.size(); ++i)
    base.middleRows<3>(3 * static_cast<Eigen::Index>(i)) << Matrix3d::Identity(),
        -Cross(foretold[i].position - centre);
  // What a base that is fitted to the readings takes up is no error of theirs.
  J -= base * SolveSymmetricFor(base.transpose() * base, base.transpose() * J);
  for (size_t i = 0; i < foretold.size(); ++i) {
    const auto own = J.middleRows<3>(3 * static_cast<Eigen::Index>(i));
    foretold[i].covariance = own * covariance_ * own.transpose();
  }
  return foretold;
}

double GeometryFit::Gain(const Joints& q) const {
  const MatrixXd J = Rows(q);
  const MatrixXd L = CholeskyOf(MatrixXd::Identity(J.rows(), J.rows()) +
                                J * covariance_ * J.transpose() / (level_ * level_));
  const double product = L.diagonal().prod();
  return product * product;
}

void GeometryFit::Add(const Joints& q) {
  const MatrixXd J = Rows(q), gain = covariance_ * J.transpose();
  const MatrixXd S = level_ * level_ * MatrixXd::Identity(J.rows(), J.rows()) + J * gain;
  covariance_ -= gain * SolvePositive(S, gain.transpose());
}

Pose FitBase(const GeometryFit& fit, const std::vector<TrackedPose>& poses) {
  std::vector<Vector3d> from, to;
  for (const TrackedPose& pose : poses)
    for (size_t k = 0; k < pose.reflectors.size(); ++k) {
      from.push_back(fit.Predict(pose.q, k).position);
      to.push_back(pose.reflectors[k]);
    }
  if (from.size() < 3)
    throw InputError(SourceLocation{},
                     fmt::format("{} readings; needed for a base: at least 3", from.size()));
  return Aligned(from, to);
}

}  // namespace millpose
