// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/toolpath/cam_writer.hpp"

namespace millpose {
namespace {

// The points of a pass in the order in which the tool visits them.
std::vector<const MillingPoint*> Visited(const Pass& pass) {
  std::vector<const MillingPoint*> points;
  for (const MillingPoint& point : pass.points) points.push_back(&point);
  if (pass.closed && !points.empty()) points.push_back(points.front());
  return points;
}

}  // namespace

std::string WriteApt(const Toolpath& toolpath, const std::string& name) {
  std::string text = fmt::format("PARTNO/{}\nUNITS/MM\nMULTAX/ON\n", name);
  for (const Pass& pass : toolpath.passes) {
    text += "RAPID\n";
    double feed = -1;
    for (const MillingPoint* point : Visited(pass)) {
      const Eigen::Vector3d &p = point->position, &a = point->tool_axis;
      if (feed >= 0 && point->feed_rate > 0 && point->feed_rate != feed)
        text += fmt::format("FEDRAT/{},MMPM\n", point->feed_rate * 60);
      feed = feed < 0 ? 0 : point->feed_rate;  // the first point is reached in rapid
      text += fmt::format("GOTO/{:.6f},{:.6f},{:.6f},$\n{:.9f},{:.9f},{:.9f}\n", p.x(), p.y(), p.z(), a.x(),
                          a.y(), a.z());
    }
  }
  return text + "FINI\n";
}

std::string WriteCamCsv(const Toolpath& toolpath) {
  std::string text = "pass,rapid,x_mm,y_mm,z_mm,i,j,k,feed_mm_s\n";
  for (size_t i = 0; i < toolpath.passes.size(); ++i) {
    bool first = true;
    for (const MillingPoint* point : Visited(toolpath.passes[i])) {
      const Eigen::Vector3d &p = point->position, &a = point->tool_axis;
      text += fmt::format("{},{},{:.6f},{:.6f},{:.6f},{:.9f},{:.9f},{:.9f},{}\n", i, first ? 1 : 0, p.x(),
                          p.y(), p.z(), a.x(), a.y(), a.z(), point->feed_rate);
      first = false;
    }
  }
  return text;
}

}  // namespace millpose
