// SPDX-License-Identifier: GPL-3.0-or-later
// Chen 2021 section 5.2 as printed: six joint angles as variables, the pose held by a penalty. Kept to
// compare (formulation: paper); the planner's own genetic algorithm (search.hpp) works in the freedoms and
// holds the pose exactly.
#pragma once

#include "base/random.hpp"
#include "planning/pose/search.hpp"

namespace millpose {

/// The paper gives neither population, weights, c_max nor penalty factor: these are this project's.
struct PaperFormulationOptions {
  int population = 200;
  int generations = 1500;
  int elite = 10;
  double crossover_rate = 0.3;
  double position_tolerance = 0.1;                      ///< e of eq. 26, mm
  double angle_tolerance = 0.1 * 0.017453292519943295;  ///< ε of eq. 26, rad
  double w1 = 0.5, w2 = 0.5;                            ///< eq. 23
  double c_max = 1e-3;                                  ///< eq. 29, mm/N
  double penalty = 1e-5;                                ///< eq. 33, mm/N per squared tolerance
};

/// What is to be reached, in B: tip (mm), direction of the tool axis and normal of the milling plane (unit).
/// The bounds of eq. 24 are the problem's.
struct PaperTarget {
  Eigen::Vector3d tip, axis, normal;
};
PaperTarget MakePaperTarget(const PoseProblem& problem, const MillingPoint& point);

struct PaperResult {
  Joints q;
  double objective = 0;       ///< f of eq. 23 at q, mm/N; +inf in a singular pose
  double position_error = 0;  ///< mm
  double angle_error = 0;     ///< of the tool axis, rad
  bool within_tolerance = false;
  double fitness = 0;  ///< G of eq. 32
  int evaluations = 0;
};

/// θ = mid + (range/π)·atan ψ and its inverse (eq. 30, 31 with the sign of θ3 corrected: the paper's own maps
/// to −120°…−38° where its Table 5 says 38°…120°).
double FromUnbounded(double psi, double lower, double upper);
double ToUnbounded(double theta, double lower, double upper);

/// Genetic algorithm on ψ ∈ R⁶ with G = max(0, c_max − f) − penalty·‖E‖² (eq. 29, 32-35), E in units of the
/// tolerances: roulette by rank, scattered crossover, Gaussian mutation that shrinks, elitism.
PaperResult PaperSearch(const PoseProblem& problem, const PaperTarget& target,
                        const PaperFormulationOptions& options, RandomStream stream);

/// The answer as the planner may use it: on the exact pose, with the rotation about the tool axis and the
/// branch of the angles found. Not found when the answer misses the tolerances or that exact pose is not
/// admissible: what misses is never milled. The problem has the rotation as its only freedom.
PointOptimum OnExactPose(const PointScorer& scorer, const PaperResult& result);

}  // namespace millpose
