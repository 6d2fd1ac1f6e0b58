// SPDX-License-Identifier: GPL-3.0-or-later
// A point's optimum and the ladder search: scorer per candidate, both searches per point, the dynamic
// program against a plain dense one on 1,000 layers of 500 nodes.
#include <benchmark/benchmark.h>

#include <Eigen/SparseCholesky>

#include "planning/ladder/block_kernel.hpp"
#include "planning/ladder/ladder_search.hpp"
#include "planning/ladder/table_layer.hpp"
#include "planning/smoothing/envelope.hpp"
#include "tests/planning/pose/lean_problems.hpp"

namespace millpose {
namespace {

void ScoreRotations(benchmark::State& state) {
  const PoseProblem problem = MakeProblem(Kr500R2830());
  const PointScorer scorer(problem, PanelPoint(0, 0), Eigen::Vector3d::UnitZ());
  std::vector<double> angles(kLanes);
  ScoredBlock block;
  for (auto _ : state) {
    for (int first = 0; first < 360; first += kLanes) {
      for (int l = 0; l < kLanes; ++l) angles[l] = DegToRad(first + l);
      scorer.ScoreBlock(angles, kAllArmBranches, block);
      benchmark::DoNotOptimize(block);
    }
  }
  state.SetItemsProcessed(state.iterations() * 360 * 8);  // candidates: rotation × branch
}
BENCHMARK(ScoreRotations);

/// A point's layer from its table, and by way of a seed for every entry.
void LayerOfTable(benchmark::State& state) {
  const PoseProblem problem = MakeProblem(Kr500R2830());
  const PointScorer scorer(problem, PanelPoint(0, 0), Eigen::Vector3d::UnitZ());
  const CandidateTable table = CandidateTable::OfStep(scorer, DegToRad(1));
  for (auto _ : state) {
    if (state.range(0) != 0)
      benchmark::DoNotOptimize(MakeLayer(scorer, SeedsOf(table), false));
    else
      benchmark::DoNotOptimize(MakeLayer(scorer, table, {}, false));
  }
}
BENCHMARK(LayerOfTable)->ArgName("seeds")->Arg(0)->Arg(1)->Unit(benchmark::kMicrosecond);

void Exhaustive(benchmark::State& state) {
  const PoseProblem problem = MakeProblem(Kr500R2830());
  const PointScorer scorer(problem, PanelPoint(0, 0), Eigen::Vector3d::UnitZ());
  for (auto _ : state) benchmark::DoNotOptimize(ExhaustiveSearch(scorer, DegToRad(0.05)));
}
BENCHMARK(Exhaustive)->Unit(benchmark::kMicrosecond);

void Genetic(benchmark::State& state) {
  const PoseProblem problem = MakeProblem(Kr500R2830());
  const PointScorer scorer(problem, PanelPoint(0, 0), Eigen::Vector3d::UnitZ());
  uint64_t index = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(GeneticSearch(scorer, problem, {}, RandomStream(1, index++)));
  }
}
BENCHMARK(Genetic)->Unit(benchmark::kMicrosecond);

/// Rotation, lead and tilt.
void GeneticOfThreeFreedoms(benchmark::State& state) {
  const PoseProblem problem = LeaningProblem();
  const PointScorer scorer(problem, PanelPoint(0, 0), Eigen::Vector3d::UnitZ());
  uint64_t index = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(GeneticSearch(scorer, problem, {}, RandomStream(1, index++)));
  }
}
BENCHMARK(GeneticOfThreeFreedoms)->Unit(benchmark::kMicrosecond);

/// A step of smoothing: a band of two columns beside the diagonal, and a ring's corner.
constexpr int kStepSize = 60;

void FillStep(const auto& put) {
  for (int i = 0; i < kStepSize; ++i)
    for (int k = std::max(0, i - 2); k <= i; ++k) put(i, k, i == k ? 6.0 : -1.0 / (1 + i - k));
  put(kStepSize - 1, 0, -1.0);
}

void SmoothingStep(benchmark::State& state) {
  std::vector<double> x;
  for (auto _ : state) {
    std::vector<size_t> first(kStepSize, kStepSize);
    FillStep([&](int i, int k, double) { first[i] = std::min(first[i], static_cast<size_t>(k)); });
    EnvelopeMatrix matrix(std::move(first));
    FillStep([&](int i, int k, double value) { matrix.At(i, k) = value; });
    matrix.Factor();
    x.assign(kStepSize, 1.0);
    matrix.Solve(x);
    benchmark::DoNotOptimize(x.data());
  }
  state.counters["x0"] = x[0];
}
BENCHMARK(SmoothingStep)->Unit(benchmark::kMicrosecond);

