// SPDX-License-Identifier: GPL-3.0-or-later
// The ways to find a point's own optimum: the genetic algorithm, the refinement of a table, and the
// exhaustive search that judges both.
#pragma once

#include <limits>

#include "base/random.hpp"
#include "planning/pose/candidate_table.hpp"

namespace millpose {

/// A point's optimum as a search found it.
struct PointOptimum {
  bool found = false;
  Infeasibility reason = Infeasibility::kUnreachable;  ///< when not found: how far the best candidate came
  FreedomValues freedoms;
  int branch = 0;
  Joints q = Joints::Zero();
  double objective = 0;
  int evaluations = 0;  ///< objective evaluations spent (one per freedoms × arm branch looked at)
};

struct GeneticOptions {
  int table = 96;  ///< settings of the coarse table that the first population is chosen from; 0: at random
  int population = 16;  ///< for each freedom
  int generations = 6;  ///< for each freedom
  double crossover_rate = 0.9;
  double mutation_rate = 0.2;
  int elite = 2;
  int max_evaluations = 2000;  ///< including the local refinement
};

struct GenerationRecord {
  int admissible = 0;         ///< individuals of a generation
  double best = 0, mean = 0;  ///< objective over these; 0 where there is none
};

/// Chen 2021 section 5.2 over the freedoms: selection, crossover, mutation, elitism, then a local refinement
/// that can end exactly on the bound of an admissible interval. Half of the first population are the best
/// places of a coarse table, the rest is drawn from `stream` (decision 50). Never reads a finer table than
/// that. `history`, when given, receives one record per generation.
PointOptimum GeneticSearch(const PointScorer& scorer, const PoseProblem& problem,
                           const GeneticOptions& options, RandomStream stream,
                           std::vector<GenerationRecord>* history = nullptr);

/// The best of a table of the scorer's point: along the first freedom each local optimum that could still win
/// is refined, and the ends of admissible intervals are reached exactly.
PointOptimum RefineTable(const PointScorer& scorer, const CandidateTable& table);

/// The same on a table of `step` (rad or mm); fine enough it judges the others.
PointOptimum ExhaustiveSearch(const PointScorer& scorer, double step);

/// The nearest local optimum from an admissible place on its branch, in all freedoms together, with no more
/// than `max_evaluations` in all.
PointOptimum Descend(const PointScorer& scorer, PointOptimum from,
                     int max_evaluations = std::numeric_limits<int>::max());

/// The least of the local optima that a table's best places lead to; for several freedoms.
PointOptimum DescendTable(const PointScorer& scorer, const CandidateTable& table);

}  // namespace millpose
