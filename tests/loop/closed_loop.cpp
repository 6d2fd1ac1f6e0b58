// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/loop/closed_loop.hpp"

#include <yaml-cpp/yaml.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <nlohmann/json.hpp>
#include <random>

#include "tests/audit/kinematics.hpp"
#include "tests/audit/programs.hpp"

namespace millpose::loop {
namespace {

using audit::Angles;
using audit::Matrix3;
using audit::Matrix4;
using audit::Row;

Vector3 Tip(const Matrix4& X) { return X.block<3, 1>(0, 3); }

/// One point under load.
struct Place {
  Vector3 normal, force;
  std::array<Vector3, 6> columns;  ///< motion of the tip per rad of each joint, in W
  Matrix3 beside;                  ///< compliance of what is beside the joints
  Real program;                    ///< of the program's tip above the nominal point, along the normal
  Real worst_after;                ///< as reported
  bool taken;                      ///< something is taken out here
};

/// By central differences of the judge's own kinematics.
std::array<Vector3, 6> ColumnsAt(const audit::Setup& setup, const Angles& angles) {
  constexpr Real kStep = 1e-5L;
  std::array<Vector3, 6> columns;
  for (size_t j = 0; j < 6; ++j) {
    Angles more = angles, less = angles;
    more[j] += kStep;
    less[j] -= kStep;
    columns[j] = (Tip(Tool(setup, more)) - Tip(Tool(setup, less))) / (2 * kStep);
  }
  return columns;
}

Matrix3 JointsOnly(const audit::Setup& setup, const std::array<Vector3, 6>& columns) {
  Matrix3 c = Matrix3::Zero();
  for (size_t j = 0; j < 6; ++j) c += columns[j] * columns[j].transpose() / setup.stiffness[j];
  return c;
}

/// The tip of a program nearest to each row's commanded place, cut by cut.
std::vector<std::pair<const Row*, Vector3>> TipsOf(const audit::Folder& folder,
                                                   const std::string& controller) {
  std::vector<Row> rows = folder.rows;
  for (Row& row : rows)
    if (row.commanded) row.position = row.commanded->position, row.angles = row.commanded->angles;
  const auto targets = ReadProgram(controller, folder.programs.at(controller), folder.setup);
  std::vector<audit::Cut> cuts = CutsOf(rows, folder.setup);
  Compare(targets, cuts, folder.setup);
  const auto tip_of = [&](size_t target) { return Tip(folder.setup.X_WP * targets[target].X_PT); };
  std::vector<std::pair<const Row*, Vector3>> tips;
  for (const audit::Cut& cut : cuts) {
    size_t segment = cut.first;
    for (const Row* row : cut.rows) {
      Vector3 tip = tip_of(segment);
      Real best = (tip - row->position).norm();
      for (size_t k = segment; k + 1 <= std::min(cut.last, targets.size() - 1); ++k) {
        const Vector3 from = tip_of(k), way = tip_of(k + 1) - from;
        const Real square = way.squaredNorm();
        const Real share =
            square > 0 ? std::clamp((row->position - from).dot(way) / square, Real{0}, Real{1}) : 0;
        const Vector3 here = from + share * way;
        const Real off = (here - row->position).norm();
        if (off < best) best = off, tip = here, segment = k;
        if (off > best + 50) break;  // mm: it runs away
      }
      tips.emplace_back(&folder.rows[static_cast<size_t>(row - rows.data())], tip);
    }
  }
  return tips;
}

/// F turned by `off` rad towards a side that stands at `azimuth` about it.
Vector3 Turned(const Vector3& force, const Vector3& normal, Real off, Real azimuth) {
  const Vector3 along = force.normalized();
  Vector3 side = normal - normal.dot(along) * along;
  if (side.norm() < 1e-6L) side = along.unitOrthogonal();
  side.normalize();
  const Vector3 aside = along.cross(side);
  const Vector3 towards = std::cos(azimuth) * side + std::sin(azimuth) * aside;
  return force.norm() * (std::cos(off) * along + std::sin(off) * towards);
}

/// The truth of one draw.
struct Truth {
  std::array<Real, 6> flexibility;  ///< times the stated 1/k
  Real beside = 1, length = 1, off = 0, azimuth = 0;

