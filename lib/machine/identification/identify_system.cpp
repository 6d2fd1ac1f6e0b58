// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine/identification/identify_system.hpp"

#include <algorithm>
#include <utility>

#include "base/decompositions.hpp"

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
Lever LeverOf(const LinkPoses& frames, const Give& give, const Vector3d& point) {
  const Pose& frame = frames[static_cast<size_t>(give.link)];
  const Vector3d axis = frame.linear().col(give.axis);
  if (give.kind == Give::Kind::kMoves) return {axis, Vector3d::Zero()};
  return {axis.cross(frames[6] * point - frame.translation()), axis};
}

double Sign(double value) { return value > 0 ? 1 : value < 0 ? -1 : 0; }

Joints TorquesOf(const Arm& arm, const LoadCase& load) {
  const Matrix6 J = Jacobian(arm, load.q, load.load_point);
  return J.topRows<3>().transpose() * load.force + J.bottomRows<3>().transpose() * load.moment;
}

/// Whether all unknowns found are, but for a payload.
bool Positive(const Solution& s, bool payload) {
  for (size_t j = 0; j + (payload ? 1 : 0) < s.active.size(); ++j)
    if (s.active[j] && !(s.c[static_cast<Eigen::Index>(j)] > 0)) return false;
  return true;
}

/// How far a way from `from` to `to` all unknowns in `passive` stay above 0; those that end there leave.
void GoTowards(const VectorXd& to, size_t signed_from, std::vector<char>& passive, VectorXd& from) {
  double share = 1;
  for (size_t j = 0; j < signed_from; ++j) {
    const auto at = static_cast<Eigen::Index>(j);
    if (passive[j] && to[at] <= 0) share = std::min(share, from[at] / (from[at] - to[at]));
  }
  from += share * (to - from);
  constexpr double kGone = 1e-12;  // of what it came from, by rounding
  for (size_t j = 0; j < signed_from; ++j) {
    const auto at = static_cast<Eigen::Index>(j);
    if (!passive[j] || to[at] > 0 || from[at] > kGone * std::abs(to[at])) continue;
    passive[j] = 0;
    from[at] = 0;
  }
}

double Median(VectorXd values) {
  std::sort(values.begin(), values.end());
  const Eigen::Index n = values.size();
  return 0.5 * (values[(n - 1) / 2] + values[n / 2]);
}

/// Least squares with Huber's weights where `robust`, else with 1.
void SolveWeighted(const System& system, const std::vector<char>& free, bool robust, Fitted& fit) {
  constexpr int kIterations = 50;
  constexpr double kHuber = 1.345;
  const auto n = system.L.cols();
  fit.weights = VectorXd::Ones(system.x.size());
  for (int iteration = 0; iteration < (robust ? kIterations : 1); ++iteration) {
    const MatrixXd N = system.L.transpose() * fit.weights.asDiagonal() * system.L;
    const VectorXd g = system.L.transpose() * fit.weights.cwiseProduct(system.x);
    const Solution nothing{VectorXd::Zero(n), MatrixXd::Zero(n, n), std::vector<char>(free.size(), 0)};
    fit.solution = SolveSubset(N, g, free);
    if (!Positive(fit.solution, system.payload))
      fit.solution = SolveNonNegative(N, g, free, system.payload, nothing);
    if (!robust) break;
    const VectorXd size = (system.L * fit.solution.c - system.x).cwiseAbs();
    const double scale = 1.4826 * Median(size);
    for (Eigen::Index i = 0; i < size.size(); ++i)
      fit.weights[i] = size[i] <= kHuber * scale ? 1.0 : kHuber * scale / size[i];
  }
}

void FitLinear(System system, bool robust, Fitted& fit) {
  fit.system = std::move(system);
  MatrixXd columns = fit.system.L;
  if (fit.system.payload) {  // per N, where compliances' columns are per rad/(N·mm): of their size
    const double own = columns.rightCols(1).norm(), largest = columns.colwise().norm().maxCoeff();
    if (own > 0) columns.rightCols(1) *= largest / own;
  }
  fit.reasons = Observability(columns);
  fit.free.clear();
  for (const std::string& reason : fit.reasons) fit.free.push_back(reason.empty());
  if (fit.freedom() >= 1) SolveWeighted(fit.system, fit.free, robust, fit);
}

