// SPDX-License-Identifier: GPL-3.0-or-later
#include "stiffness/map.hpp"

#include <cassert>

#include "base/text.hpp"
#include "base/trig.hpp"
#include "base/units.hpp"
#include "stiffness/indices_block.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;

enum Index : size_t {
  kDexterity,
  kMu,
  kLambdaT1,
  kLambdaT2,
  kLambdaN,
  kNormal,
  kInPlane,
  kLargest,
  kCross,
  kChen2021
};

bool GreaterIsBetter(size_t index) { return index == kDexterity || index == kMu; }

size_t IndexOf(const std::string& name) {
  const auto& all = MapIndices();
  const auto found =
      std::find_if(all.begin(), all.end(), [&](const MapIndex& entry) { return entry.name == name; });
  assert(found != all.end());
  return static_cast<size_t>(found - all.begin());
}

/// The index of every lane of one branch, `q` its joints.
void Evaluate(const MapRequest& request, size_t index, const FlangeBlock& flange,
              const ArmBranchBlock& branch, const std::array<Lanes, 6>& q, Lanes& out) {
  const Vector3d tip = request.X_FT.translation();
  if (index == kDexterity)
    return DexterityOfBlock(request.arm, flange, branch, tip, request.characteristic_length, out);
  const Vector3d point = request.at_flange ? Vector3d::Zero() : tip;
  ComplianceBlock c;
  LinearCompliance(request.arm, flange, branch, point, c);
  if (!request.elements.empty())
    AddSeriesCompliance(request.arm, request.elements, point, branch.reached, q, c);
  PlaneIndicesBlock indices;
  PlaneDeflectionsBlock deflections;
  IndicesInPlane(c, request.normal, indices);
  DeflectionsInPlane(c, request.normal, deflections);
  const Lanes* from[] = {nullptr,           &indices.mu,         &indices.lambda_t1,    &indices.lambda_t2,
                         &indices.lambda_n, &deflections.normal, &deflections.in_plane, &deflections.largest,
                         &deflections.cross};
  if (index != kChen2021) {
    out = *from[index];
    return;
  }
  for (int i = 0; i < kLanes; ++i) out.v[i] = 0.5 * indices.lambda_t2.v[i] + 0.5 * indices.lambda_n.v[i];
}

/// Keeps `candidate` when it beats what the point has.
void Offer(bool greater, const MapPoint& candidate, MapPoint& best) {
  if (!std::isfinite(candidate.value)) return;
  if (best.reached && (greater ? candidate.value <= best.value : candidate.value >= best.value)) return;
  best = candidate;
  best.reached = true;
}

MapPoint BestPose(const MapRequest& request, size_t index, const Vector3d& point) {
  const PlaneBasis basis = BasisOfPlane(request.tool_axis);
  const int rotations = std::max(1, static_cast<int>(std::ceil(2 * kPi / request.rotation_step - 1e-9)));
  const Pose X_TF = request.X_FT.inverse();
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
      const ArmBranchBlock& solved = branches[branch & 3];
      AnglesBlock angles;
      AnglesOfBranch(request.arm, solved, angles);
      if (branch >= 4) {
        angles.unflipped[3] = angles.flipped4;
        angles.unflipped[4] = angles.flipped5;
        angles.unflipped[5] = angles.flipped6;
      }
      Lanes values;
      Evaluate(request, index, flange, solved, angles.unflipped, values);
      for (int lane = 0; lane < kLanes; ++lane) {
        if (solved.reached.v[lane] == 0 || solved.wrist.v[lane] < 1e-6) continue;
        Joints q;
        for (int k = 0; k < 6; ++k) q[k] = angles.unflipped[k].v[lane];
        const std::vector<Joints> within = FullTurns(q, request.lower, request.upper);
        if (within.empty()) continue;
        Offer(GreaterIsBetter(index), {point, true, values.v[lane], rotation[lane], branch, within.front()},
              best);
      }
    }
  }
  return best;
}

}  // namespace

const std::vector<MapIndex>& MapIndices() {
  static const std::vector<MapIndex> indices{
      {"dexterity", "1", "D of eq. 3 with the characteristic length; greatest"},
      {"mu", "1", "isotropy of the section; greatest"},
      {"lambda_t1", "mm/N", "longer semi-axis of the section"},
      {"lambda_t2", "mm/N", "shorter semi-axis of the section"},
      {"lambda_n", "mm/N", "radius along the normal"},
      {"normal_deflection", "mm/N", "displacement along the normal per force along it"},
      {"in_plane_deflection", "mm/N", "largest in-plane displacement per in-plane force"},
      {"worst_in_plane", "mm/N", "largest displacement per in-plane force"},
      {"cross_deflection", "mm/N", "largest displacement along the normal per in-plane force"},
      {"chen2021", "mm/N", "0.5 lambda_t2 + 0.5 lambda_n, eq. 23"},
  };
  return indices;
}

std::vector<MapPoint> DrawMap(const MapRequest& request) {
  const size_t index = IndexOf(request.index);
  std::vector<MapPoint> points;
  for (int j = 0; j < request.v_count; ++j)
    for (int i = 0; i < request.u_count; ++i)
      points.push_back(BestPose(request, index, request.origin + i * request.u + j * request.v));
  return points;
}

std::string MapToCsv(const MapRequest& request, const std::vector<MapPoint>& points) {
  const std::string& unit = MapIndices()[IndexOf(request.index)].unit;
  std::string text =
      fmt::format("x_mm,y_mm,z_mm,{}{},rotation_deg,branch,a1_deg,a2_deg,a3_deg,a4_deg,a5_deg,a6_deg\n",
                  request.index, unit == "1" ? "" : "_mm_N");
  for (const MapPoint& at : points) {
    text += fmt::format("{},{},{}", ShortestNumber(at.point.x()), ShortestNumber(at.point.y()),
                        ShortestNumber(at.point.z()));
    if (at.reached) {
      text += fmt::format(",{},{},{}", ShortestNumber(at.value), ShortestNumber(RadToDeg(at.rotation)),
                          at.branch);
      for (int k = 0; k < 6; ++k) text += "," + ShortestNumber(RadToDeg(at.q[k]));
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
