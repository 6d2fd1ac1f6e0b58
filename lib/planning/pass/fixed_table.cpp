// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/pass/fixed_table.hpp"

#include "base/units.hpp"
#include "planning/ladder/edge_kernel.hpp"
#include "planning/result/station.hpp"

namespace millpose {
namespace {

/// Where a rotation on a branch has come to along a piece.
struct AngleCourse {
  Joints first, last, least, most;
};

class TableMaker {
 public:
  TableMaker(const PoseProblem& problem, const FixedTableOptions& options)
      : problem_(problem), options_(options) {
    const Freedom& freedom = *problem.freedoms[0];
    const double range = freedom.Upper() - freedom.Lower();
    table_.rotations = static_cast<size_t>(std::max(1.0, std::ceil(range / options.rotation_step - 1e-9)));
    table_.first = freedom.Lower();
    table_.step = range / static_cast<double>(table_.rotations);
    table_.entries.resize(8 * table_.rotations);
    courses_.resize(table_.entries.size());
  }

  FixedTable Make(const PlannedIn& in, const PointFilter& counts) {
    const PassResult& pass = in.pass;
    int piece = -1;
    bool closed = false;
    MillingPoint first, last;  // of the piece
    for (size_t t = 0; t < pass.points.size(); ++t) {
      const PlannedPoint& planned = pass.points[t];
      if (planned.skip != Infeasibility::kNone) continue;
      const bool starts = planned.piece != piece;
      if (starts && piece >= 0) EndSegment(closed, last, first);
      MillingPoint point = in.StepPoint(t);
      if (starts) first = last = point;
      most_ = StepBound(options_.steps, problem_.arm, last, point);
      last = std::move(point);
      piece = planned.piece;
      closed = pass.pieces[static_cast<size_t>(piece)].closed;
      Add(PointScorer(in.At(t).problem, planned.point, pass.rotation_reference), starts, counts(planned));
    }
    if (piece >= 0) EndSegment(closed, last, first);
    for (FixedTable::Entry& entry : table_.entries)
      if (!entry.serves) entry.worst = entry.sum = 0;
    return std::move(table_);
  }

 private:
  /// Scores what still serves and nothing else: most rotations fail at one of the first points.
  void Add(const PointScorer& scorer, bool starts, bool counts) {
    ScoredBlock block;
    for (size_t r = 0; r < table_.rotations; r += kLanes) {
      const unsigned serving = ArmBranchesServing(r);
      if (serving == 0) continue;
      scorer.ScoreBlock(ValuesOfBlock(table_, r, problem_.freedoms.size()), serving, block);
      for (size_t l = 0; l < kLanes && r + l < table_.rotations; ++l) {
        for (int branch = 0; branch < 8; ++branch) {
          const bool admissible = block.obstacle[branch][l] == Infeasibility::kNone;
          FixedTable::Entry& entry = table_.entries[8 * (r + l) + static_cast<size_t>(branch)];
          entry.serves = entry.serves && admissible &&
                         Step(courses_[8 * (r + l) + static_cast<size_t>(branch)],
                              CandidateOf(block, branch, static_cast<int>(l)).q, starts);
          if (!entry.serves || !counts) continue;
          const double value = block.objective[branch].v[l];
          entry.worst = std::max(entry.worst, value);
          entry.sum += value;
        }
      }
    }
  }

  /// As ScoreBlock takes them: those on which some rotation of the block from r serves so far.
  unsigned ArmBranchesServing(size_t r) const {
    unsigned serving = 0;
    for (size_t k = 8 * r; k < std::min(8 * (r + kLanes), table_.entries.size()); ++k)
      if (table_.entries[k].serves) serving |= 1u << (k & 3);
    return serving;
  }

  /// Goes on to `q`, the short way round; false where a joint steps too far.
  bool Step(AngleCourse& course, const Joints& q, bool starts) const {
    if (starts) {
      course = {q, q, q, q};
      return true;
    }
    const Joints step = (q - course.last).unaryExpr(&WrapToPi);
    if ((step.cwiseAbs().array() > most_.array()).any()) return false;
    course.last += step;
    course.least = course.least.cwiseMin(course.last);
    course.most = course.most.cwiseMax(course.last);
    return true;
  }

  /// Full revolutions must bring the whole piece within the limits, and a closed one must close.
  void EndSegment(bool closed, const MillingPoint& last, const MillingPoint& first) {
    most_ = StepBound(options_.steps, problem_.arm, last, first);
    for (size_t k = 0; k < courses_.size(); ++k) {
      FixedTable::Entry& entry = table_.entries[k];
      if (!entry.serves) continue;
      if (closed) entry.serves = Step(courses_[k], courses_[k].first, false);
      for (int j = 0; j < 6 && entry.serves; ++j) entry.serves = FitsTurns(courses_[k], j);
    }
  }

  bool FitsTurns(const AngleCourse& course, int j) const {
    const AdmissibleBounds& bounds = problem_.bounds;
    for (int turns = -2; turns <= 2; ++turns) {
      const double shift = turns * 2 * kPi;
      if (course.least[j] + shift >= bounds.lower[j] - kRevolutionRounding &&
          course.most[j] + shift <= bounds.upper[j] + kRevolutionRounding)
        return true;
    }
    return false;
  }

  const PoseProblem& problem_;
  const FixedTableOptions& options_;
  FixedTable table_;
  Joints most_ = Joints::Zero();  ///< rad, of the step that is taken
  std::vector<AngleCourse> courses_;
};

}  // namespace

PlannedIn::PlannedIn(const Stations& stations, const PassResult& planned)
    : pass(planned), station(stations.At(planned.external)) {
  if (planned.points.empty() || !planned.points.front().external) return;
  std::vector<ExternalPosition> positions;
  for (size_t t = 0; t < planned.points.size(); ++t) positions.push_back(ExternalAt(planned, t));
  along = MakePlacesAlong(stations, positions);
}

Carrier PlannedIn::CarrierAt(size_t t) const {
  const PoseProblem& problem = At(t).problem;
  return {problem.arm, problem.X_WB, problem.X_FT};
}

MillingPoint PlannedIn::StepPoint(size_t t) const {
  return along.empty() ? pass.points[t].point : OnPart(along[t], pass.points[t].point);
}

FixedTable MakeFixedTable(const PlannedIn& planned, const PointFilter& counts,
                          const FixedTableOptions& options) {
  return TableMaker(planned.station.problem, options).Make(planned, counts);
}

std::vector<double> ValuesOfBlock(const FixedTable& table, size_t r, size_t dimensions) {
  std::vector<double> values(kLanes * dimensions, 0.0);
  for (size_t l = 0; l < kLanes; ++l)
    values[l * dimensions] = table.Rotation(std::min(r + l, table.rotations - 1));
  return values;
}

}  // namespace millpose
