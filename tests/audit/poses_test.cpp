// SPDX-License-Identifier: GPL-3.0-or-later
// The planner's interference against the judge's on random poses, half of them with the tool near the part.
// MILLPOSE_POSES: how many of each sample.
#include <cstdlib>
#include <set>

#include "audit/interference.hpp"
#include "base/file.hpp"
#include "base/parallel.hpp"
#include "base/random.hpp"
#include "geometry/import/mesh_import.hpp"
#include "job/assemble.hpp"
#include "machine/collision/world.hpp"
#include "machine/robot/kinematics.hpp"
#include "tests/audit/folder.hpp"
#include "tests/base/source_dir.hpp"

namespace millpose {
namespace {

namespace fs = std::filesystem;

struct Sample {
  World world;
  audit::Setup setup;
};

Sample ReadSample(const std::string& name) {
  const fs::path folder = fs::path(SourceDir()) / "toolpaths" / name;
  const JobInputs inputs = LoadJobInputs(folder / "job.yaml");
  Cell cell = MakeCell(inputs.cell, inputs.body_bytes);
  cell.X_WP = MakeWorkpiecePose(inputs.job.workpiece, cell.X_WB);
  Body workpiece{"workpiece", BodyClass::kWorkpiece, Mount::kWorkpiece, 0, Pose::Identity(), {}};
  const std::string& mesh = inputs.job.workpiece.mesh_file;
  workpiece.shape = ImportMesh(ReadMesh(inputs.workpiece_bytes, mesh), {}, mesh).mesh.triangles();
  cell.bodies.push_back(std::move(workpiece));
  return {World(cell), audit::ReadSetup(ReadFile(folder / "job.yaml"), {folder})};
}

/// Uniform within the limits, or with the tool tip within 60 mm of the workpiece's surface in any direction.
Joints RandomPose(const Cell& cell, RandomStream& random) {
  const Arm& arm = cell.arm;
  if (random.Uniform() < 0.5) {
    const Triangles& part = std::get<Triangles>(cell.bodies.back().shape);
    for (int attempt = 0; attempt < 20; ++attempt) {
      const auto& face = part.faces[random.Below(static_cast<int>(part.faces.size()))];
      const double u = random.Uniform(), v = random.Uniform(0, 1 - u);
      const Eigen::Vector3d on = part.vertices[face[0]] +
                                 u * (part.vertices[face[1]] - part.vertices[face[0]]) +
                                 v * (part.vertices[face[2]] - part.vertices[face[0]]);
      Pose X_WT = cell.X_WP * Pose(Eigen::Translation3d(on));
      X_WT.linear() = Eigen::Quaterniond{random.Normal(), random.Normal(), random.Normal(), random.Normal()}
                          .normalized()
                          .toRotationMatrix();
      X_WT.translation() += 20 * Eigen::Vector3d{random.Normal(), random.Normal(), random.Normal()};
      const InverseResult found =
          Inverse(arm, cell.X_WB.inverse(Eigen::Isometry) * X_WT * cell.X_FT.inverse(Eigen::Isometry));
      if (found.count == 0) continue;
      const Joints q = found.solutions[random.Below(found.count)].q;
      if ((q.array() >= arm.lower.array()).all() && (q.array() <= arm.upper.array()).all()) return q;
    }
  }
  Joints q;
  for (int i = 0; i < 6; ++i) q[i] = random.Uniform(arm.lower[i], arm.upper[i]);
  return q;
}

struct Count {
  int touching = 0, refused = 0, only_refused = 0;
  std::vector<std::string> wrong;
};

/// Compares at pose `k` of a sample.
void Compare(const Sample& sample, Checker& checker, audit::Judge& judge, uint64_t k, Count& count) {
  RandomStream random(4711, k);
  const Joints q = RandomPose(sample.world.cell(), random);
  const bool cutting = k % 2 == 1;
  audit::Angles angles;
  for (size_t i = 0; i < 6; ++i) angles[i] = q[static_cast<Eigen::Index>(i)];
  const auto refused = checker.At(q, cutting ? Phase::kCutting : Phase::kFree);
  const auto touching = judge.At(angles, cutting, true);
  count.touching += touching.has_value();
  count.refused += refused.has_value();
  const std::string where = fmt::format("pose {}", k);
  if (touching && !refused)
    count.wrong.push_back(where + ": called free, but " + touching->first + " touches " + touching->second);
  if (touching || !refused) return;
  ++count.only_refused;
  // The checker's shapes are built around the true ones, the judge's inside of them: 0.3 % of their size.
  std::string second = refused->second;
  if (const size_t shank = second.find(" above its"); shank != std::string::npos) second.resize(shank);
  const double slack = 0.003 * static_cast<double>(judge.Radius(refused->first) + judge.Radius(second));
  // While cutting, spindle and holder may come nearer to the part than anything else.
  static const std::set<std::string> kTool{"bracket", "cutter", "holder", "spindle"};
  const bool at_part = cutting && refused->first == "workpiece" && kTool.contains(second);
  const double clearance =
      slack + static_cast<double>(at_part ? sample.setup.clearance_cutting : sample.setup.clearance_free);
  const double distance =
      static_cast<double>(judge.Distance(refused->first, second, angles, cutting, clearance + 1));
  if (distance > clearance)
    count.wrong.push_back(fmt::format("{}: {} and {} refused at {:.3f} mm; the judge measures {:.3f}", where,
                                      refused->first, refused->second, refused->distance, distance));
}

Count CompareMany(const std::string& name, int poses) {
  const Sample sample = ReadSample(name);
  constexpr int kChunk = 250;
  const int chunks = (poses + kChunk - 1) / kChunk;
  std::vector<Count> counts(static_cast<size_t>(chunks));
  ParallelFor(counts.size(), 2, {}, [&](size_t chunk) {
    Checker checker(sample.world);
    audit::Judge judge(sample.setup);
    for (int k = 0; k < kChunk; ++k) Compare(sample, checker, judge, chunk * kChunk + k, counts[chunk]);
  });
  Count all;
  for (const Count& count : counts) {
    all.touching += count.touching;
    all.refused += count.refused;
    all.only_refused += count.only_refused;
    all.wrong.insert(all.wrong.end(), count.wrong.begin(), count.wrong.end());
  }
  return all;
}

TEST(Poses, NothingThatTheJudgeFindsTouchingIsCalledFreeAndRefusalsHaveAReason) {
  const char* wanted = std::getenv("MILLPOSE_POSES");
  const int poses = wanted ? std::atoi(wanted) : 500;
  for (const char* name : {"support_pad", "cabin_panel", "cabin_ring"}) {
    const Count count = CompareMany(name, poses);
    EXPECT_TRUE(count.wrong.empty()) << fmt::format("{}", fmt::join(count.wrong, "\n"));
    fmt::print("{}: {} poses, {} touching, {} refused, {} of these for nearness alone\n", name, poses,
               count.touching, count.refused, count.only_refused);
    EXPECT_GT(count.touching, poses / 10);
    EXPECT_GT(count.only_refused, 0);
    EXPECT_LT(count.refused, poses * 19 / 20);
  }
}

}  // namespace
}  // namespace millpose