/// What the unknowns are near compliances c and a payload: x = (stated + payload·weight)·c is linear there.
System Near(const System& stated, const System& weight, const VectorXd& c, double payload) {
  System system = stated;
  const VectorXd of_weight = weight.L * c;
  system.L.resize(stated.L.rows(), stated.L.cols() + 1);
  system.L << stated.L + payload * weight.L, of_weight;
  system.x += payload * of_weight;
  system.payload = true;
  return system;
}

}  // namespace

System MakeSystem(const Arm& arm, const std::vector<LoadCase>& cases, const IdentifyOptions& options) {
  constexpr double kNoTorque = 1e-6;  // of the joint's largest: no side
  Eigen::Index rows = 0;
  Joints largest = Joints::Zero();
  for (const LoadCase& load : cases) {
    rows += load.rotation ? 6 : 3;
    largest = largest.cwiseMax(TorquesOf(arm, load).cwiseAbs());
  }
  System system;
  system.L.resize(rows, 6 + static_cast<Eigen::Index>(options.beside.size()));
  system.x.resize(rows);
  Eigen::Index row = 0;
  for (size_t i = 0; i < cases.size(); ++i) {
    const LoadCase& load = cases[i];
    const Matrix6 measured = Jacobian(arm, load.q, load.measured_point);
    const Joints torques = TorquesOf(arm, load);
    const auto fill = [&](Eigen::Index column, const Vector3d& moves, const Vector3d& turns) {
      system.L.block<3, 1>(row, column) = moves / options.displacement_deviation;
      if (load.rotation) system.L.block<3, 1>(row + 3, column) = turns / options.rotation_deviation;
    };
    for (int j = 0; j < 6; ++j)
      fill(j, torques[j] * measured.col(j).head<3>(), torques[j] * measured.col(j).tail<3>());
    system.x.segment<3>(row) = load.displacement / options.displacement_deviation;
    if (load.rotation) system.x.segment<3>(row + 3) = *load.rotation / options.rotation_deviation;
    const LinkPoses frames = LinkFrames(arm, load.q);
    for (size_t k = 0; k < options.beside.size(); ++k) {
      const Give& give = options.beside[k];
      const auto column = static_cast<Eigen::Index>(6 + k);
      if (give.kind == Give::Kind::kTakesUp) {
        const int j = give.link - 1;
        const double side = std::abs(torques[j]) > kNoTorque * largest[j] ? Sign(torques[j]) : 0;
        fill(column, side * measured.col(j).head<3>(), side * measured.col(j).tail<3>());
        continue;
      }
      const Lever at = LeverOf(frames, give, load.load_point),
                  there = LeverOf(frames, give, load.measured_point);
      const double wrench = at.moves.dot(load.force) + at.turns.dot(load.moment);
      fill(column, wrench * there.moves, wrench * there.turns);
    }
    for (int k = 0; k < (load.rotation ? 6 : 3); ++k, ++row) {
      system.case_of_row.push_back(i);
      system.displaces.push_back(k < 3);
    }
  }
  return system;
}

System MakeWeightSystem(const Arm& arm, const std::vector<LoadCase>& cases, const IdentifyOptions& options) {
  std::vector<LoadCase> weights = cases;
  for (LoadCase& load : weights) {
    load.force = options.down;
    load.moment.setZero();
  }
  System system = MakeSystem(arm, weights, options);
  for (size_t k = 0; k < options.beside.size(); ++k)
    if (options.beside[k].kind == Give::Kind::kTakesUp)
      system.L.col(static_cast<Eigen::Index>(6 + k)).setZero();
  return system;
}

System Columns(const System& system, const std::vector<Eigen::Index>& columns) {
  System some{system.L(Eigen::all, columns), system.x, system.case_of_row, system.displaces};
  return some;
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
  if (loaded.size() < 2) return reasons;
  const auto n = static_cast<Eigen::Index>(loaded.size());
  // Of unit columns QR: what of one the others cannot make is 1 ÷ the length of its row of R⁻¹.
  VectorXd own = VectorXd::Zero(n);
  if (L.rows() >= n) {
    MatrixXd R = TriangleOf(Scaled(L, loaded));
    constexpr double kRounding = 1e-15;  // what it leaves of a column that others make
    for (Eigen::Index k = 0; k < n; ++k)
      if (std::abs(R(k, k)) < kRounding) R(k, k) = kRounding;
    own = InverseOfTriangle(R).rowwise().norm().cwiseInverse();
  }
  for (Eigen::Index k = 0; k < n; ++k)
    if (own[k] < kDependent)
      reasons[static_cast<size_t>(loaded[static_cast<size_t>(k)])] =
          "not observable: its effect is a combination of other joints'";
  return reasons;
}

