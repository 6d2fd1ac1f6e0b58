// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/stock/standing_stock.hpp"

#include <algorithm>
#include <cmath>

#include "base/parallel.hpp"

namespace millpose {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;

namespace {

constexpr size_t kBand = 16;                // rows that one thread works on at a time
constexpr double kSliver = 1e-7;            // mm: shorter spans are nothing
constexpr double kNoCut = 1e-9;             // mm: what cuts less is not worked out
constexpr double kBesideEdges = 0.4142135;  // of the spacing: lines run through no vertex of a round size

/// Where a surface crosses a line: out of the material or into it.
struct Crossing {
  size_t line;
  double along;
  int turn;  ///< +1 into the material, seen upwards
};

/// Twice the area of a triangle in the plane, counter-clockwise above 0.
double Area(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
  return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

}  // namespace

StandingStock::StandingStock(const Triangles& blank, double spacing, size_t most_lines, int along)
    : spacing_(spacing) {
  for (const auto& face : blank.faces)
    for (const int corner : face) box_.extend(blank.vertices[static_cast<size_t>(corner)]);
  if (box_.isEmpty()) return;
  const Vector3d size = box_.sizes();
  if (along < 0)
    size.minCoeff(&along_);
  else
    along_ = along;
  first_ = (along_ + 1) % 3, second_ = (along_ + 2) % 3;
  const double least = std::sqrt(size[first_] * size[second_] / static_cast<double>(most_lines));
  spacing_ = std::max(spacing, least);
  const auto count = [&](double length) { return static_cast<size_t>(std::ceil(length / spacing_)) + 1; };
  columns_ = count(size[first_]), rows_ = count(size[second_]);
  origin_ = box_.min();
  origin_[along_] = 0;
  origin_[first_] -= spacing_ * kBesideEdges;
  origin_[second_] -= spacing_ * kBesideEdges;
  Fill(blank);
}

StandingStock::StandingStock(const Triangles& body, const StandingStock& beside)
    : box_(beside.box_),
      spacing_(beside.spacing_),
      along_(beside.along_),
      first_(beside.first_),
      second_(beside.second_),
      origin_(beside.origin_),
      rows_(beside.rows_),
      columns_(beside.columns_) {
  Fill(body);
}

void StandingStock::Fill(const Triangles& blank) {
  std::vector<Crossing> crossings;
  for (const auto& face : blank.faces) {
    std::array<Eigen::Vector2d, 3> flat;
    Eigen::AlignedBox2d around;
    Vector3d heights;
    for (size_t k = 0; k < 3; ++k) {
      const Vector3d& corner = blank.vertices[static_cast<size_t>(face[k])];
      flat[k] =
          Eigen::Vector2d(corner[first_] - origin_[first_], corner[second_] - origin_[second_]) / spacing_;
      heights[static_cast<Eigen::Index>(k)] = corner[along_];
      around.extend(flat[k]);
    }
    const double area = Area(flat[0], flat[1], flat[2]);
    if (area == 0) continue;
    const auto last_row = std::min<double>(std::floor(around.max().y()), static_cast<double>(rows_) - 1);
    const auto last_column =
        std::min<double>(std::floor(around.max().x()), static_cast<double>(columns_) - 1);
    for (double row = std::max(0.0, std::ceil(around.min().y())); row <= last_row; ++row)
      for (double column = std::max(0.0, std::ceil(around.min().x())); column <= last_column; ++column) {
        const Eigen::Vector2d at(column, row);
        const Vector3d parts =
            Vector3d(Area(at, flat[1], flat[2]), Area(at, flat[2], flat[0]), Area(at, flat[0], flat[1])) /
            area;
        if (parts.minCoeff() < 0) continue;
        crossings.push_back({static_cast<size_t>(row) * columns_ + static_cast<size_t>(column),
                             parts.dot(heights) / parts.sum(), area < 0 ? 1 : -1});
      }
  }
  std::ranges::sort(crossings, [](const Crossing& a, const Crossing& b) {
    return std::tie(a.line, a.along, a.turn) < std::tie(b.line, b.along, b.turn);
  });

  first_nodes_.resize(rows_ * columns_);
  further_.resize((rows_ + kBand - 1) / kBand);
  for (size_t at = 0; at < crossings.size();) {
    const size_t line = crossings[at].line, begin = at;
    std::vector<Span> spans;
    int depth = 0;
    bool closed = true;
    for (; at < crossings.size() && crossings[at].line == line; ++at) {
      if (depth == 0) spans.push_back({crossings[at].along, crossings[at].along});
      depth += crossings[at].turn;
      closed = closed && depth >= 0;
      spans.back().high = crossings[at].along;
    }
    if (!closed || depth != 0) spans = {{crossings[begin].along, crossings[at - 1].along}};
    std::erase_if(spans, [](const Span& span) { return span.high - span.low < kSliver; });
    Nodes& further = further_[line / columns_ / kBand];
    Node* node = nullptr;
    for (const Span& span : spans) {
      if (!node) {
        node = &first_nodes_[line];
      } else {
        node->next = static_cast<int32_t>(further.size());
        further.emplace_back();
        node = &further.back();
      }
      node->low = span.low, node->high = span.high;
    }
  }
  Sum({0, rows_, 0, columns_});
}

Vector3d StandingStock::Place(size_t i, size_t j, double along) const {
  Vector3d place = origin_;
  place[first_] += static_cast<double>(j) * spacing_;
  place[second_] += static_cast<double>(i) * spacing_;
  place[along_] = along;
  return place;
}

void StandingStock::Take(size_t line, const Span& off, Nodes& further) {
  Node* node = &first_nodes_[line];
  for (;;) {
    const int32_t next = node->next;
    if (!node->empty() && off.low < node->high && off.high > node->low) {
      const bool below = off.low - node->low >= kSliver, above = node->high - off.high >= kSliver;
      if (below && above) {
        const double high = node->high;
        node->high = off.low;
        node->next = static_cast<int32_t>(further.size());
        further.push_back({off.high, high, next});  // node may dangle now
      } else if (below) {
        node->high = off.low;
      } else if (above) {
        node->low = off.high;
      } else {
        node->low = 0, node->high = -1;
      }
    }
    if (next < 0) return;
    node = &further[static_cast<size_t>(next)];
  }
}

StandingStock::Window StandingStock::WindowOf(const AlignedBox3d& box) const {
  if (!box.intersects(box_)) return {};
  const auto range = [&](int axis, size_t count) {
    const double from = std::ceil((box.min()[axis] - origin_[axis]) / spacing_),
                 to = std::floor((box.max()[axis] - origin_[axis]) / spacing_);
    const auto first = static_cast<size_t>(std::clamp(from, 0.0, static_cast<double>(count)));
    return std::pair(first, to < 0 ? size_t{0} : std::min(static_cast<size_t>(to) + 1, count));
  };
  const auto [row, end_row] = range(second_, rows_);
  const auto [column, end_column] = range(first_, columns_);
  return {row, end_row, column, end_column};
}

bool StandingStock::StandsIn(const Span& part, const Node& first, const Nodes& further) {
  for (const Node* node = &first; node;
       node = node->next < 0 ? nullptr : &further[static_cast<size_t>(node->next)])
    if (!node->empty() && node->low < part.high - kNoCut && node->high > part.low + kNoCut) return true;
  return false;
}

void StandingStock::RemoveIn(size_t first_row, size_t end_row, std::span<const SweptVolume> volumes,
                             Nodes& further) {
  const Vector3d direction = Vector3d::Unit(along_);
  for (const SweptVolume& volume : volumes) {
    const Window window = WindowOf(volume.box());
    const Span around{volume.box().min()[along_], volume.box().max()[along_]};
    for (size_t i = std::max(window.row, first_row); i < std::min(window.end_row, end_row); ++i)
      for (size_t j = window.column; j < window.end_column; ++j) {
        const size_t line = i * columns_ + j;
        // Neighbouring motions overlap: most of what a motion passes over is gone already. The box asks for
        // less than its planes do.
        if (!StandsIn(around, first_nodes_[line], further)) continue;
        const Vector3d place = Place(i, j, 0);
        if (!StandsIn(volume.BetweenPlanes(place, direction), first_nodes_[line], further)) continue;
        if (const auto off = volume.On(place, direction)) Take(line, *off, further);
      }
  }
}

void StandingStock::Remove(const CutterShape& cutter, std::span<const CutterMotion> motions, int threads,
                           std::stop_token stop) {
  const CutterProfile profile(cutter, spacing_ / 100);
  std::vector<SweptVolume> volumes;
  AlignedBox3d around;
  for (const CutterMotion& motion : motions)
    for (const CutterMotion& part : WithoutTurns(motion, cutter.length, spacing_ / 4)) {
      volumes.emplace_back(profile, part.from.tip, part.to.tip, part.from.axis);
      around.extend(volumes.back().box());
    }
  if (volumes.empty()) return;
  ParallelFor(further_.size(), threads, std::move(stop), [&](size_t band) {
    RemoveIn(band * kBand, std::min((band + 1) * kBand, rows_), volumes, further_[band]);
  });
  Sum(WindowOf(around));
}

void StandingStock::Sum(const Window& lines) {
  if (levels_.empty())
    for (size_t rows = rows_, columns = columns_;; rows = (rows + 1) / 2, columns = (columns + 1) / 2) {
      levels_.push_back({rows, columns, std::vector<Span>(rows * columns, Span{0, -1})});
      if (rows * columns <= 1) break;
    }
  const auto add = [](const Span& part, Span& all) {
    if (part.high < part.low) return;
    all = all.high < all.low ? part : Span{std::min(all.low, part.low), std::max(all.high, part.high)};
  };
  for (size_t i = lines.row; i < lines.end_row; ++i)
    for (size_t j = lines.column; j < lines.end_column; ++j) {
      const size_t line = i * columns_ + j;
      Span all{0, -1};
      const Nodes& further = further_[i / kBand];
      for (const Node* node = &first_nodes_[line]; node;
           node = node->next < 0 ? nullptr : &further[static_cast<size_t>(node->next)])
        add({node->low, node->high}, all);
      levels_.front().spans[line] = all;
    }
  Window window = lines;
  for (size_t k = 1; k < levels_.size(); ++k) {
    const Level& below = levels_[k - 1];
    Level& here = levels_[k];
    window = {window.row / 2, (window.end_row + 1) / 2, window.column / 2, (window.end_column + 1) / 2};
    for (size_t i = window.row; i < window.end_row; ++i)
      for (size_t j = window.column; j < window.end_column; ++j) {
        Span all{0, -1};
        for (size_t row = 2 * i; row < std::min(2 * i + 2, below.rows); ++row)
          for (size_t column = 2 * j; column < std::min(2 * j + 2, below.columns); ++column)
            add(below.spans[row * below.columns + column], all);
        here.spans[i * here.columns + j] = all;
      }
  }
}

bool StandingStock::Meets(const std::function<bool(const AlignedBox3d&)>& may) const {
  return !levels_.empty() && !levels_.back().spans.empty() && Meets(levels_.size() - 1, 0, 0, may);
}

bool StandingStock::Meets(size_t level, size_t i, size_t j,
                          const std::function<bool(const AlignedBox3d&)>& may) const {
  const Level& here = levels_[level];
  const Span& span = here.spans[i * here.columns + j];
  if (span.high < span.low) return false;
  const size_t wide = size_t{1} << level;
  const AlignedBox3d around(
      Place(i * wide, j * wide, span.low),
      Place(std::min((i + 1) * wide, rows_) - 1, std::min((j + 1) * wide, columns_) - 1, span.high));
  if (!may(around)) return false;
  if (level > 0) {
    const Level& below = levels_[level - 1];
    for (size_t row = 2 * i; row < std::min(2 * i + 2, below.rows); ++row)
      for (size_t column = 2 * j; column < std::min(2 * j + 2, below.columns); ++column)
        if (Meets(level - 1, row, column, may)) return true;
    return false;
  }
  const size_t line = i * columns_ + j;
  const Nodes& further = further_[i / kBand];
  for (const Node* node = &first_nodes_[line]; node;
       node = node->next < 0 ? nullptr : &further[static_cast<size_t>(node->next)])
    if (!node->empty() && may({Place(i, j, node->low), Place(i, j, node->high)})) return true;
  return false;
}

void StandingStock::ForEachSpan(const std::function<void(const Vector3d&, const Vector3d&)>& visit) const {
  for (size_t line = 0; line < first_nodes_.size(); ++line) {
    const size_t i = line / columns_, j = line % columns_;
    const Nodes& further = further_[i / kBand];
    for (const Node* node = &first_nodes_[line]; node;
         node = node->next < 0 ? nullptr : &further[static_cast<size_t>(node->next)])
      if (!node->empty()) visit(Place(i, j, node->low), Place(i, j, node->high));
  }
}

double StandingStock::Volume() const {
  double length = 0;
  for (const Node& node : first_nodes_)
    if (!node.empty()) length += node.high - node.low;
  for (const Nodes& further : further_)
    for (const Node& node : further)
      if (!node.empty()) length += node.high - node.low;
  return length * spacing_ * spacing_;
}

}  // namespace millpose
