// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine/identification/identify_system.hpp"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>

namespace millpose::identify {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double kNoLoad = 1e-8;     // of the largest column: what rounding leaves of a joint without torque
constexpr double kDependent = 1e-6;  // part of a unit column that the others cannot make

/// Columns `keep` of L, each scaled to unit length.
MatrixXd Scaled(const MatrixXd& L, const std::vector<Eigen::Index>& keep) {
  MatrixXd columns(L.rows(), static_cast<Eigen::Index>(keep.size()));
  for (size_t k = 0; k < keep.size(); ++k)
    columns.col(static_cast<Eigen::Index>(k)) = L.col(keep[k]).normalized();
  return columns;
}

/// By what a wrench of one newton (newton millimetre) along or about the axis of `give` moves and turns a
/// point, both in F; the same, turned round, is the wrench there that a force and a moment make.
struct Lever {
  Vector3d moves, turns;
};
Lever LeverOf(const std::array<Pose, 7>& frames, const Give& give, const Vector3d& point) {
  const Pose& frame = frames[static_cast<size_t>(give.link)];
  const Vector3d axis = frame.linear().col(give.axis);
  if (give.translates) return {axis, Vector3d::Zero()};
  return {axis.cross(frames[6] * point - frame.translation()), axis};
}

/// Minimum of ½cᵀNc − gᵀc over the unknowns in `keep`, the others 0.
Solution SolveSubset(const MatrixXd& N, const VectorXd& g, const std::vector<char>& keep) {
  std::vector<Eigen::Index> at;
  for (Eigen::Index j = 0; j < N.cols(); ++j)
    if (keep[static_cast<size_t>(j)]) at.push_back(j);
  Solution solution{VectorXd::Zero(N.cols()), MatrixXd::Zero(N.cols(), N.cols()),
                    std::vector<char>(keep.size(), 0)};
  if (at.empty()) return solution;
  const VectorXd scale = N.diagonal()(at).cwiseSqrt().cwiseInverse();
  const MatrixXd M = scale.asDiagonal() * MatrixXd(N(at, at)) * scale.asDiagonal();
  const MatrixXd inverse = M.llt().solve(MatrixXd::Identity(M.rows(), M.cols()));
  const VectorXd c = inverse * scale.cwiseProduct(VectorXd(g(at)));
  solution.c(at) = scale.cwiseProduct(c);
  solution.inverse(at, at) = scale.asDiagonal() * inverse * scale.asDiagonal();
  for (const Eigen::Index j : at) solution.active[static_cast<size_t>(j)] = 1;
  return solution;
}

/// The exact minimum with c ≥ 0 (Lawson and Hanson 1974, chapter 23): unknowns join where that lowers it, and
/// leave where they would be negative.
Solution SolveNonNegative(const MatrixXd& N, const VectorXd& g, const std::vector<char>& free) {
  const auto positive = [](const Solution& s) {
    for (size_t j = 0; j < s.active.size(); ++j)
      if (s.active[j] && s.c[static_cast<Eigen::Index>(j)] <= 0) return false;
    return true;
  };
  Solution best = SolveSubset(N, g, free);
  if (positive(best)) return best;
  constexpr double kFlat = 1e-10;  // of a scaled gradient
  std::vector<char> passive(free.size(), 0);
  best = SolveSubset(N, g, passive);
  const VectorXd scale = N.diagonal().cwiseMax(std::numeric_limits<double>::min()).cwiseSqrt().cwiseInverse();
  const double size = scale.cwiseProduct(g).cwiseAbs().maxCoeff();
  for (size_t round = 0; round < 10 * free.size(); ++round) {
    const VectorXd gradient = scale.cwiseProduct(g - N * best.c);
    Eigen::Index join = -1;
    for (Eigen::Index j = 0; j < gradient.size(); ++j) {
      const auto at = static_cast<size_t>(j);
      if (free[at] && !passive[at] && gradient[j] > kFlat * size &&
          (join < 0 || gradient[j] > gradient[join]))
        join = j;
    }
    if (join < 0) break;
    passive[static_cast<size_t>(join)] = 1;
    for (;;) {
      const Solution tried = SolveSubset(N, g, passive);
      if (positive(tried)) {
        best = tried;
        break;
      }
      // As far towards it as all stay above 0.
      double share = 1;
      for (Eigen::Index j = 0; j < tried.c.size(); ++j)
        if (passive[static_cast<size_t>(j)] && tried.c[j] <= 0)
          share = std::min(share, best.c[j] / (best.c[j] - tried.c[j]));
      best.c += share * (tried.c - best.c);
      constexpr double kGone = 1e-12;  // of what it came from, by rounding
      for (Eigen::Index j = 0; j < tried.c.size(); ++j) {
        if (!passive[static_cast<size_t>(j)] || tried.c[j] > 0 || best.c[j] > kGone * std::abs(tried.c[j]))
          continue;
        passive[static_cast<size_t>(j)] = 0;
        best.c[j] = 0;
      }
    }
  }
  return best;
}

double Median(VectorXd values) {
  std::sort(values.begin(), values.end());
  const Eigen::Index n = values.size();
  return 0.5 * (values[(n - 1) / 2] + values[n / 2]);
}

}  // namespace

