// SPDX-License-Identifier: GPL-3.0-or-later
// The two ways to find a point's own optimum: the genetic algorithm, and the exhaustive search that judges
// it.
#pragma once

#include "base/random.hpp"
#include "pose/scorer.hpp"

namespace millpose {

/// A point's optimum as a search found it.
struct PointOptimum {
  bool found = false;
  Admissibility reason = Admissibility::kUnreachable;  ///< when not found: how far the best candidate came
  FreedomValues freedoms;
  int branch = 0;
  Joints q = Joints::Zero();
  double objective = 0;
  int evaluations = 0;  ///< objective evaluations spent (one per freedoms × arm branch looked at)
};

struct GeneticOptions {
  int population = 40;
  int generations = 30;
  double crossover_rate = 0.9;
  double mutation_rate = 0.2;
  int elite = 2;
  int max_evaluations = 2000;  ///< including the local refinement
};

struct GenerationRecord {
  double best, mean;  ///< objective over the admissible individuals of a generation
};

/// Chen 2021 section 5.2 over the freedoms: random start from `stream`, selection, crossover, mutation,
/// elitism, then a local refinement that can end exactly on the bound of an admissible interval. Never reads
/// the exhaustive search. `history`, when given, receives one record per generation.
PointOptimum GeneticSearch(const PointScorer& scorer, const PoseProblem& problem,
                           const GeneticOptions& options, RandomStream stream,
                           std::vector<GenerationRecord>* history = nullptr);

/// Grid of `step` (rad or mm) over every freedom, all branches. Along the first freedom each local optimum
/// that could still win is refined, and the ends of admissible intervals are reached exactly.
PointOptimum ExhaustiveSearch(const PointScorer& scorer, const PoseProblem& problem, double step);

}  // namespace millpose
