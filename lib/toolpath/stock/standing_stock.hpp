// SPDX-License-Identifier: GPL-3.0-or-later
// The material as it stands, from the blank to what milling leaves of it (docs/stock.md).
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <stop_token>

#include "geometry/mesh/triangles.hpp"
#include "toolpath/stock/swept_span.hpp"

namespace millpose {

/// Material as spans along parallel lines ("dexels") on a square lattice across an axis, the shortest side of
/// the blank unless another is asked for. Exact along the lines, to 1e-9 mm and the cutter's chords; beside
/// them it is not known farther than half the lattice's spacing along either of its axes. Frame P, mm.
class StandingStock {
 public:
  /// A blank that triangles bound; the lattice has `spacing` (mm), more where the blank would take more than
  /// `most_lines`. On lines where its surface is not closed all from its first to its last meeting is
  /// material. `along`: the axis of the lines, 0 to 2; −1: the shortest side.
  StandingStock(const Triangles& blank, double spacing, size_t most_lines = 4'000'000, int along = -1);

  /// A body on the lines of another; what lies beside them is not there.
  StandingStock(const Triangles& body, const StandingStock& beside);

  /// Takes off what the cutter sweeps, with its cutting length; the order of the motions does not matter.
  /// Axes that turn do so in steps that move no point of the cutter by more than a quarter of the spacing.
  void Remove(const CutterShape& cutter, std::span<const CutterMotion> motions, int threads,
              std::stop_token stop = {});

  /// Whether any material is where `may` is true: it is asked about boxes around lines and, in the end, about
  /// the spans, boxes without width, and must be true for a box that holds one for which it is.
  bool Meets(const std::function<bool(const Eigen::AlignedBox3d&)>& may) const;

  /// Calls `visit` with both ends of each span of material, line by line.
  void ForEachSpan(const std::function<void(const Eigen::Vector3d&, const Eigen::Vector3d&)>& visit) const;

  /// mm³: the spans' length × spacing².
  double Volume() const;

  /// By line, row by row: from its lowest to its highest material, mm; high < low where none stands.
  const std::vector<Span>& Ends() const { return levels_.front().spans; }
  /// On the line of row `i` and column `j`, at `along` of its axis.
  Eigen::Vector3d Place(size_t i, size_t j, double along) const;

  size_t rows() const { return rows_; }
  size_t columns() const { return columns_; }
  int along() const {
    return along_;
  }  ///< the axis of the lines: 0 to 2; columns lie along the next, rows along the one after
  double spacing() const { return spacing_; }
  const Eigen::AlignedBox3d& box() const { return box_; }  ///< of the blank

 private:
  /// A span of a line and the next one of it; the first of each stands at the line's own number.
  struct Node {
    double low = 0, high = -1;
    int32_t next = -1;

    bool empty() const { return high < low; }
  };
  using Nodes = std::vector<Node>;

  void Fill(const Triangles& blank);
  void Take(size_t line, const Span& off, Nodes& further);
  /// Rows and columns of the lattice, each from its first to before its end.
  struct Window {
    size_t row = 0, end_row = 0, column = 0, end_column = 0;
  };
  /// The lines that may meet a box.
  Window WindowOf(const Eigen::AlignedBox3d& box) const;
  /// Whether a line has material between two heights; `first`: its first span.
  static bool StandsIn(const Span& part, const Node& first, const Nodes& further);
  void RemoveIn(size_t first_row, size_t end_row, std::span<const SweptVolume> volumes, Nodes& further);
  /// Brings `levels_` up to date where lines in a window have changed.
  void Sum(const Window& lines);
  bool Meets(size_t level, size_t i, size_t j,
             const std::function<bool(const Eigen::AlignedBox3d&)>& may) const;

  Eigen::AlignedBox3d box_;
  double spacing_;
  int along_ = 2, first_ = 0, second_ = 1;  ///< axes: of the lines, and of the lattice
  Eigen::Vector3d origin_;                  ///< the lattice's first place, 0 along the lines
  size_t rows_ = 0, columns_ = 0;           ///< along `second_` and `first_`
  Nodes first_nodes_;                       ///< by line: row × columns_ + column
  std::vector<Nodes> further_;              ///< by band of rows
  /// From the lines up, each a quarter of the one before: from where to where material stands.
  struct Level {
    size_t rows, columns;
    std::vector<Span> spans;
  };
  std::vector<Level> levels_;
};

}  // namespace millpose
