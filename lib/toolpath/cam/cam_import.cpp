// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/cam/cam_import.hpp"

#include "base/error.hpp"
#include "geometry/mesh/corner_normals.hpp"

namespace millpose {
namespace {

constexpr double kSame = 1e-6;  // mm: points nearer than this are one

class CamImporter {
 public:
  CamImporter(const Mesh* mesh, const CamImportOptions& options) : mesh_(mesh), options_(options) {
    if (mesh != nullptr) normals_.emplace(*mesh, options.crease);
  }

  Toolpath Run(const CamPath& path, CamImportReport& report) {
    std::vector<CamPoint> way;
    for (const CamPoint& point : path.points) {
      if (point.rapid || point.fresh) Finish(way, report);
      if (!way.empty() && (point.position - way.back().position).norm() < kSame) {
        if (point.axis.dot(way.back().axis) > 1 - 1e-12) continue;
        ++report.turns_on_the_spot;
        Finish(way, report);
      }
      way.push_back(point);
    }
    Finish(way, report);
    return std::move(toolpath_);
  }

  const std::vector<double>& distances() const { return distances_; }

 private:
  // Ends the pass that `way` holds; a single point is none.
  void Finish(std::vector<CamPoint>& way, CamImportReport& report) {
    if (way.size() > 1) {
      Pass& pass = toolpath_.passes.emplace_back();
      pass.rotation_reference = options_.rotation_reference;
      Fill(way, pass);
      if (pass.points.size() > 3 &&
          (pass.points.front().position - pass.points.back().position).norm() < kSame &&
          pass.points.front().tool_axis.dot(pass.points.back().tool_axis) > 1 - 1e-9) {
        pass.closed = true;
        pass.points.pop_back();
      }
      MarkLeads(pass, report);
      SetFeedDirections(pass);
    }
    way.clear();
  }

  void Fill(const std::vector<CamPoint>& way, Pass& pass) {
    pass_distances_.clear();
    for (size_t i = 0; i < way.size(); ++i) {
      const CamPoint &from = way[i == 0 ? 0 : i - 1], &to = way[i];
      const double length = (to.position - from.position).norm();
      if (!(length / options_.spacing + static_cast<double>(total_) <= options_.budget.most))
        throw InputError(
            {},
            fmt::format(
                "toolpath.spacing_mm: given {:.6g}; with line {} of the CAM path, {:.6g} mm long, the tool "
                "path has too many points; allowed: at most {:.7g} points ({})",
                options_.spacing, to.line, length, options_.budget.most, options_.budget.set_by));
      const int steps =
          i == 0 ? 1 : std::max(1, static_cast<int>(std::ceil(length / options_.spacing - 1e-9)));
      for (int k = 1; k <= steps; ++k) {
        const double share = static_cast<double>(k) / steps;
        MillingPoint point;
        point.position =
            k == steps ? to.position : Eigen::Vector3d(from.position + share * (to.position - from.position));
        const Eigen::Vector3d axis = from.axis + share * (to.axis - from.axis);
        point.tool_axis = k == steps || axis.norm() < 1e-6 ? to.axis : Eigen::Vector3d(axis.normalized());
        // A pass's first point is reached in rapid: its feed is that of the way after it.
        const CamPoint& giver = i == 0 ? way[1] : to;
        point.feed_rate = giver.feed_rate > 0 ? giver.feed_rate : options_.feed_rate;
        point.source_line = to.line;
        if (!pass.points.empty())
          point.arc_length =
              pass.points.back().arc_length + (point.position - pass.points.back().position).norm();
        pass_distances_.push_back(SetNormal(point));
        pass.points.push_back(point);
        ++total_;
      }
    }
  }

  // Returns the distance from the mesh (0 without one).
  double SetNormal(MillingPoint& point) const {
    point.normal = point.tool_axis;
    if (mesh_ == nullptr) return 0;
    const SurfacePoint nearest = mesh_->Closest(point.position + options_.ball_radius * point.tool_axis);
    point.normal = normals_->At(nearest.face, nearest.barycentric);
    return std::abs(nearest.distance - options_.ball_radius);
  }

