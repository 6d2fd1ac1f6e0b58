// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/error.hpp"
#include "planning/pose/evaluator.hpp"
#include "planning/pose/freedom_entry.hpp"
#include "tests/planning/pose/problems.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;

MillingPoint PointWithAxis(const Vector3d& axis) {
  MillingPoint point;
  point.position = Vector3d(1, 2, 3);
  point.normal = point.tool_axis = axis.normalized();
  point.feed = axis.unitOrthogonal();
  return point;
}

void ExpectRigid(const Pose& X) {
  EXPECT_LT((X.linear() * X.linear().transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-14);
  EXPECT_GT(X.linear().determinant(), 0);
}

TEST(NominalToolPose, PutsXAlongTheReference) {
  const Pose X = NominalToolPose(PointWithAxis(Vector3d(-1, 0.2, 0.3)), Vector3d::UnitZ());
  ExpectRigid(X);
  EXPECT_EQ(X.translation(), Vector3d(1, 2, 3));
  EXPECT_NEAR(X.linear().col(2).dot(Vector3d(-1, 0.2, 0.3).normalized()), 1, 1e-15);
  EXPECT_NEAR(X.linear().col(1).z(), 0, 1e-15);  // the reference lies in the x-z plane
  EXPECT_GT(X.linear().col(0).z(), 0);
}

TEST(NominalToolPose, FallsBackToTheLeastAlignedAxis) {
  const double tilt = std::tan(DegToRad(0.9));
  const Pose X = NominalToolPose(PointWithAxis(Vector3d(0, tilt, 1)), Vector3d::UnitZ());
  ExpectRigid(X);
  EXPECT_NEAR(X.linear()(0, 0), 1, 1e-15);  // world x, not z
  const double more = std::tan(DegToRad(1.1));
  EXPECT_NEAR(NominalToolPose(PointWithAxis(Vector3d(0, more, 1)), Vector3d::UnitZ()).linear()(0, 0), 0,
              1e-15);
}

TEST(Freedom, RotationTurnsAboutTheToolAxis) {
  const auto rotation = RotationAboutTool();
  EXPECT_TRUE(rotation->Periodic());
  const Pose X = NominalToolPose(PointWithAxis(Vector3d(-1, 0.2, 0.3)), Vector3d::UnitZ());
  for (const double angle : {-3.0, -0.4, 0.0, 1.0, 3.1}) {
    const Pose expected = X * Eigen::AngleAxisd(angle, Vector3d::UnitZ());
    EXPECT_LT((rotation->Apply(X, angle).matrix() - expected.matrix()).norm(), 1e-14);
  }
  const Pose lower = rotation->Apply(X, rotation->Lower()), upper = rotation->Apply(X, rotation->Upper());
  EXPECT_LT((lower.matrix() - upper.matrix()).norm(), 1e-14);
}

/// Lifts the tool off its contact by 0 … `most`.
class Lift final : public Freedom {
 public:
  struct Options {
    double most = 0;
  };
  explicit Lift(Options options) : options_(options) {}
  const Options& options() const { return options_; }
  std::string Name() const override { return "lift"; }
  double Lower() const override { return 0; }
  double Upper() const override { return options_.most; }
  bool Periodic() const override { return false; }
  bool IsLean() const override { return true; }
  ToolStance Lean(const CutterContact&, const ToolStance& from, double value) const override {
    return {from.tip + value * from.axis, from.axis};
  }

 private:
  Options options_;
};

FreedomEntry LiftEntry() {
  using S = Lift::Options;
  return EntryOf<Lift>(
      "lift_mm", "How far it may go.",
      yaml::Section<S>({yaml::Key<S>("most", MILLPOSE_AT(most), yaml::Real(yaml::kMm, yaml::UpTo(5)), "Most.")
                            .Required()}));
}

TEST(FreedomEntry, MakesItsFreedomWhereTheKeyIsGiven) {
  const FreedomEntry entry = LiftEntry();
  EXPECT_EQ(entry.name, "lift");
  EXPECT_TRUE(entry.leans);
  EXPECT_EQ(entry.key->info.key, "lift_mm");
  EXPECT_EQ(entry.key->keys().at(0).key, "most");
  OpenToolpath toolpath;
  EXPECT_EQ(entry.key->write(toolpath).kind, yaml::Value::Kind::kNull) << "left out of the resolved job";
  EXPECT_FALSE(toolpath.Leans());
  const std::string file = "job.yaml";
  std::vector<Problem> problems;
  const auto read = [&](const std::string& text) {
    problems.clear();
    entry.key->read(yaml::ReadYaml(text, file), {file, problems, "toolpath.lift_mm"}, toolpath);
  };
  read("{most: 2}");
  ASSERT_TRUE(problems.empty());
  ASSERT_NE(toolpath.Find("lift"), nullptr);
  EXPECT_EQ(toolpath.Find("lift")->Upper(), 2);
  EXPECT_TRUE(toolpath.Leans());
  EXPECT_EQ(yaml::WriteYamlLine(entry.key->write(toolpath)), "{most: 2}");
  read("\n most: 6");
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_EQ(problems[0].place.line, 2);
  EXPECT_EQ(problems[0].place.column, 8);
  EXPECT_TRUE(problems[0].message.starts_with("toolpath.lift_mm.most: given 6")) << problems[0].message;
  EXPECT_EQ(toolpath.Find("lift")->Upper(), 2) << "what is wrong changes nothing";
}

TEST(FreedomsOf, AreThoseThatTheJobOpensInTheRegistrysOrder) {
  const auto names = [](const OpenToolpath& toolpath) {
    std::vector<std::string> all;
    for (const FreedomPointer& freedom : FreedomsOf(toolpath)) all.push_back(freedom->Name());
    return all;
  };
  OpenToolpath toolpath;
  EXPECT_EQ(names(toolpath), std::vector<std::string>{"rotation"});
  for (const char* key : {"tilt", "lead"}) {
    const std::string file;
    std::vector<Problem> problems;
    Freedoms().At(key).key->read(yaml::ReadYaml("{from: 1, to: 3, step: 1}", file), {file, problems, key},
                                 toolpath);
    EXPECT_TRUE(problems.empty()) << key;
  }
  EXPECT_EQ(names(toolpath), (std::vector<std::string>{"rotation", "lead", "tilt"}));
  EXPECT_TRUE(LeanKeys().starts_with("lead_deg")) << LeanKeys();
  EXPECT_NE(LeanKeys().find("tilt_deg"), std::string::npos) << LeanKeys();
}

TEST(Freedom, ValuesAreBroughtIntoTheRangeAndComparedTheShortWay) {
  const auto rotation = RotationAboutTool();
  for (double value = -20; value < 20; value += 0.37) {
    const double inside = Confine(*rotation, value);
    EXPECT_GE(inside, -kPi - 1e-12);
    EXPECT_LE(inside, kPi + 1e-12);
    EXPECT_NEAR(std::remainder(inside - value, 2 * kPi), 0, 1e-12);
    const double apart = Difference(*rotation, 0.3, value);
    EXPECT_LE(std::abs(apart), kPi + 1e-12);
    EXPECT_NEAR(std::remainder(0.3 + apart - value, 2 * kPi), 0, 1e-12);
  }
}

}  // namespace
}  // namespace millpose
