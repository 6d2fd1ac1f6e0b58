// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "toolpath/cam/apt_scanner.hpp"
#include "toolpath/cam/cam_path.hpp"

namespace millpose {

/// A system that comments state, for the coordinates behind them.
struct AptFrame {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();  ///< its axes in the part, as columns
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();        ///< in the part, file units
  std::string name;                                        ///< "CATIA0", "CSYS"
  SourceLocation place;
  bool IsIdentity() const { return rotation.isIdentity(1e-9) && origin.isZero(1e-9); }
  bool ReadsEitherWay() const;  ///< rows and columns of the axes are the same
};

/// Frames in the comments of CLDATA: CATIA's `$$*CATIA0` with an identifier and three rows of the matrix
/// [axes | origin] that leads from the machining system into the absolute one (one that turns the axes where
/// the job states it: which of rows and columns are the axes is not documented beyond doubt); Creo's `$$->
/// CSYS / 12 numbers`; and other comments that begin with a word for a system and go on with numbers (MCS,
/// MATRIX, …).
class AptComments {
 public:
  explicit AptComments(const CamReadOptions& options) : options_(options) {}
  /// The comments before a statement; the last frame of theirs. Throws InputError for a frame that is not
  /// read: one that is incomplete, no rotation, or of a sender whose meaning is not known, unless the job
  /// says that points stand as they are written (then there is none).
  std::optional<AptFrame> Take(const std::vector<AptWord>& comments);
  /// Whether the job's `frame` decided anything.
  bool used_key() const { return used_key_; }

 private:
  std::optional<AptFrame> TakeCatia(const std::vector<AptWord>& comments, size_t& at);
  std::optional<AptFrame> TakeOther(const std::vector<AptWord>& comments, size_t& at);
  std::optional<AptFrame> Decide(AptFrame frame, bool known);

  const CamReadOptions& options_;
  bool used_key_ = false;
};

}  // namespace millpose