  void MarkLeads(Pass& pass, CamImportReport& report) {
    const auto touches = [&](size_t i) { return pass_distances_[i] <= options_.contact_distance; };
    size_t first = 0, last = pass.points.size();
    while (first < last && !touches(first)) ++first;
    while (last > first && !touches(last - 1)) --last;
    for (size_t i = 0; i < pass.points.size(); ++i) {
      if (first < last && i < first) pass.points[i].kind = PointKind::kLeadIn;
      if (first < last && i >= last) pass.points[i].kind = PointKind::kLeadOut;
      report.leads += pass.points[i].kind != PointKind::kCut ? 1 : 0;
      if (pass.points[i].kind == PointKind::kCut) distances_.push_back(pass_distances_[i]);
    }
    report.points += pass.points.size();
    ++report.passes;
  }

  // From the neighbours on both sides, in the tangent plane. Plunges along the normal take over that of the
  // next cut.
  static void SetFeedDirections(Pass& pass) {
    const size_t count = pass.points.size();
    std::vector<char> known(count, 0);
    for (size_t i = 0; i < count; ++i) {
      const size_t before = i > 0 ? i - 1 : pass.closed ? count - 1 : 0;
      const size_t after = i + 1 < count ? i + 1 : pass.closed ? 0 : count - 1;
      const Eigen::Vector3d travel = pass.points[after].position - pass.points[before].position;
      known[i] = Project(travel, pass.points[i]) ? 1 : 0;
    }
    for (size_t i = count; i-- > 0;)
      if (known[i] == 0 && i + 1 < count)
        known[i] = Project(pass.points[i + 1].feed, pass.points[i]) ? known[i + 1] : 0;
    for (size_t i = 0; i < count; ++i) {
      if (known[i] == 0 && i > 0)
        known[i] = Project(pass.points[i - 1].feed, pass.points[i]) ? known[i - 1] : 0;
      if (known[i] == 0) pass.points[i].feed = pass.points[i].normal.unitOrthogonal();
    }
  }

  static bool Project(const Eigen::Vector3d& travel, MillingPoint& point) {
    const Eigen::Vector3d flat = travel - travel.dot(point.normal) * point.normal;
    if (!(flat.norm() > 1e-6 * travel.norm()) || !(travel.norm() > 0)) {
      point.feed.setZero();
      return false;
    }
    point.feed = flat.normalized();
    return true;
  }

  const Mesh* mesh_;
  const CamImportOptions& options_;
  std::optional<CornerNormals> normals_;
  Toolpath toolpath_;
  size_t total_ = 0;  // points
  std::vector<double> pass_distances_, distances_;
};

// What a file had besides ways: holes that are left out, and words without motion.
std::string LeftOut(const CamPath& path) {
  constexpr size_t kShown = 10;
  std::string text;
  for (size_t i = 0; i < std::min(kShown, path.holes_left_out.size()); ++i) {
    const CamHole& hole = path.holes_left_out[i];
    text +=
        fmt::format("{}{} in line {} ({})", i == 0 ? "; left out: " : ", ", hole.cycle, hole.line, hole.why);
  }
  if (path.holes_left_out.size() > kShown)
    text += fmt::format(", {} further holes", path.holes_left_out.size() - kShown);
  for (const std::string& note : path.notes)
    if (note.starts_with("skipped")) text += "; " + note;
  return text;
}

}  // namespace

Toolpath ImportCamPath(const CamPath& path, const Mesh* mesh, const CamImportOptions& options,
                       CamImportReport* report) {
  CamImportReport found;
  CamImporter importer(mesh, options);
  Toolpath toolpath = importer.Run(path, found);
  if (toolpath.passes.empty())
    throw InputError({}, "toolpath: the CAM path holds no cut: all its ways are rapids" + LeftOut(path));
  std::vector<double> distances = importer.distances();
  if (mesh != nullptr && !distances.empty()) {
    std::ranges::sort(distances);
    found.median_distance = distances[distances.size() / 2];
    found.largest_distance = distances.back();
  }
  if (report != nullptr) *report = found;
  return toolpath;
}

}  // namespace millpose
