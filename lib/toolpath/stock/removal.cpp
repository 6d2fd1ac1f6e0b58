// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/stock/removal.hpp"

namespace millpose {
namespace {

constexpr double kTold = 1.0 / 500;  // of the blank's thickness

bool Differ(const Span& a, const Span& b, double by) {
  const bool none = a.high < a.low, other_none = b.high < b.low;
  if (none || other_none) return none != other_none;
  return std::abs(a.low - b.low) > by || std::abs(a.high - b.high) > by;
}

}  // namespace

int AxisOfLines(std::span<const TimedMotion> motions) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const TimedMotion& one : motions) sum += one.motion.from.axis.cwiseAbs();
  int along = 0;
  sum.maxCoeff(&along);
  return along;
}

Removal WatchRemoval(StandingStock stock, const Triangles& part, const CutterShape& cutter,
                     std::span<const TimedMotion> motions, size_t most_frames, int threads,
                     std::stop_token stop) {
  Removal removal;
  removal.along = stock.along();
  removal.spacing = stock.spacing();
  removal.rows = stock.rows(), removal.columns = stock.columns();
  if (stock.rows() == 0) return removal;
  removal.origin = stock.Place(0, 0, 0);
  removal.volume = stock.Volume();
  removal.blank = stock.Ends();
  removal.part = StandingStock(part, stock).Ends();
  const double told = kTold * stock.box().sizes()[stock.along()];
  std::vector<Span> shown = stock.Ends();
  const size_t together = std::max<size_t>(1, (motions.size() + most_frames - 1) / most_frames);
  for (size_t first = 0; first < motions.size(); first += together) {
    const size_t end = std::min(motions.size(), first + together);
    std::vector<CutterMotion> cuts;
    for (size_t i = first; i < end; ++i) cuts.push_back(motions[i].motion);
    stock.Remove(cutter, cuts, threads, stop);
    Removal::Frame frame{motions[end - 1].until, stock.Volume(), 0};
    for (size_t line = 0; line < shown.size(); ++line) {
      const Span& now = stock.Ends()[line];
      if (!Differ(now, shown[line], end < motions.size() ? told : 0)) continue;
      shown[line] = now;
      removal.lines.push_back(static_cast<uint32_t>(line));
      removal.ends.push_back(now);
      ++frame.changed;
    }
    removal.frames.push_back(frame);
  }
  return removal;
}

}  // namespace millpose
