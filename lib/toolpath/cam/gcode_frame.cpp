// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/cam/gcode_frame.hpp"

#include "base/trig.hpp"
#include "base/units.hpp"

namespace millpose {
namespace {

Eigen::Matrix3d AboutAxis(int axis, double angle) {
  const SineCosine turn = SinCos(angle);
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  rotation(u, u) = rotation(v, v) = turn.cos;
  rotation(v, u) = turn.sin;
  rotation(u, v) = -turn.sin;
  return rotation;
}

}  // namespace

bool GcodeFrame::IsFrameWord(std::string_view name) {
  return name == "TRANS" || name == "ATRANS" || name == "ROT" || name == "AROT";
}

void GcodeFrame::Take(const GcodeBlock& block, double unit,
                      const std::function<double(const GcodeWord&)>& value_of) {
  const std::string& name = block.words[0].address;
  const bool turns = name.ends_with("ROT"), adds = name.starts_with('A');
  Eigen::Vector3d values = Eigen::Vector3d::Zero();
  for (size_t i = 1; i < block.words.size(); ++i) {
    const GcodeWord& word = block.words[i];
    const size_t axis = std::string_view("XYZ").find(word.address);
    if (word.address.size() != 1 || axis == std::string_view::npos)
      throw InputError(word.place,
                       fmt::format("{} takes X, Y and Z alone, found \"{}\"", name, word.address));
    const double value = value_of(word);
    if (!(std::abs(value) <= 1e7)) throw InputError(word.place, "a frame beyond ±1e7 mm or degrees");
    values[static_cast<int>(axis)] = turns ? DegToRad(std::fmod(value, 360.0)) : unit * value;
  }
  Eigen::Isometry3d step = Eigen::Isometry3d::Identity();
  if (turns) {  // roll-pitch-yaw: about Z, then the new Y, then the new X
    step.linear() = AboutAxis(2, values.z()) * AboutAxis(1, values.y()) * AboutAxis(0, values.x());
  } else {
    step.translation() = values;
  }
  frame_ = adds ? frame_ * step : step;
}

}  // namespace millpose