  Real Error(const Place& place, const audit::Setup& setup) const {
    const Vector3 force = length * Turned(place.force, place.normal, off, azimuth);
    Real error = beside * place.normal.dot(place.beside * force);
    for (size_t j = 0; j < 6; ++j)
      error += flexibility[j] / setup.stiffness[j] * place.normal.dot(place.columns[j]) *
               place.columns[j].dot(force);
    return error;
  }
};

Real Quantile(std::vector<Real> values, Real share) {
  if (values.empty()) return 0;
  const auto at = static_cast<std::ptrdiff_t>(share * static_cast<Real>(values.size() - 1));
  std::ranges::nth_element(values, values.begin() + at);
  return values[static_cast<size_t>(at)];
}

std::vector<Place> PlacesOf(const audit::Folder& folder, const std::string& controller, Verdict& verdict) {
  std::vector<Place> places;
  const Truth nominal{{1, 1, 1, 1, 1, 1}};
  for (const auto& [row, tip] : TipsOf(folder, controller)) {
    const auto found = folder.compensated.find(row->point);
    if (found == folder.compensated.end() || !row->commanded) continue;
    const audit::Compensated& stated = found->second;
    if (stated.force.isZero(0)) continue;
    verdict.program = std::max(verdict.program, std::abs((tip - row->commanded->position).dot(row->normal)));
    Place place{row->normal,        stated.force,     ColumnsAt(folder.setup, row->commanded->angles), {}, 0,
                stated.worst_after, stated.taken != 0};
    place.beside =
        ComplianceAt(folder.setup, row->commanded->angles) - JointsOnly(folder.setup, place.columns);
    place.program = (tip - row->position).dot(row->normal);
    const Real bend = nominal.Error(place, folder.setup);
    verdict.nominal_residual = std::max(verdict.nominal_residual, std::abs(bend + place.program));
    // What the program's text adds by itself is distinguished.
    const Real commanded = (row->commanded->position - row->position).dot(row->normal);
    verdict.nominal =
        std::max(verdict.nominal, std::abs(bend + commanded - (stated.expected - stated.taken)));
    places.push_back(place);
  }
  verdict.points = places.size();
  return places;
}

}  // namespace

Bounds BoundsOf(const std::string& job_yaml, const std::string& cell_yaml) {
  const YAML::Node job = YAML::Load(job_yaml), cell = YAML::Load(cell_yaml);
  Bounds bounds;
  bounds.force = job["process"]["force_uncertainty_percent"].as<double>(30) / 100;
  bounds.direction = job["process"]["force_direction_deg"].as<double>(20) * audit::kDegree;
  bounds.joints.fill(0.1L);
  if (const YAML::Node stated = cell["arm"]["stiffness_uncertainty_percent"])
    for (size_t j = 0; j < 6; ++j) bounds.joints[j] = stated[j].as<double>() / 100;
  if (const YAML::Node stated = job["compensation"]["stiffness_uncertainty_percent"]) {
    bounds.joints.fill(stated.as<double>() / 100);
    bounds.beside = stated.as<double>() / 100;
  }
  return bounds;
}

Verdict Run(const audit::Folder& folder, const std::string& controller, const Bounds& bounds, size_t draws,
            uint64_t seed) {
  Verdict verdict;
  verdict.draws = draws;
  const std::vector<Place> places = PlacesOf(folder, controller, verdict);
  std::mt19937_64 random(seed);
  const auto draw = [&](Real low, Real high) {
    return low + (high - low) * static_cast<Real>(random() >> 11) * 0x1p-53L;
  };
  std::vector<Real> before, after, ratios;
  const Real slack = verdict.program + 1e-9L;
  for (size_t k = 0; k < draws; ++k) {
    Truth truth{};
    for (size_t j = 0; j < 6; ++j) truth.flexibility[j] = 1 / (1 + draw(-bounds.joints[j], bounds.joints[j]));
    truth.beside = 1 / (1 + draw(-bounds.beside, bounds.beside));
    truth.length = draw(std::max(Real{0}, 1 - bounds.force), 1 + bounds.force);
    truth.off = draw(0, bounds.direction);
    truth.azimuth = draw(0, 360 * audit::kDegree);
    Real worst_before = 0, worst_after = 0;
    for (const Place& place : places) {
      const Real error = truth.Error(place, folder.setup), left = error + place.program;
      worst_before = std::max(worst_before, std::abs(error));
      worst_after = std::max(worst_after, std::abs(left));
      verdict.beyond = std::max(verdict.beyond, std::abs(left) - place.worst_after);
      verdict.worse += std::abs(left) > std::abs(error) + slack;
      if (place.taken && error != 0) ratios.push_back(std::abs(left / error));
    }
    before.push_back(worst_before);
    after.push_back(worst_after);
  }
  verdict.quantile_before = Quantile(before, 0.95L);
  verdict.quantile_after = Quantile(after, 0.95L);
  verdict.remains = Quantile(std::move(ratios), 0.5L);
  return verdict;
}

std::string ToJson(const Verdict& v) {
  const auto um = [](Real mm) { return static_cast<double>(1000 * mm); };
  return nlohmann::ordered_json{{"points", v.points},
                                {"draws", v.draws},
                                {"program_um", um(v.program)},
                                {"nominal_error_um", um(v.nominal)},
                                {"nominal_residual_um", um(v.nominal_residual)},
                                {"worst_before_um_95", um(v.quantile_before)},
                                {"worst_after_um_95", um(v.quantile_after)},
                                {"beyond_reported_um", um(v.beyond)},
                                {"made_worse", v.worse},
                                {"median_remains", static_cast<double>(v.remains)}}
             .dump(2) +
         "\n";
}

namespace {

/// How far a way is off along the normal beside the straight line between two planned points.
Real OffBetween(const std::vector<Matrix4>& way, const Row& from, const Row& to) {
  if (!from.cut || !to.cut) return 0;
  const Vector3 along = to.position - from.position;
  const Real square = along.squaredNorm();
  Real largest = 0;
  for (const Matrix4& X : way) {
    const Real share = square > 0 ? (Tip(X) - from.position).dot(along) / square : -1;
    const Vector3 off = Tip(X) - from.position - share * along;
    if (share < 0 || share > 1 || off.norm() > 5) continue;  // mm: another pass
    largest = std::max(largest, std::abs(off.dot(Vector3((1 - share) * from.normal + share * to.normal))));
  }
  return largest;
}

}  // namespace

OwnArmVerdict RunOnOwnArm(const audit::Folder& folder, const std::string& controller,
                          const audit::OwnArm& arm) {
  std::vector<Row> rows = folder.rows;
  for (Row& row : rows)
    if (row.commanded) row.position = row.commanded->position, row.angles = row.commanded->angles;
  const auto targets = ReadProgram(controller, folder.programs.at(controller), folder.setup);
  std::vector<audit::Cut> cuts = CutsOf(rows, folder.setup);
  Compare(targets, cuts, folder.setup);
  const audit::Setup own = arm.In(folder.setup);
  constexpr int kParts = 8;  // of a straight motion
  OwnArmVerdict verdict;
  for (const audit::Cut& cut : cuts) {
    // The tool as its controller has it, and as it is, along the cut.
    std::vector<Matrix4> believed, real;
    Angles angles = cut.rows.front()->angles;
    const auto add = [&](const Matrix4& X_WT) {
      angles = Solve(folder.setup, X_WT, angles);
      believed.push_back(Tool(folder.setup, angles));
      real.push_back(Tool(own, angles));
    };
    add(folder.setup.X_WP * targets[cut.first].X_PT);
    for (size_t k = cut.first; k < cut.last; ++k) {
      const Matrix4 from = folder.setup.X_WP * targets[k].X_PT, to = folder.setup.X_WP * targets[k + 1].X_PT;
      const Eigen::AngleAxis<Real> turn(Matrix3(from.block<3, 3>(0, 0).transpose() * to.block<3, 3>(0, 0)));
      for (int part = 1; part <= kParts; ++part) {
        const Real share = static_cast<Real>(part) / kParts;
        Matrix4 X = from;
        X.block<3, 1>(0, 3) += share * (Tip(to) - Tip(from));
        X.block<3, 3>(0, 0) = from.block<3, 3>(0, 0) *
                              Eigen::AngleAxis<Real>(share * turn.angle(), turn.axis()).toRotationMatrix();
        add(X);
      }
    }
    const auto nearest = [](const std::vector<Matrix4>& way, const Vector3& place) {
      Vector3 best = Tip(way.front());
      size_t at = 0;
      for (size_t k = 0; k + 1 < way.size(); ++k) {
        const Vector3 from = Tip(way[k]), along = Tip(way[k + 1]) - from;
        const Real square = along.squaredNorm();
        const Real share = square > 0 ? std::clamp((place - from).dot(along) / square, Real{0}, Real{1}) : 0;
        const Vector3 here = from + share * along;
        if ((here - place).norm() < (best - place).norm()) best = here, at = share > 0.5L ? k + 1 : k;
      }
      return std::pair(best, at);
    };
    const auto planned_of = [&](const Row* row) -> const Row& {
      return folder.rows[static_cast<size_t>(row - rows.data())];
    };
    for (size_t k = 0; k + 1 < cut.rows.size(); ++k)
      verdict.between =
          std::max(verdict.between, OffBetween(real, planned_of(cut.rows[k]), planned_of(cut.rows[k + 1])));
    for (const Row* row : cut.rows) {
      const Row& planned = planned_of(row);
      if (!planned.cut) continue;
      ++verdict.points;
      const auto [tip, at] = nearest(real, planned.position);
      verdict.each.push_back(
          {planned.point, planned.position, planned.normal, (tip - planned.position).dot(planned.normal)});
      verdict.tip = std::max(verdict.tip, (tip - planned.position).norm());
      verdict.normal = std::max(verdict.normal, std::abs((tip - planned.position).dot(planned.normal)));
      verdict.axis =
          std::max(verdict.axis, audit::AngleBetween(Vector3(real[at].block<3, 1>(0, 2)), planned.axis));
      verdict.nominal_tip = std::max(verdict.nominal_tip,
                                     (nearest(believed, planned.position).first - planned.position).norm());
    }
  }
  return verdict;
}

std::string ToJson(const OwnArmVerdict& v, bool each) {
  nlohmann::ordered_json json{{"points", v.points},
                              {"own_tip_um", static_cast<double>(1000 * v.tip)},
                              {"own_normal_um", static_cast<double>(1000 * v.normal)},
                              {"own_between_um", static_cast<double>(1000 * v.between)},
                              {"own_axis_deg", static_cast<double>(v.axis / audit::kDegree)},
                              {"nominal_tip_um", static_cast<double>(1000 * v.nominal_tip)}};
  if (each)
    for (const OwnArmVerdict::Each& one : v.each) {
      const auto& [point, p, n, off] = one;
      nlohmann::ordered_json row = {point};
      for (const Real value : {p[0], p[1], p[2], n[0], n[1], n[2], 1000 * off})
        row.push_back(static_cast<double>(value));
      json["each"].push_back(row);
    }
  return json.dump(each ? -1 : 2) + "\n";
}

}  // namespace millpose::loop