double Condition(const MatrixXd& L, const std::vector<std::string>& unobservable) {
  std::vector<Eigen::Index> keep;
  for (Eigen::Index j = 0; j < L.cols(); ++j)
    if (unobservable[static_cast<size_t>(j)].empty()) keep.push_back(j);
  if (keep.size() < 2) return 1;
  const VectorXd values = SingularValues(Scaled(L, keep));
  return values[0] / values[values.size() - 1];
}

Solution SolveSubset(const MatrixXd& N, const VectorXd& g, const std::vector<char>& keep) {
  std::vector<Eigen::Index> at;
  for (Eigen::Index j = 0; j < N.cols(); ++j)
    if (keep[static_cast<size_t>(j)]) at.push_back(j);
  Solution solution{VectorXd::Zero(N.cols()), MatrixXd::Zero(N.cols(), N.cols()),
                    std::vector<char>(keep.size(), 0)};
  if (at.empty()) return solution;
  const VectorXd scale = N.diagonal()(at).cwiseSqrt().cwiseInverse();
  const MatrixXd M = scale.asDiagonal() * MatrixXd(N(at, at)) * scale.asDiagonal();
  const MatrixXd inverse = SolvePositive(M, MatrixXd::Identity(M.rows(), M.cols()));
  const VectorXd c = inverse * scale.cwiseProduct(VectorXd(g(at)));
  solution.c(at) = scale.cwiseProduct(c);
  solution.inverse(at, at) = scale.asDiagonal() * inverse * scale.asDiagonal();
  for (const Eigen::Index j : at) solution.active[static_cast<size_t>(j)] = 1;
  return solution;
}

Solution SolveNonNegative(const MatrixXd& N, const VectorXd& g, const std::vector<char>& free, bool payload,
                          const Solution& start) {
  constexpr double kFlat = 1e-10;  // of a scaled gradient
  const size_t signed_from = free.size() - (payload ? 1 : 0);
  std::vector<char> passive = start.active;
  if (payload) passive.back() = free.back();
  Solution best = start;
  const VectorXd scale = N.diagonal().cwiseMax(std::numeric_limits<double>::min()).cwiseSqrt().cwiseInverse();
  const double size = scale.cwiseProduct(g).cwiseAbs().maxCoeff();
  for (size_t round = 0; round < 10 * free.size(); ++round) {
    VectorXd from = best.c;
    for (size_t step = 0; step <= free.size(); ++step) {  // each but the last takes an unknown out
      const Solution tried = SolveSubset(N, g, passive);
      if (Positive(tried, payload)) {
        best = tried;
        break;
      }
      GoTowards(tried.c, signed_from, passive, from);
    }
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
  }
  return best;
}

double Fitted::freedom() const {
  return static_cast<double>(system.x.size()) - static_cast<double>(std::ranges::count(free, 1));
}

Fitted FitSystem(const System& stated, const System* weight, bool robust) {
  Fitted fit;
  FitLinear(stated, robust, fit);
  if (!weight || fit.freedom() < 2) return fit;
  constexpr int kMost = 100;
  constexpr double kSettled = 1e-9, kLeast = 1e-6;  // of the payload; N
  double payload = 0;
  for (int round = 0; round < kMost; ++round) {
    VectorXd c = fit.solution.c.head(stated.L.cols());
    FitLinear(Near(stated, *weight, c, payload), robust, fit);
    if (!fit.reasons.back().empty() || fit.freedom() < 1) return fit;
    const double before = std::exchange(payload, fit.solution.c.tail<1>()[0]);
    if (std::abs(payload - before) < kSettled * std::abs(payload) + kLeast) return fit;
  }
  fit.reasons.back() = "not determined: its fit does not settle";
  return fit;
}

std::vector<size_t> PosesOf(const std::vector<LoadCase>& cases) {
  std::vector<size_t> poses;
  for (size_t i = 0; i < cases.size(); ++i)
    poses.push_back(i == 0 ? 0 : poses.back() + (cases[i].q != cases[i - 1].q));
  return poses;
}

}  // namespace millpose::identify
