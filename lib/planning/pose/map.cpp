// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/pose/map.hpp"

#include <cassert>

#include "base/error.hpp"
#include "base/text.hpp"
#include "base/trig.hpp"
#include "base/units.hpp"
#include "machine/stiffness/indices_block.hpp"
#include "machine/stiffness/series_block.hpp"
#include "planning/pose/objective.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;

enum class Shown : size_t {
  kDexterity,
  kMu,
  kLambdaT1,
  kLambdaT2,
  kLambdaN,
  kNormal,
  kInPlane,
  kLargest,
  kCross
};

/// What is drawn: an index of the stiffness, or an objective.
struct Drawn {
  Shown index = Shown::kDexterity;
  std::unique_ptr<Objective> objective;

  bool greater_is_better() const { return !objective && (index == Shown::kDexterity || index == Shown::kMu); }
};

Drawn DrawnBy(const std::string& name) {
  const std::vector<MapIndex>& all = MapIndices();
  const auto found = std::ranges::find(all, name, &MapIndex::name);
  assert(found != all.end());
  const auto place = static_cast<size_t>(found - all.begin());
  if (place > static_cast<size_t>(Shown::kCross)) return {Shown::kDexterity, MakeObjective(name, {})};
  return {static_cast<Shown>(place), nullptr};
}

/// Where stiffness is asked for, in F, mm.
Vector3d StiffnessPoint(const MapRequest& request) {
  return request.at_flange ? Vector3d(Vector3d::Zero()) : Vector3d(request.X_FT.translation());
}

/// The value of every lane of one branch, or of the other wrist that it stands for.
void Evaluate(const MapRequest& request, const Drawn& drawn, const SeriesBlock& series,
              const FlangeBlock& flange, const ArmBranchBlock& branch, bool flipped, Lanes& out) {
  const Vector3d tip = request.X_FT.translation();
  if (!drawn.objective && drawn.index == Shown::kDexterity)
    return DexterityOfBlock(request.arm, flange, branch, tip, request.characteristic_length, out);
  const Vector3d point = StiffnessPoint(request);
  ComplianceBlock c;
  LinearCompliance(request.arm, flange, branch, point, c);
  series.AddTo(flange, branch, flipped, c);
  if (drawn.objective) {
    const Vector3d feed = BasisOfPlane(request.tool_axis).first;  // any: values do not depend on it
    return drawn.objective->Evaluate(c, {request.normal, feed, request.tool_axis}, out);
  }
  PlaneIndicesBlock indices;
  PlaneDeflectionsBlock deflections;
  IndicesInPlane(c, request.normal, indices);
  DeflectionsInPlane(c, request.normal, deflections);
  const Lanes* from[] = {nullptr,           &indices.mu,         &indices.lambda_t1,    &indices.lambda_t2,
                         &indices.lambda_n, &deflections.normal, &deflections.in_plane, &deflections.largest,
                         &deflections.cross};
  out = *from[static_cast<size_t>(drawn.index)];
}

/// Keeps `candidate` when it beats what the point has.
void Offer(bool greater, const MapPoint& candidate, MapPoint& best) {
  if (!std::isfinite(candidate.value)) return;
  if (best.reached && (greater ? candidate.value <= best.value : candidate.value >= best.value)) return;
  best = candidate;
  best.reached = true;
}

MapPoint BestPose(const MapRequest& request, const Drawn& drawn, const Vector3d& point) {
  const PlaneBasis basis = BasisOfPlane(request.tool_axis);
  const int rotations = std::max(1, static_cast<int>(std::ceil(2 * kPi / request.rotation_step - 1e-9)));
  const Pose X_TF = request.X_FT.inverse();
  const SeriesBlock series(request.arm, request.elements, StiffnessPoint(request));
  MapPoint best;
  best.point = point;
  for (int first = 0; first < rotations; first += kLanes) {
    FlangeBlock flange;
    std::array<double, kLanes> rotation;
    for (int lane = 0; lane < kLanes; ++lane) {
      rotation[lane] = 2 * kPi * std::min(first + lane, rotations - 1) / rotations - kPi;
      const auto [sine, cosine] = SinCos(rotation[lane]);
      Pose X_BT = Pose::Identity();
      X_BT.linear().col(0) = cosine * basis.first + sine * basis.second;
      X_BT.linear().col(1) = cosine * basis.second - sine * basis.first;
      X_BT.linear().col(2) = request.tool_axis;
      X_BT.translation() = point;
      flange.Set(lane, X_BT * X_TF);
    }
    ArmBranches branches;
    InverseBlock(request.arm, flange, branches);
    for (int branch = 0; branch < 8; ++branch) {
      const int entry = branch % EntryCount(request.arm);
      const ArmBranchBlock& solved = branches[entry];
      AnglesBlock angles;
      AnglesOfBranch(request.arm, solved, angles);
      if (branch != entry) {
        angles.unflipped[3] = angles.flipped4;
        angles.unflipped[4] = angles.flipped5;
        angles.unflipped[5] = angles.flipped6;
      }
      Lanes values;
      Evaluate(request, drawn, series, flange, solved, branch != entry, values);
      for (int lane = 0; lane < kLanes; ++lane) {
        if (solved.reached.v[lane] == 0 || solved.wrist.v[lane] < 1e-6) continue;
        Joints q;
        for (int k = 0; k < 6; ++k) q[k] = angles.unflipped[k].v[lane];
        const std::vector<Joints> within = FullRevolutions(q, request.lower, request.upper);
        if (within.empty()) continue;
        Offer(drawn.greater_is_better(),
              {point, true, values.v[lane], rotation[lane], branch, within.front()}, best);
      }
    }
  }
  return best;
}

