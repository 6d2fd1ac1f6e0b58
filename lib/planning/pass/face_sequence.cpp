// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/pass/face_sequence.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <tuple>

namespace millpose {
namespace {

constexpr double kRoundingOfSteps = 1 + 1e-9;
constexpr double kNever = std::numeric_limits<double>::infinity();

/// A point that leaves the face, and the piece that cuts it.
struct CutPlace {
  size_t pass = 0, piece = 0;
  const MillingPoint* point = nullptr;
  double spacing = 0;  ///< mm, to its farther neighbour in the piece
};

std::vector<CutPlace> CutPlacesOf(const std::vector<PassResult>& passes, size_t first) {
  std::vector<CutPlace> places;
  for (size_t i = first; i < passes.size(); ++i) {
    const PassResult& pass = passes[i];
    for (size_t k = 0; k < pass.pieces.size(); ++k) {
      const auto from = static_cast<size_t>(pass.pieces[k].first),
                 to = static_cast<size_t>(pass.pieces[k].last);
      for (size_t t = from; t <= to; ++t) {
        const MillingPoint& point = pass.points[t].point;
        if (point.kind != PointKind::kCut || point.engagement.side == CutSide::kAir) continue;
        const auto way = [&](size_t u) { return (pass.points[u].point.position - point.position).norm(); };
        places.push_back({i, k, &point, std::max(t > from ? way(t - 1) : 0, t < to ? way(t + 1) : 0)});
      }
    }
  }
  return places;
}

using GridCell = std::array<long, 3>;

GridCell CellAt(const Eigen::Vector3d& position, double width) {
  const Eigen::Vector3d at = (position / width).array().floor();
  return {std::lround(at.x()), std::lround(at.y()), std::lround(at.z())};
}

double StepOf(const PassFace& a, size_t piece, const PassFace& b, size_t other) {
  if (piece >= a.size() || other >= b.size() || a[piece].count == 0 || b[other].count == 0) return 0;
  return std::abs(a[piece].middle - b[other].middle);
}

double WorstOf(const PassFace& face) {
  double worst = 0;
  for (const FaceChoiceFigures& piece : face) worst = std::max(worst, piece.worst);
  return worst;
}

double MarksOf(const PassFace& face) {
  double marks = 0;
  for (const FaceChoiceFigures& piece : face) marks += piece.marks;
  return marks;
}

}  // namespace

std::vector<NeighbourPieces> FindNeighbourPieces(const std::vector<PassResult>& passes, size_t first,
                                                 double width) {
  const std::vector<CutPlace> places = CutPlacesOf(passes, first);
  std::map<GridCell, std::vector<size_t>> grid;
  for (size_t i = 0; i < places.size(); ++i) grid[CellAt(places[i].point->position, width)].push_back(i);
  std::set<std::tuple<size_t, size_t, size_t, size_t>> pairs;
  for (const CutPlace& place : places) {
    const MillingPoint& point = *place.point;
    const Eigen::Vector3d across = point.normal.cross(point.feed);
    std::array<double, 2> nearest{width, width};
    std::array<const CutPlace*, 2> beside{};
    const GridCell at = CellAt(point.position, width);
    for (long x = at[0] - 1; x <= at[0] + 1; ++x)
      for (long y = at[1] - 1; y <= at[1] + 1; ++y)
        for (long z = at[2] - 1; z <= at[2] + 1; ++z) {
          const auto found = grid.find({x, y, z});
          if (found == grid.end()) continue;
          for (const size_t i : found->second) {
            const CutPlace& other = places[i];
            if (other.pass == place.pass) continue;
            const Eigen::Vector3d way = other.point->position - point.position;
            if (std::abs(way.dot(point.feed)) > std::max(place.spacing, other.spacing)) continue;
            const double aside = way.dot(across);
            const size_t side = aside < 0 ? 0 : 1;
            if (std::abs(aside) >= nearest[side] || std::abs(way.dot(point.normal)) > width) continue;
            nearest[side] = std::abs(aside);
            beside[side] = &other;
          }
        }
    for (const CutPlace* other : beside) {
      if (other == nullptr) continue;
      const std::pair a(place.pass, place.piece), b(other->pass, other->piece);
      const auto& [low, high] = std::minmax(a, b);
      pairs.emplace(low.first, low.second, high.first, high.second);
    }
  }
  std::vector<NeighbourPieces> neighbours;
  for (const auto& [pass, piece, other_pass, other_piece] : pairs)
    neighbours.push_back({pass, piece, other_pass, other_piece});
  return neighbours;
}

JobFace ValueOf(const std::vector<const PassFace*>& faces, const std::vector<NeighbourPieces>& neighbours) {
  JobFace value;
  for (const PassFace* face : faces) {
    value.worst = std::max(value.worst, WorstOf(*face));
    value.marks += MarksOf(*face);
  }
  for (const NeighbourPieces& pair : neighbours)
    value.step = std::max(value.step,
                          StepOf(*faces[pair.pass], pair.piece, *faces[pair.other_pass], pair.other_piece));
  return value;
}

bool IsBetter(const JobFace& a, const JobFace& b, double limit) {
  const double largest_a = std::max(a.Largest(), limit), largest_b = std::max(b.Largest(), limit);
  if (largest_a * kRoundingOfSteps < largest_b) return true;
  if (largest_b * kRoundingOfSteps < largest_a) return false;
  return a.marks < b.marks;
}

std::vector<size_t> ChooseSequence(const std::vector<std::vector<PassFace>>& candidates,
                                   const std::vector<NeighbourPieces>& neighbours, double limit) {
  const size_t count = candidates.size();
  std::vector<std::vector<NeighbourPieces>> before(count);  // pairs of the pass with the one before it
  for (const NeighbourPieces& pair : neighbours)
    if (pair.other_pass == pair.pass + 1) before[pair.other_pass].push_back(pair);
  const auto step = [&](size_t i, size_t from, size_t to) {
    double largest = 0;
    for (const NeighbourPieces& pair : before[i])
      largest =
          std::max(largest, StepOf(candidates[i - 1][from], pair.piece, candidates[i][to], pair.other_piece));
    return largest;
  };
  // The least largest value first, then the least marks beneath it.
  double bound = limit;
  std::vector<std::vector<size_t>> came_from(count);
  std::vector<double> values, last;
  for (const bool marks : {false, true}) {
    last.clear();
    for (size_t i = 0; i < count; ++i) {
      values.assign(candidates[i].size(), kNever);
      came_from[i].assign(candidates[i].size(), 0);
      for (size_t c = 0; c < candidates[i].size(); ++c) {
        const double worst = WorstOf(candidates[i][c]);
        if (marks && worst > bound * kRoundingOfSteps) continue;
        const double own = marks ? MarksOf(candidates[i][c]) : worst;
        if (i == 0) values[c] = own;
        for (size_t p = 0; p < last.size(); ++p) {
          if (last[p] == kNever) continue;
          const double between = step(i, p, c);
          if (marks && between > bound * kRoundingOfSteps) continue;
          const double value = marks ? last[p] + own : std::max({last[p], own, between});
          if (value >= values[c]) continue;
          values[c] = value;
          came_from[i][c] = p;
        }
      }
      if (std::ranges::find_if(values, [](double value) { return value < kNever; }) == values.end())
        return {};
      last = values;
    }
    if (!marks && !last.empty()) bound = std::max(bound, *std::ranges::min_element(last));
  }
  std::vector<size_t> chosen(count, 0);
  if (count == 0) return chosen;
  chosen[count - 1] = static_cast<size_t>(std::ranges::min_element(last) - last.begin());
  for (size_t i = count - 1; i > 0; --i) chosen[i - 1] = came_from[i][chosen[i]];
  return chosen;
}

}  // namespace millpose
