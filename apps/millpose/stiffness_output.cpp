// SPDX-License-Identifier: GPL-3.0-or-later
#include "stiffness_output.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "base/text.hpp"
#include "base/units.hpp"

namespace millpose {
namespace {

using Json = nlohmann::ordered_json;
using Eigen::Vector3d;

template <class Matrix>
Json Rows(const Matrix& m) {
  Json rows = Json::array();
  for (Eigen::Index i = 0; i < m.rows(); ++i) {
    Json row = Json::array();
    for (Eigen::Index j = 0; j < m.cols(); ++j) row.push_back(m(i, j));
    rows.push_back(std::move(row));
  }
  return rows;
}

Json Numbers(const Eigen::VectorXd& v) { return Json(std::vector<double>(v.begin(), v.end())); }

std::string DirectionText(const Vector3d& v) {
  return fmt::format("({:+.4f} {:+.4f} {:+.4f})", v.x(), v.y(), v.z());
}

template <class Matrix>
std::string Table(const Matrix& m) {
  std::string text;
  for (Eigen::Index i = 0; i < m.rows(); ++i) {
    text += ' ';
    for (Eigen::Index j = 0; j < m.cols(); ++j) text += fmt::format(" {:>12.5e}", m(i, j));
    text += '\n';
  }
  return text;
}

double PaperObjective(const MillingPlaneIndices& at) { return 0.5 * at.lambda_t2 + 0.5 * at.lambda_n; }

Json ToJson(const PoseReport& report) {
  const PoseStiffness& s = report.stiffness;
  Json json;
  json["joints_deg"] = Numbers(report.q * kDegPerRad);
  json["stiffness_at"] = report.origin;
  json["origin_mm"] = Numbers(s.origin);
  json["frame"] = "robot_base";
  json["normal"] = Numbers(report.normal);
  json["units"] = {{"compliance", "mm/N"},
                   {"C", {"mm/N", "1/N", "1/N", "rad/(N*mm)"}},
                   {"K", {"N/mm", "N", "N", "N*mm/rad"}}};
  json["C"] = Rows(s.C);
  json["K"] = s.K ? Rows(*s.K) : Json();
  json["lambda"] = Numbers(s.lambda);
  json["lambda_directions"] = Rows(s.directions.transpose());
  const auto maybe = [&](auto value) { return s.indices ? Json(value(*s.indices)) : Json(); };
  json["lambda_t1"] = maybe([](const auto& at) { return at.lambda_t1; });
  json["lambda_t2"] = maybe([](const auto& at) { return at.lambda_t2; });
  json["lambda_t1_direction"] = s.indices ? Numbers(s.t1_direction) : Json();
  json["lambda_t2_direction"] = s.indices ? Numbers(s.t2_direction) : Json();
  json["lambda_n"] = maybe([](const auto& at) { return at.lambda_n; });
  json["mu"] = maybe([](const auto& at) { return at.mu; });
  json["f"] = maybe(PaperObjective);
  json["normal_deflection"] = s.deflections.normal;
  json["in_plane_deflection"] = s.deflections.in_plane;
  json["worst_in_plane"] = s.deflections.largest;
  json["cross_deflection"] = s.deflections.cross;
  json["dexterity"] = s.dexterity;
  json["singularity"] = {{"wrist", s.singularity.wrist},
                         {"elbow", s.singularity.elbow},
                         {"shoulder_mm", s.singularity.shoulder}};
  json["weight_deflection_mm"] = report.weight ? Numbers(*report.weight) : Json();
  json["counterbalance_ignored"] = report.weight ? Json(report.counterbalance_ignored) : Json();
  return json;
}

}  // namespace

std::string ReportAsText(const PoseReport& report) {
  const PoseStiffness& s = report.stiffness;
  std::string text = fmt::format(
      "Stiffness at the {}, x y z = {:.4f} {:.4f} {:.4f} mm in the robot base frame\n",
      report.origin == "flange" ? "flange" : "tool tip", s.origin.x(), s.origin.y(), s.origin.z());
  text += "normal of the milling plane  " + DirectionText(report.normal) + "\n\n";
  const char* names[3] = {"lambda1", "lambda2", "lambda3"};
  for (int i = 0; i < 3; ++i)
    text += fmt::format("{:<28} {:.6e} mm/N  along {}\n", names[i], s.lambda[i],
                        DirectionText(s.directions.col(i)));
  if (s.indices) {
    text += fmt::format("{:<28} {:.6e} mm/N  along {}\n", "lambda_t1 (in plane)", s.indices->lambda_t1,
                        DirectionText(s.t1_direction));
    text += fmt::format("{:<28} {:.6e} mm/N  along {}\n", "lambda_t2 (in plane)", s.indices->lambda_t2,
                        DirectionText(s.t2_direction));
    text += fmt::format("{:<28} {:.6e} mm/N  radius along the normal, not a displacement\n", "lambda_n",
                        s.indices->lambda_n);
    text += fmt::format("{:<28} {:.6f}           lambda_t2/lambda_t1\n", "mu", s.indices->mu);
    text += fmt::format("{:<28} {:.6e} mm/N  0.5 lambda_t2 + 0.5 lambda_n (eq. 23)\n", "f",
                        PaperObjective(*s.indices));
  } else {
    text += "lambda_t1, lambda_t2, lambda_n, mu, f: none, the linear compliance is singular in this pose\n";
  }
  text += fmt::format("{:<28} {:.6e} mm/N  along n per force along n\n", "n'cn", s.deflections.normal);
  text += fmt::format("{:<28} {:.6e} mm/N  largest in plane per in-plane force\n", "sigma_max(B'cB)",
                      s.deflections.in_plane);
  text += fmt::format("{:<28} {:.6e} mm/N  largest of all per in-plane force\n", "sigma_max(cB)",
                      s.deflections.largest);
  text += fmt::format("{:<28} {:.6e} mm/N  along n per in-plane force\n", "|n'cB|", s.deflections.cross);
  text += fmt::format("{:<28} {:.6f}           0 singular, 1 isotropic\n", "dexterity D", s.dexterity);
  text += fmt::format("{:<28} {:.4f} |sin A5|, {:.4f} |sin elbow|, {:.1f} mm wrist centre from axis 1\n\n",
                      "from singularity", s.singularity.wrist, s.singularity.elbow, s.singularity.shoulder);
  if (report.weight)
    text += fmt::format("{:<28} {:+.4f} {:+.4f} {:+.4f} mm against the calibration pose{}\n\n",
                        "weight moves the point", report.weight->x(), report.weight->y(), report.weight->z(),
                        report.counterbalance_ignored ? "; counterbalance of A2 ignored" : "");
  text += "C (blocks mm/N, 1/N; 1/N, rad/(N mm))\n" + Table(s.C);
  if (s.K)
    text += "K (blocks N/mm, N; N, N mm/rad)\n" + Table(*s.K);
  else
    text += "K: none, C is singular in this pose\n";
  return text;
}

std::string ReportAsJson(const PoseReport& report) {
  Json json{{"schema_version", 1}};
  json.update(ToJson(report));
  return json.dump(2) + "\n";
}

std::string ReportsAsJson(const std::vector<PoseReport>& reports) {
  Json json{{"schema_version", 1}, {"poses", Json::array()}};
  for (const PoseReport& report : reports) json["poses"].push_back(ToJson(report));
  return json.dump(2) + "\n";
}

std::string ReportsAsCsv(const std::vector<PoseReport>& reports) {
  std::string text =
      "a1_deg,a2_deg,a3_deg,a4_deg,a5_deg,a6_deg,nx,ny,nz,stiffness_at,x_mm,y_mm,z_mm,lambda_1_mm_N,lambda_2_"
      "mm_N,"
      "lambda_3_mm_N,lambda_t1_mm_N,lambda_t2_mm_N,lambda_n_mm_N,mu,f_mm_N,normal_deflection_mm_N,in_plane_"
      "deflection_mm_N,"
      "worst_in_plane_mm_N,cross_deflection_mm_N,dexterity,wrist,elbow,shoulder_mm\n";
  for (const PoseReport& report : reports) {
    const PoseStiffness& s = report.stiffness;
    std::vector<std::string> cells;
    const auto add = [&](double value) { cells.push_back(ShortestNumber(value)); };
    for (int i = 0; i < 6; ++i) add(RadToDeg(report.q[i]));
    for (int i = 0; i < 3; ++i) add(report.normal[i]);
    cells.push_back(report.origin);
    for (int i = 0; i < 3; ++i) add(s.origin[i]);
    for (int i = 0; i < 3; ++i) add(s.lambda[i]);
    if (s.indices)
      for (const double value : {s.indices->lambda_t1, s.indices->lambda_t2, s.indices->lambda_n,
                                 s.indices->mu, PaperObjective(*s.indices)})
        add(value);
    else
      cells.insert(cells.end(), 5, "");
    for (const double value :
         {s.deflections.normal, s.deflections.in_plane, s.deflections.largest, s.deflections.cross,
          s.dexterity, s.singularity.wrist, s.singularity.elbow, s.singularity.shoulder})
      add(value);
    text += fmt::format("{}\n", fmt::join(cells, ","));
  }
  return text;
}

std::string MapAsJson(const MapRequest& request, const std::vector<MapPoint>& points) {
  const auto entry = std::ranges::find(MapIndices(), request.index, &MapIndex::name);
  Json json{{"schema_version", 1},
            {"index", request.index},
            {"unit", entry->unit},
            {"stiffness_at", request.at_flange ? "flange" : "tool_tip"},
            {"frame", "robot_base"},
            {"tool_axis", Numbers(request.tool_axis)},
            {"normal", Numbers(request.normal)},
            {"steps", {request.u_count - 1, request.v_count - 1}},
            {"points", Json::array()}};
  for (const MapPoint& at : points)
    json["points"].push_back({{"point_mm", Numbers(at.point)},
                              {"value", at.reached ? Json(at.value) : Json()},
                              {"rotation_deg", at.reached ? Json(RadToDeg(at.rotation)) : Json()},
                              {"branch", at.reached ? Json(at.branch) : Json()},
                              {"joints_deg", at.reached ? Numbers(at.q * kDegPerRad) : Json()}});
  return json.dump(2) + "\n";
}

std::string MapSummary(const MapRequest& request, const std::vector<MapPoint>& points) {
  size_t reached = 0;
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const MapPoint& at : points) {
    if (!at.reached) continue;
    ++reached;
    low = std::min(low, at.value);
    high = std::max(high, at.value);
  }
  if (reached == 0)
    return fmt::format("{}: none of {} points is reached within the limits\n", request.index, points.size());
  return fmt::format("{}: {} of {} points reached, {:.6g} to {:.6g}\n", request.index, reached, points.size(),
                     low, high);
}

}  // namespace millpose
