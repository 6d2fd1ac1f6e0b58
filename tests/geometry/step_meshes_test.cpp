// SPDX-License-Identifier: GPL-3.0-or-later
// The triangles of a STEP file as an input of their own, kept in the output folder.
#include "job/step_meshes.hpp"

#include <unistd.h>

#include <filesystem>

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/hash.hpp"
#include "geometry/import/step_reader.hpp"
#include "tests/geometry/step_parts.hpp"

namespace millpose {
namespace {
namespace fs = std::filesystem;

class StepMeshes : public testing::Test {
 protected:
  void SetUp() override {
    inputs_.job.workpiece.mesh_file = "part.step";
    inputs_.workpiece_bytes = DrilledBlockStep("MM");
    inputs_.hash = HashOf(inputs_);
  }
  void TearDown() override { fs::remove_all(base_); }

  // What another machine would have cut: a point elsewhere in its last digits.
  static std::string CutElsewhere(const std::string& bytes) {
    RawMesh mesh = ReadStepTriangles(bytes, "part");
    mesh.triangles.vertices[0].x() += 1e-12;
    return WriteStepTriangles(mesh);
  }

  const fs::path base_ = fs::temp_directory_path() / fmt::format("millpose_meshes_{}", ::getpid());
  JobInputs inputs_;  // as read: the part is STEP
};

TEST_F(StepMeshes, AreAnInputByTheirOwnHash) {
  JobInputs cut = inputs_;
  int percent = 0;
  CutStepFiles(&cut, [&](int now) { percent = now; }, {});
  EXPECT_EQ(percent, 100);
  ASSERT_TRUE(IsStepTriangles(cut.workpiece_bytes));
  ASSERT_EQ(cut.step_meshes.size(), 1u);
  EXPECT_EQ(cut.step_meshes.begin()->second, Hash(cut.workpiece_bytes));
  EXPECT_NE(cut.hash, inputs_.hash);
  JobInputs elsewhere = cut;
  elsewhere.workpiece_bytes = CutElsewhere(cut.workpiece_bytes);
  EXPECT_NE(HashOf(elsewhere), cut.hash);
}

TEST_F(StepMeshes, ARunGoesOnWithTheMeshThatWasKept) {
  const OutputFolder folder(base_, FolderUse::kResults);
  JobInputs cut = inputs_;
  CutStepFiles(&cut, {}, {});
  cut.workpiece_bytes = CutElsewhere(cut.workpiece_bytes);
  cut.step_meshes.begin()->second = Hash(cut.workpiece_bytes);
  KeepMeshes(cut, folder);
  JobInputs resumed = inputs_;
  TakeCachedMeshes(folder, &resumed);
  EXPECT_EQ(resumed.workpiece_bytes, cut.workpiece_bytes);
  EXPECT_EQ(resumed.hash, HashOf(cut));
  JobInputs finer = inputs_;  // is not what was kept
  finer.job.workpiece.chord_tolerance /= 2;
  TakeCachedMeshes(folder, &finer);
  EXPECT_FALSE(IsStepTriangles(finer.workpiece_bytes));
}

TEST_F(StepMeshes, TheManifestNamesTheMeshAndVerifyTakesIt) {
  JobInputs cut = inputs_;
  CutStepFiles(&cut, {}, {});
  {
    const OutputFolder folder(base_, FolderUse::kResults);
    ResultSet results(folder, kPlanNames);
    AddMeshes(cut, &results);
    const std::string manifest = results.AddManifest(cut.hash);
    results.AddRun(fmt::format("{{\"manifest\": \"{}\"}}", manifest));
    results.Publish();
  }
  const auto& [key, hash] = *cut.step_meshes.begin();
  EXPECT_EQ(CheckManifest(base_).files.at("meshes/" + key + ".mesh").hash, hash);
  JobInputs verified = inputs_;
  TakeCachedMeshes(base_, &verified);
  EXPECT_EQ(verified.workpiece_bytes, cut.workpiece_bytes);
  EXPECT_EQ(verified.hash, cut.hash);
}

TEST_F(StepMeshes, ABodyWithALostFaceIsRefused) {
  inputs_.job.workpiece.stock_file = "stock.step";
  inputs_.stock_bytes = LostFaceStep();
  try {
    CutStepFiles(&inputs_, {}, {});
    FAIL() << "the stock was taken with a face missing";
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()).substr(0, 45), "stock.step: STEP face 7 (#388, plane, 1200 mm");
  }
}

}  // namespace
}  // namespace millpose
