// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Geometry>
#include <functional>

#include "toolpath/cam/gcode_block.hpp"

namespace millpose {

/// The programmable frame of SINUMERIK: TRANS, ROT (absolute) and ATRANS, AROT (on top of what is there).
class GcodeFrame {
 public:
  static bool IsFrameWord(std::string_view name);

  /// Takes a block that begins with one of the four; it may hold X, Y, Z alone. `unit` in mm, `value_of`
  /// gives a word's number. Throws InputError.
  void Take(const GcodeBlock& block, double unit, const std::function<double(const GcodeWord&)>& value_of);

  /// A zero offset (G54, …): its zero lies there in the workpiece frame (mm); the programmable frame stays.
  void SetOffset(const Eigen::Vector3d& offset) { offset_ = offset; }

  /// Heidenhain's G54 X Y Z: the datum lies there (mm).
  void Shift(const Eigen::Vector3d& datum) { frame_ = Eigen::Translation3d(datum); }

  Eigen::Vector3d ToBase(const Eigen::Vector3d& programmed) const { return offset_ + frame_ * programmed; }
  Eigen::Vector3d ToProgrammed(const Eigen::Vector3d& base) const {
    return frame_.inverse() * (base - offset_);
  }
  Eigen::Matrix3d linear() const { return frame_.linear(); }

 private:
  Eigen::Isometry3d frame_ = Eigen::Isometry3d::Identity();
  Eigen::Vector3d offset_ = Eigen::Vector3d::Zero();
};

}  // namespace millpose
