// SPDX-License-Identifier: GPL-3.0-or-later
// An arm's own geometry from where a tracker saw its reflectors (docs/geometry-identification.md).
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "machine/robot/deviations.hpp"

namespace millpose {

/// The reflectors on the flange in one pose, in the tracker's frame, mm.
struct TrackedPose {
  Joints q = Joints::Zero();                ///< as the controller has it, rad
  std::vector<Eigen::Vector3d> reflectors;  ///< as many in each pose
  size_t set = 0;                           ///< poses of one set were seen without moving the tracker
};

/// Joint `joint` (1 to 6) turns beside its own angle by a share of that of `follows`.
struct JointPair {
  int joint = 0, follows = 0;

  bool operator==(const JointPair&) const = default;
};

struct GeometryFitOptions {
  double shift_prior = 1;    ///< mm, standard deviation of each shift by the maker's sheet
  double turn_prior = 3e-3;  ///< rad, of each turn
  bool deviations = true;    ///< false: the nominal arm, its base and the reflectors alone
  JointLaw law = {};         ///< of the joints, as far as it is known
  /// Whose factors are looked for beside the deviations; none that `law` has.
  std::vector<JointPair> couplings = {};
  double coupling_prior = 2e-3;  ///< of each factor
  /// By how much the arm's weight moves a point of the flange (in F, mm) in a pose, in B, mm; empty: it does
  /// not.
  std::function<Eigen::Vector3d(const Joints& q, const Eigen::Vector3d& p_F)> sag = {};
};

/// A number of the deviations and how sure it is.
struct DeviationEstimate {
  double value = 0;      ///< mm or rad
  double deviation = 0;  ///< standard deviation, by readings and prior together
  double prior = 0;      ///< by the prior alone
  /// Standard deviation if all the others were known: what they sum up to is as sure as that, so the value
  /// has digits down there.
  double alone = 0;
  /// The readings say more of it than the prior. Of two that no reading tells apart only the sum is told, and
  /// neither of them.
  bool told() const { return deviation < 0.5 * prior; }
};

/// Unknowns: the robot's base in the tracker's frame for each set, each reflector in the flange, the
/// couplings' factors, and shift and turn of frames 1 to 5. Frame 0 is the base and frame 6 carries the
/// reflectors: nothing tells their deviations from those.
class GeometryFit {
 public:
  /// Least squares of the readings together with the prior (Gauss and Newton's, damped), at the level of the
  /// residuals. Starts from the nominal arm. Throws InputError with fewer readings than base and reflectors
  /// need, and where no start comes near.
  GeometryFit(const Arm& arm, const std::vector<TrackedPose>& poses, const GeometryFitOptions& options);

  /// Their law is the one that is known, followed by the couplings that were looked for.
  const ArmDeviations& deviations() const { return deviations_; }
  const std::vector<JointPair>& couplings() const { return options_.couplings; }
  /// Of couplings().
  DeviationEstimate Coupling(size_t number) const;
  /// Of frame 1 to 5, components shift x, y, z, turn x, y, z.
  DeviationEstimate Estimate(size_t frame, size_t component) const;
  const std::vector<Pose>& bases() const { return bases_; }  ///< X of each set's base in the tracker's frame
  const std::vector<Eigen::Vector3d>& reflectors() const { return reflectors_; }  ///< in F, mm
  /// mm, root mean square of a reading's distance from where the fit has it; of one set; of readings that the
  /// others foretell (leave one pose out, by the linear fit).
  double rms() const { return rms_; }
  double RmsOf(size_t set) const { return rms_of_set_[set]; }
  double left_out() const { return left_out_; }
  /// mm², mean over the reflectors, of each pose as the others foretell it.
  const std::vector<double>& left_out_squares() const { return left_out_squares_; }
  double level() const { return level_; }  ///< mm, standard deviation of one coordinate
  size_t readings() const { return readings_; }
  /// Unknowns that the readings, not the prior, determine.
  double effective() const { return effective_; }
  /// Ratio of the largest to the smallest singular value of the readings' columns for the unknowns that are
  /// told, each scaled to unit length.
  double condition() const { return condition_; }

  /// Where a reflector is foretold in the base's frame, and the standard deviations of the error along three
  /// axes, of the geometry alone (a reading adds level()).
  struct Foretold {
    Eigen::Vector3d position;
    Eigen::Matrix3d covariance;  ///< mm²
  };
  Foretold Predict(const Joints& q, size_t reflector) const;
  /// All readings of a set in their order, with the base fitted to them (FitBase): what it takes up is not in
  /// the covariances.
  std::vector<Foretold> PredictSet(const std::vector<TrackedPose>& poses) const;

  /// In which ways frames and couplings may still be off together: independent ones, each as far as its
  /// standard deviation, whose squares sum up to the covariance. Shifts, turns and factors beside
  /// deviations(). None is left out for being small: on a face that the arm reaches in one posture, what is
  /// large elsewhere is taken up by the part's frame.
  std::vector<ArmDeviations> Patterns() const;

  /// By how much the readings of a pose, with the tracker where the first set has it, would lessen what is
  /// not known: the determinant of the covariance before ÷ after (D-optimal).
  double Gain(const Joints& q) const;
  /// As if that had been read.
  void Add(const Joints& q);

 private:
  friend class GeometryFitter;

  struct Pointed;
  Pointed PointAt(const Joints& q, const Eigen::Vector3d& p_F) const;
  Eigen::Index FirstCoupling() const;
  /// The law's coupling that is looked for.
  JointCoupling& Looked(size_t number);
  const JointCoupling& Looked(size_t number) const;
  /// Derivatives of where a reflector stands in B by all unknowns but the bases.
  Eigen::MatrixXd RowsOf(const Pointed& point, size_t reflector) const;
  /// Of a coupling or a deviation if all the others were known.
  double AloneAt(Eigen::Index unknown) const;
  /// Derivatives of a pose's readings by all unknowns.
  Eigen::MatrixXd Rows(const Joints& q) const;

  Arm arm_;
  GeometryFitOptions options_;
  ArmDeviations deviations_;
  std::vector<Pose> bases_;
  std::vector<Eigen::Vector3d> centres_;  ///< of each set's readings in B, about which its base turns
  std::vector<Eigen::Vector3d> reflectors_;
  Eigen::MatrixXd covariance_;  ///< of all unknowns
  double rms_ = 0, left_out_ = 0, level_ = 0, effective_ = 0, condition_ = 1;
  std::vector<double> rms_of_set_, left_out_squares_;
  size_t readings_ = 0;
};

/// The base that fits a set best with the arm and the reflectors as `fit` has them: for readings that were
/// not fitted. At least three.
Pose FitBase(const GeometryFit& fit, const std::vector<TrackedPose>& poses);

}  // namespace millpose