// Objectives that need no numbers from a job and no feed, and that are no index by another way.
void AddObjectives(std::vector<MapIndex>& indices) {
  for (const std::string& name : Objectives().Names()) {
    if (std::ranges::find(indices, name, &MapIndex::name) != indices.end()) continue;
    try {
      const std::unique_ptr<Objective> objective = MakeObjective(name, {});
      if (!objective->DependsOnFeed()) indices.push_back({name, objective->Unit()});
    } catch (const InputError&) {
    }
  }
}

}  // namespace

const std::vector<MapIndex>& MapIndices() {
  static const std::vector<MapIndex> indices = [] {
    std::vector<MapIndex> all{{"dexterity", "1"},
                              {"mu", "1"},
                              {"lambda_t1", "mm/N"},
                              {"lambda_t2", "mm/N"},
                              {"lambda_n", "mm/N"},
                              {"normal_deflection", "mm/N"},
                              {"in_plane_deflection", "mm/N"},
                              {"worst_in_plane", "mm/N"},
                              {"cross_deflection", "mm/N"}};
    AddObjectives(all);
    return all;
  }();
  return indices;
}

std::vector<MapPoint> DrawMap(const MapRequest& request) {
  const Drawn drawn = DrawnBy(request.index);
  std::vector<MapPoint> points;
  for (int j = 0; j < request.v_count; ++j)
    for (int i = 0; i < request.u_count; ++i)
      points.push_back(BestPose(request, drawn, request.origin + i * request.u + j * request.v));
  return points;
}

std::string MapToCsv(const MapRequest& request, const std::vector<MapPoint>& points) {
  const std::string& unit = std::ranges::find(MapIndices(), request.index, &MapIndex::name)->unit;
  std::string text =
      fmt::format("x_mm,y_mm,z_mm,{}{},rotation_deg,branch,a1_deg,a2_deg,a3_deg,a4_deg,a5_deg,a6_deg\n",
                  request.index, unit == "1" ? "" : "_mm_N");
  for (const MapPoint& at : points) {
    text += fmt::format("{},{},{}", ShortestNumber(at.point.x()), ShortestNumber(at.point.y()),
                        ShortestNumber(at.point.z()));
    if (at.reached) {
      text += fmt::format(",{},{},{}", ShortestNumber(at.value), ShortestNumber(RadToDeg(at.rotation)),
                          at.branch);
      for (int k = 0; k < 6; ++k) text += fmt::format(",{}", ShortestNumber(RadToDeg(at.q[k])));
    } else {
      text += ",,,,,,,,,";
    }
    text += '\n';
  }
  return text;
}

std::string MapToVtk(const MapRequest& request, const std::vector<MapPoint>& points) {
  std::string text = fmt::format(
      "# vtk DataFile Version 3.0\nmillpose map of {}\nASCII\nDATASET STRUCTURED_GRID\nDIMENSIONS {} {} "
      "1\nPOINTS {} "
      "double\n",
      request.index, request.u_count, request.v_count, points.size());
  for (const MapPoint& at : points)
    text += fmt::format("{} {} {}\n", ShortestNumber(at.point.x()), ShortestNumber(at.point.y()),
                        ShortestNumber(at.point.z()));
  text +=
      fmt::format("POINT_DATA {}\nSCALARS {} double 1\nLOOKUP_TABLE default\n", points.size(), request.index);
  for (const MapPoint& at : points) text += (at.reached ? ShortestNumber(at.value) : "0") + "\n";
  text += "SCALARS reached int 1\nLOOKUP_TABLE default\n";
  for (const MapPoint& at : points) text += at.reached ? "1\n" : "0\n";
  return text;
}

}  // namespace millpose