System MakeSystem(const Arm& arm, const std::vector<LoadCase>& cases, const IdentifyOptions& options) {
  Eigen::Index rows = 0;
  for (const LoadCase& load : cases) rows += load.rotation ? 6 : 3;
  System system;
  system.L.resize(rows, 6 + static_cast<Eigen::Index>(options.beside.size()));
  system.x.resize(rows);
  Eigen::Index row = 0;
  for (size_t i = 0; i < cases.size(); ++i) {
    const LoadCase& load = cases[i];
    const Matrix6 at_load = Jacobian(arm, load.q, load.load_point);
    const Matrix6 measured = Jacobian(arm, load.q, load.measured_point);
    const Joints torques =
        at_load.topRows<3>().transpose() * load.force + at_load.bottomRows<3>().transpose() * load.moment;
    system.L.block<3, 6>(row, 0) =
        measured.topRows<3>() * torques.asDiagonal() / options.displacement_deviation;
    system.x.segment<3>(row) = load.displacement / options.displacement_deviation;
    if (load.rotation) {
      system.L.block<3, 6>(row + 3, 0) =
          measured.bottomRows<3>() * torques.asDiagonal() / options.rotation_deviation;
      system.x.segment<3>(row + 3) = *load.rotation / options.rotation_deviation;
    }
    const std::array<Pose, 7> frames = LinkFrames(arm, load.q);
    for (size_t k = 0; k < options.beside.size(); ++k) {
      const auto column = static_cast<Eigen::Index>(6 + k);
      const Lever at = LeverOf(frames, options.beside[k], load.load_point),
                  there = LeverOf(frames, options.beside[k], load.measured_point);
      const double wrench = at.moves.dot(load.force) + at.turns.dot(load.moment);
      system.L.block<3, 1>(row, column) = wrench * there.moves / options.displacement_deviation;
      if (load.rotation)
        system.L.block<3, 1>(row + 3, column) = wrench * there.turns / options.rotation_deviation;
    }
    const int added = load.rotation ? 6 : 3;
    system.case_of_row.insert(system.case_of_row.end(), added, i);
    row += added;
  }
  return system;
}

System Without(const System& system, const std::vector<size_t>& pose_of_case, size_t pose) {
  std::vector<Eigen::Index> keep;
  System rest;
  for (size_t i = 0; i < system.case_of_row.size(); ++i) {
    if (pose_of_case[system.case_of_row[i]] == pose) continue;
    keep.push_back(static_cast<Eigen::Index>(i));
    rest.case_of_row.push_back(system.case_of_row[i]);
  }
  rest.L = system.L(keep, Eigen::all);
  rest.x = system.x(keep);
  return rest;
}

std::vector<std::string> Observability(const MatrixXd& L) {
  std::vector<std::string> reasons(static_cast<size_t>(L.cols()));
  const VectorXd lengths = L.colwise().norm();
  std::vector<Eigen::Index> loaded;
  for (Eigen::Index j = 0; j < L.cols(); ++j) {
    if (lengths[j] > kNoLoad * lengths.maxCoeff())
      loaded.push_back(j);
    else
      reasons[static_cast<size_t>(j)] =
          "not observable: no load case puts a torque on it that moves the measured point";
  }
  for (const Eigen::Index j : loaded) {
    std::vector<Eigen::Index> others;
    for (const Eigen::Index other : loaded)
      if (other != j) others.push_back(other);
    if (others.empty()) continue;
    const MatrixXd columns = Scaled(L, others);
    const VectorXd column = L.col(j).normalized();
    const Eigen::ColPivHouseholderQR<MatrixXd> qr(columns);
    if (L.rows() < static_cast<Eigen::Index>(loaded.size()) ||
        (columns * qr.solve(column) - column).norm() < kDependent)
      reasons[static_cast<size_t>(j)] = "not observable: its effect is a combination of other joints'";
  }
  return reasons;
}

double Condition(const MatrixXd& L, const std::vector<std::string>& unobservable) {
  std::vector<Eigen::Index> keep;
  for (Eigen::Index j = 0; j < L.cols(); ++j)
    if (unobservable[static_cast<size_t>(j)].empty()) keep.push_back(j);
  if (keep.size() < 2) return 1;
  const Eigen::JacobiSVD<MatrixXd> svd(Scaled(L, keep));
  return svd.singularValues()[0] / svd.singularValues()[svd.singularValues().size() - 1];
}

Solution Solve(const System& system, const std::vector<char>& free, bool robust, VectorXd& weights) {
  weights = VectorXd::Ones(system.x.size());
  Solution solution;
  constexpr int kIterations = 50;
  constexpr double kHuber = 1.345;
  for (int iteration = 0; iteration < (robust ? kIterations : 1); ++iteration) {
    const MatrixXd N = system.L.transpose() * weights.asDiagonal() * system.L;
    const VectorXd g = system.L.transpose() * weights.cwiseProduct(system.x);
    solution = SolveNonNegative(N, g, free);
    if (!robust) break;
    const VectorXd size = (system.L * solution.c - system.x).cwiseAbs();
    const double scale = 1.4826 * Median(size);
    for (Eigen::Index i = 0; i < size.size(); ++i)
      weights[i] = size[i] <= kHuber * scale ? 1.0 : kHuber * scale / size[i];
  }
  return solution;
}

std::vector<size_t> PosesOf(const std::vector<LoadCase>& cases) {
  std::vector<size_t> poses;
  for (size_t i = 0; i < cases.size(); ++i)
    poses.push_back(i == 0 ? 0 : poses.back() + (cases[i].q != cases[i - 1].q));
  return poses;
}

}  // namespace millpose::identify
