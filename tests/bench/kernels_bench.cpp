// SPDX-License-Identifier: GPL-3.0-or-later
// The hot loop's kernels beside the scalar code they replace; time per pose is time/item.
#include <benchmark/benchmark.h>

#include <vector>

#include "machine/robot/inverse_entries.hpp"
#include "machine/stiffness/indices_block.hpp"
#include "tests/machine/robot/arms.hpp"

namespace millpose {
namespace {

constexpr int kBlocks = 64;
const Eigen::Vector3d kTip(-250, 0, 250);
const Eigen::Vector3d kNormal = Eigen::Vector3d(-1, 0.1, 0.2).normalized();

const std::vector<Joints>& Poses() {
  static const std::vector<Joints> poses = [] {
    RandomStream stream(1, 0);
    std::vector<Joints> made;
    for (int k = 0; k < kBlocks * kLanes; ++k) made.push_back(RandomJoints(stream));
    return made;
  }();
  return poses;
}

std::vector<FlangeBlock> Flanges(const Arm& arm) {
  std::vector<FlangeBlock> blocks(kBlocks);
  for (int k = 0; k < kBlocks * kLanes; ++k)
    blocks[k / kLanes].Set(k % kLanes, ForwardFlange(arm, Poses()[k]));
  return blocks;
}

void Items(benchmark::State& state) { state.SetItemsProcessed(state.iterations() * kBlocks * kLanes); }
InstructionSet SetOf(const benchmark::State& state) { return static_cast<InstructionSet>(state.range(0)); }

void InverseScalar(benchmark::State& state) {
  const Arm arm = Kr500R2830();
  std::vector<Pose> flanges;
  for (const Joints& q : Poses()) flanges.push_back(ForwardFlange(arm, q));
  for (auto _ : state)
    for (const Pose& X_BF : flanges) benchmark::DoNotOptimize(Inverse(arm, X_BF));
  Items(state);
}
BENCHMARK(InverseScalar);

void InverseOfBlocks(benchmark::State& state) {
  const Arm arm = Kr500R2830();
  if (!Supports(SetOf(state))) return state.SkipWithError("not on this processor");
  const std::vector<FlangeBlock> flanges = Flanges(arm);
  ArmBranches branches;
  for (auto _ : state)
    for (const FlangeBlock& flange : flanges) {
      InverseBlock(arm, flange, branches, SetOf(state));
      benchmark::DoNotOptimize(branches);
    }
  Items(state);
}
BENCHMARK(InverseOfBlocks)->DenseRange(0, 2);

/// One branch of four, as smoothing and refinement ask for it.
void InverseOfOneBranch(benchmark::State& state) {
  const Arm arm = Kr500R2830();
  if (!Supports(SetOf(state))) return state.SkipWithError("not on this processor");
  const std::vector<FlangeBlock> flanges = Flanges(arm);
  ArmBranches branches;
  for (auto _ : state)
    for (const FlangeBlock& flange : flanges) {
      InverseEntries(arm, flange, 0b0100, branches, SetOf(state));
      benchmark::DoNotOptimize(branches);
    }
  Items(state);
}
BENCHMARK(InverseOfOneBranch)->DenseRange(0, 2);

void InverseOfBlocksWithAngles(benchmark::State& state) {
  const Arm arm = Kr500R2830();
  if (!Supports(SetOf(state))) return state.SkipWithError("not on this processor");
  const std::vector<FlangeBlock> flanges = Flanges(arm);
  ArmBranches branches;
  AnglesBlock angles;
  for (auto _ : state)
    for (const FlangeBlock& flange : flanges) {
      InverseBlock(arm, flange, branches, SetOf(state));
      for (int entry = 0; entry < EntryCount(arm); ++entry) {
        AnglesOfBranch(arm, branches[static_cast<size_t>(entry)], angles, SetOf(state));
        benchmark::DoNotOptimize(angles);
      }
    }
  Items(state);
}
BENCHMARK(InverseOfBlocksWithAngles)->DenseRange(0, 2);

void ComplianceAndIndicesScalar(benchmark::State& state) {
  const Arm arm = Kr500R2830();
  for (auto _ : state)
    for (const Joints& q : Poses()) {
      const Matrix6 C = Compliance(Jacobian(arm, q, kTip), arm.stiffness);
      benchmark::DoNotOptimize(IndicesInPlane(C.topLeftCorner<3, 3>(), kNormal));
    }
  Items(state);
}
BENCHMARK(ComplianceAndIndicesScalar);

void DexterityScalar(benchmark::State& state) {
  const Arm arm = Kr500R2830();
  for (auto _ : state)
    for (const Joints& q : Poses()) benchmark::DoNotOptimize(Dexterity(Jacobian(arm, q, kTip), 1000));
  Items(state);
}
BENCHMARK(DexterityScalar);

/// Per pose of one arm branch.
void ComplianceAndIndicesOfBlocks(benchmark::State& state) {
  const Arm arm = Kr500R2830();
  if (!Supports(SetOf(state))) return state.SkipWithError("not on this processor");
  const std::vector<FlangeBlock> flanges = Flanges(arm);
  std::vector<ArmBranches> branches(kBlocks);
  for (int k = 0; k < kBlocks; ++k) InverseBlock(arm, flanges[k], branches[k]);
  ComplianceBlock c;
  PlaneIndicesBlock indices;
  for (auto _ : state)
    for (int k = 0; k < kBlocks; ++k) {
      LinearCompliance(arm, flanges[k], branches[k][2], kTip, c, SetOf(state));
      IndicesInPlane(c, kNormal, indices, SetOf(state));
      benchmark::DoNotOptimize(indices);
    }
  Items(state);
}
BENCHMARK(ComplianceAndIndicesOfBlocks)->DenseRange(0, 2);

void DexterityOfBlocks(benchmark::State& state) {
  const Arm arm = Kr500R2830();
  if (!Supports(SetOf(state))) return state.SkipWithError("not on this processor");
  const std::vector<FlangeBlock> flanges = Flanges(arm);
  std::vector<ArmBranches> branches(kBlocks);
  for (int k = 0; k < kBlocks; ++k) InverseBlock(arm, flanges[k], branches[k]);
  Lanes dexterity;
  for (auto _ : state)
    for (int k = 0; k < kBlocks; ++k) {
      DexterityOfBlock(arm, flanges[k], branches[k][2], kTip, 1000, dexterity, SetOf(state));
      benchmark::DoNotOptimize(dexterity);
    }
  Items(state);
}
BENCHMARK(DexterityOfBlocks)->DenseRange(0, 2);

}  // namespace
}  // namespace millpose
