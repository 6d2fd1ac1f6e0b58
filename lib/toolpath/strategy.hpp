// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "geometry/slice/curve.hpp"
#include "toolpath/cam/cam_source.hpp"
#include "toolpath/milling_point.hpp"
#include "toolpath/toolpath_options.hpp"

namespace millpose {

/// The curves of one plane, radius or contour, milled one after the other.
struct CurveGroup {
  std::vector<Curve> curves;  ///< on the mesh
  /// What grows along the lane: parts that the region cuts off are milled in ascending order of it. Empty: in
  /// the order of `curves`.
  std::function<double(const Eigen::Vector3d&)> progress;
  /// What grows from lane to lane, from milled to unmilled: tells climb from conventional milling. Empty
  /// where a lane has no neighbours.
  std::function<double(const Eigen::Vector3d&)> advance;
  bool backwards = false;  ///< in a zigzag: against the curves' direction; closed passes keep theirs
  bool clipped = false;    ///< the curves lie in the region as they are
  bool oriented = false;   ///< the curves run as climb or conventional asks for
  RingOpening opening = RingOpening::kNone;  ///< of its closed passes
};

/// What a strategy makes of a region.
struct Layout {
  std::vector<CurveGroup> lanes;  ///< in the order of milling
  /// Of a plane region: the normal of all its points. Else they have the surface's, which near a fillet lean
  /// towards it.
  std::optional<Eigen::Vector3d> normal;
  std::vector<std::string> notes;  ///< what the user should know, one sentence each
};

/// Throws InputError for what is no unit vector; `what`: "the rings' axis".
void RequireUnit(const Eigen::Vector3d& direction, std::string_view what);

/// Material as columns about parallel lines (toolpath/stock).
struct StandingColumns {
  double spacing = 0;                                     ///< of the lines, mm: how wide a column is
  std::vector<std::array<Eigen::Vector3d, 2>> columns{};  ///< from where to where, mm
};

/// What a strategy makes passes from.
struct StrategyInputs {
  const Mesh& mesh;  ///< without a face where the job names no part
  const ToolpathOptions& options;
  std::string_view file;                   ///< bytes of File()
  const StandingColumns* stock = nullptr;  ///< what stands before the first pass, where NeedsStock(); in P
  int threads = 1;                         ///< that Make() may use; they change nothing of what it makes
};

struct LaidPath {
  Toolpath toolpath;                        ///< in P
  std::vector<std::string> warnings;        ///< what the user should know, one sentence each
  std::vector<std::string> findings;        ///< what is not milled as asked for, one sentence each
  std::vector<std::string> notes;           ///< how a file was read
  std::vector<std::string> holes_left_out;  ///< of a file's cycles: not machined, one sentence each
  std::optional<CamSource> source;          ///< of a file: who wrote it, and how it was taken
  std::optional<double> spindle_speed;      ///< that the file asks for, rev/s
};

/// Where passes come from, with the options that are its own. An implementation is one file, which ends with
/// its StrategyEntry (strategy_entry.hpp), and its name in strategy.cpp.
class Strategy {
 public:
  virtual ~Strategy() = default;
  virtual std::string Name() const = 0;
  /// The file that the passes come from, relative to the job. Empty: they are laid on the part, which must be
  /// given.
  virtual std::string File() const { return {}; }
  /// Whether the job must name a part.
  virtual bool NeedsPart() const { return File().empty(); }
  /// Whether the passes follow from the material that stands: the job must give workpiece.stock, and what is
  /// known of the cut comes from there (process.stock: mesh).
  virtual bool NeedsStock() const { return false; }
  /// The user states the line itself: no step-over, and passes run the way they are given.
  virtual bool IsPrescribed() const { return false; }
  /// Whether the force of milling a surface (process.cutting) says something of it.
  virtual bool HasMillingForce() const { return true; }
  /// Whether points have the normal of an edge, along which the side of the cutter mills: then it does say
  /// something where the material that stands is known (process.stock: mesh).
  virtual bool MillsWithSide() const { return false; }
  /// Of a tool that cuts with its point, straight down its axis, the angle of that, rad: then the force of a
  /// drill says something of it. None: it mills, or what it meets does not follow from the options.
  virtual std::optional<double> DrillPoint() const { return std::nullopt; }
  /// Whether the tool cuts on its way in, so that the plunge feed is the feed of its cuts.
  virtual bool CutsAtPlungeFeed() const { return false; }
  /// Objective where the job names none; empty: that of all jobs.
  virtual std::string DefaultObjective() const { return {}; }
  /// s that the tool stands where a pass turns back for the last time.
  virtual double Dwell() const { return 0; }
  /// Keys of `toolpath` that change nothing with it as its options stand: a job that gives one is refused.
  virtual std::vector<std::string> WithoutEffect() const { return {}; }
  /// Of a file for several tools or speeds its sections, where the strategy reads such. Throws InputError.
  virtual std::vector<CamSection> Sections(const StrategyInputs&) const { return {}; }
  /// Throws InputError; Interrupted.
  virtual LaidPath Make(const StrategyInputs& inputs, std::stop_token stop) const = 0;
};

/// A way to cover a region of the part with curves.
class SurfaceStrategy : public Strategy {
 public:
  LaidPath Make(const StrategyInputs& inputs, std::stop_token stop) const override;
  /// Throws InputError for a region that the strategy cannot cover; Interrupted.
  virtual Layout Lay(const Region& region, const ToolpathOptions& options, std::stop_token stop) const = 0;
  /// What is kept from rims and from faces that are out, mm.
  virtual double RimDistance(const ToolpathOptions& options) const { return options.region.rim_distance; }
  /// Neighbouring passes are a step-over apart everywhere: their number follows from the region's area.
  virtual bool IsLaidFromBorders() const { return false; }
  /// Passes are as near to each other as `scallop_mm` asks for.
  virtual bool IsLaidByScallop() const { return false; }
};

}  // namespace millpose
