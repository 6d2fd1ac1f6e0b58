// SPDX-License-Identifier: GPL-3.0-or-later
// Where a part stands, from points that were probed on it (docs/registration.md).
#pragma once

#include <Eigen/Geometry>
#include <stop_token>
#include <string>
#include <vector>

#include "geometry/registration/bending.hpp"
#include "geometry/registration/probed_part.hpp"

namespace millpose {

/// What the fit makes of one point.
struct ProbeResidual {
  double distance = 0;      ///< mm from its feature: of a face signed, above 0 outside; of others the length
  double standardised = 0;  ///< in standard deviations of that residual
  double weight = 1;        ///< Huber's; 0: left out
  bool outlier = false;
  bool no_feature = false;  ///< the part has nothing that it could lie on
};

/// A part's place with its uncertainty. The true pose is X·T, where T shifts by t (mm) and turns by the small
/// vector w (rad) about `centre`: a point p of the part moves by t + w × (p − centre). Of a bent part the
/// modes' coefficients a (mm) are unsure as well.
struct Registration {
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();  ///< of P in F
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();     ///< in P, mm
  ProbeMatrix covariance = ProbeMatrix::Zero(6, 6);     ///< of (t, w, a): mm², mm·rad, rad²
  std::optional<PartBending> bending = {};              ///< where the part is taken as bent
  std::vector<ProbeResidual> residuals;                 ///< one a point
  int used = 0;                                         ///< equations that count
  double scatter = 1;          ///< what the points scatter by ÷ what their standard deviations say
  bool scatters_more = false;  ///< than chance explains (95 %)
  /// Ways in which the part can move without any point noticing, in words; the pose keeps what it was given
  /// there and the covariance does not hold.
  std::vector<std::string> undetermined;
  bool converged = false;

  bool determined() const { return undetermined.empty() && converged; }
  const PartBending* Bending() const { return bending ? &*bending : nullptr; }
  /// Standard deviation of the bending's height d at a point p of the part, mm.
  double HeightDeviation(const Eigen::Vector3d& p) const;
};

/// The pose that brings the probed points onto their features, from `start` on: Gauss and Newton's steps on
/// the distances d·(X⁻¹m − q) with the nearest features q of each step (Li, Gou and Chu 1998), Huber's
/// weights at 1.345 standard deviations, and points farther off than four deviations of their residual left
/// out. Covariance: κ·(AᵀA)⁻¹ with the stated deviations, where κ is Huber's (1981, 7.6), at least the 1/0.95
/// that his weights cost; so points that scatter more than stated count for less, never for more.
/// The same for any number of `threads`. Throws Interrupted.
Registration Register(const ProbedPart& part, const std::vector<ProbedPoint>& points,
                      const Eigen::Isometry3d& start, int threads = 1, std::stop_token stop = {});

/// A part taken as bent, since its points ask for it.
struct BentRegistration {
  Registration found;     ///< with its modes
  double p = 1;           ///< probability that a rigid part's points ask for so much by chance, at most
  double largest = 0;     ///< mm: by how much the part is bent, at its farthest
  double largest_95 = 0;  ///< mm: 95 % interval of that, to either side
  double slope = 0;       ///< steepest
};

/// Whether the points ask for bending, of which `rigid` is the fit without. The sets are the first three,
/// four, five and six modes. From a fit with the largest set that the points determine, F tests of nested
/// models on its points without outliers (least squares, stated weights): the smallest set that improves on
/// the rigid part at 1 %, over all sets tried (Bonferroni); and from there likewise the smallest larger one
/// that improves on it, until none does. A set is determined where there are three equations for each
/// unknown, no direction is open, and at no corner of the part its height's standard deviation is above two
/// of the least sure point's. None where no set is asked for or determined. The same for any number of
/// `threads`. Throws Interrupted.
std::optional<BentRegistration> RegisterBent(const ProbedPart& part, const std::vector<ProbedPoint>& points,
                                             const Registration& rigid, int threads = 1,
                                             const std::stop_token& stop = {});

/// How the distance of a point p from its feature follows pose and modes: −a·(t, w, a), a = (d, (p − centre)
/// × d, d·what each mode does to p).
ProbeVector ProbeRow(const Eigen::Vector3d& d, const Eigen::Vector3d& p, const Eigen::Vector3d& centre,
                     const PartBending* bending = nullptr);

}  // namespace millpose