/// The same by Eigen's sparse Cholesky, for comparison.
void SmoothingStepBySparse(benchmark::State& state) {
  Eigen::VectorXd x;
  for (auto _ : state) {
    std::vector<Eigen::Triplet<double>> triplets;
    FillStep([&](int i, int k, double value) { triplets.emplace_back(i, k, value); });
    Eigen::SparseMatrix<double> matrix(kStepSize, kStepSize);
    matrix.setFromTriplets(triplets.begin(), triplets.end());
    const Eigen::SimplicialLLT<Eigen::SparseMatrix<double>, Eigen::Lower, Eigen::NaturalOrdering<int>> factor(
        matrix);
    x = factor.solve(Eigen::VectorXd::Ones(kStepSize));
    benchmark::DoNotOptimize(x.data());
  }
  state.counters["x0"] = x[0];
}
BENCHMARK(SmoothingStepBySparse)->Unit(benchmark::kMicrosecond);

/// 500 nodes a layer on one branch, rotations around the whole turn, joints that follow the rotation.
std::vector<Layer> MakeLayers(int count) {
  constexpr int kNodes = 500;
  std::vector<Layer> layers(count);
  for (int t = 0; t < count; ++t) {
    Layer& layer = layers[t];
    for (int k = 0; k < kNodes; ++k) {
      const double rotation = -kPi + 2 * kPi * k / kNodes, along = 0.001 * t;
      Joints q;
      q << 0.3 * std::sin(rotation) + along, 0.4 * std::cos(rotation), 0.2 * std::sin(2 * rotation), rotation,
          0.8 + 0.3 * std::cos(rotation + along), -rotation;
      layer.joints.Add(q);
      layer.objective.push_back(2e-4 + 1e-4 * std::sin(3 * rotation + 0.01 * t));
      layer.freedoms.push_back({rotation});
      layer.first.push_back(rotation);
      layer.base.push_back(k);
      layer.genetic.push_back(false);
    }
    for (int later = 1; later <= 8; ++later) layer.lane_begin[later] = kNodes;
    layer.joints.Finish();
  }
  return layers;
}

StepRule BenchRule() {
  StepRule rule;
  rule.max_step = Joints::Constant(DegToRad(5));
  rule.motion_weight = 1e-5;
  return rule;
}

void LadderSearch(benchmark::State& state) {
  const std::vector<Layer> layers = MakeLayers(1000);
  const LadderProblem problem{layers, BenchRule(), {}, state.range(0) != 0, false, {}, {}};
  double cost = 0;
  for (auto _ : state) cost = SearchOpen(problem).cost;
  state.counters["cost"] = cost;
}
BENCHMARK(LadderSearch)->ArgName("banded")->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);

/// Every edge by the plain function, for comparison; on 50 layers, times 20 for 1,000.
void DenseReference(benchmark::State& state) {
  const std::vector<Layer> layers = MakeLayers(50);
  const StepRule rule = BenchRule();
  for (auto _ : state) {
    std::vector<double> row = layers[0].objective;
    for (size_t t = 1; t < layers.size(); ++t) {
      std::vector<double> next(row.size(), 1e9);
      for (size_t b = 0; b < next.size(); ++b) {
        const Joints to = layers[t].joints.At(b);
        for (size_t a = 0; a < row.size(); ++a) {
          next[b] = std::min(next[b], row[a] + StepCost(rule, layers[t - 1].joints.At(a), to));
        }
        next[b] += layers[t].objective[b];
      }
      row = std::move(next);
    }
    benchmark::DoNotOptimize(row);
  }
}
BENCHMARK(DenseReference)->Unit(benchmark::kMillisecond);

/// All predecessors of a layer's nodes, one by one and in blocks.
void RelaxOneByOne(benchmark::State& state) {
  const std::vector<Layer> layers = MakeLayers(2);
  const JointRows &from = layers[0].joints, &to = layers[1].joints;
  const CostRow row(layers[0].objective);
  const StepRule rule = BenchRule();
  for (auto _ : state)
    for (size_t node = 0; node < to.size; ++node) {
      BestPredecessor best;
      RelaxFrom(rule, from, row, 0, from.size, to.At(node), std::numeric_limits<double>::infinity(), best);
      benchmark::DoNotOptimize(best);
    }
}
BENCHMARK(RelaxOneByOne)->Unit(benchmark::kMicrosecond);

void RelaxInBlocks(benchmark::State& state) {
  const std::vector<Layer> layers = MakeLayers(2);
  const JointRows &from = layers[0].joints, &to = layers[1].joints;
  const CostRow row(layers[0].objective);
  const StepRule rule = BenchRule();
  size_t guess = 0;
  for (auto _ : state)
    for (size_t begin = 0; begin < to.size; begin += kBlock) {
      TargetBlock block;
      block.nodes = &to;
      block.begin = begin;
      const size_t count = std::min(kBlock, to.size - begin);
      block.wanted = (1u << count) - 1;
      std::fill_n(block.last.begin(), count, from.size);
      if (state.range(0) != 0) {  // as where a band reaches round the turn
        std::fill_n(block.first.begin(), count, from.size / 5);
        RelaxBlock(rule, from, row, guess, block);
        std::fill_n(block.last.begin(), count, from.size / 5);
        block.first = {};
      }
      RelaxBlock(rule, from, row, guess, block);
      guess = block.best[0].node;
      benchmark::DoNotOptimize(block);
    }
}
BENCHMARK(RelaxInBlocks)->ArgName("two_parts")->Arg(0)->Arg(1)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace millpose
