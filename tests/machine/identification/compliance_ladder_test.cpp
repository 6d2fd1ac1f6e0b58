// SPDX-License-Identifier: GPL-3.0-or-later
// Laws of the choice between models: what is left out, what is found, what is never made up.
#include "machine/identification/compliance_models.hpp"
#include "tests/base/tier.hpp"
#include "tests/machine/identification/drawn_arm.hpp"

namespace millpose {
namespace {

using Eigen::Vector3d;
using Kind = ComplianceStep::Kind;

IdentifyOptions OptionsOf(const ComplianceModel& model) {
  IdentifyOptions options;
  options.beside = model.gives;
  options.payload = model.payload();
  return options;
}

/// Where a load moves its point by what was found, mm; written out here.
Vector3d Moved(const Arm& arm, const LoadCase& load, const Identification& found) {
  const Matrix6 J = Jacobian(arm, load.q, load.load_point);
  const Vector3d force = load.force - (found.payload ? found.payload->weight : 0) * Vector3d::UnitZ();
  const Joints torque = J.topRows<3>().transpose() * force, stated = J.topRows<3>().transpose() * load.force;
  const std::array<Pose, 7> frames = LinkFrames(arm, load.q);
  Vector3d moved = Vector3d::Zero();
  for (int j = 0; j < 6; ++j)
    if (found.joints[j].determined) moved += torque[j] / found.joints[j].stiffness * J.block<3, 1>(0, j);
  for (const GiveEstimate& one : found.beside) {
    if (one.give.kind == Give::Kind::kTakesUp) {
      const int j = one.give.link - 1;
      moved += (stated[j] > 0 ? 1 : -1) * one.compliance * J.block<3, 1>(0, j);
      continue;
    }
    const Pose& frame = frames[static_cast<size_t>(one.give.link)];
    const Vector3d axis = frame.linear().col(one.give.axis);
    const Vector3d along = one.give.kind == Give::Kind::kMoves
                               ? axis
                               : Vector3d(axis.cross(frames[6] * load.load_point - frame.translation()));
    moved += one.compliance * along.dot(force) * along;
  }
  return moved;
}

/// mm², every pose foretold by a fit of its own to the others.
double ForetoldOneByOne(const Arm& arm, const std::vector<LoadCase>& cases, const IdentifyOptions& options) {
  double sum = 0;
  for (size_t out = 0; out < cases.size(); ++out) {
    std::vector<LoadCase> others = cases;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(out));
    const Identification found = IdentifyJointStiffness(arm, others, options);
    sum += (Moved(arm, cases[out], found) - cases[out].displacement).squaredNorm();
  }
  return sum / static_cast<double>(cases.size());
}

// The formula of the hat matrix against fits without each pose; with so much noise that many unknowns are at
// 0, and others with one pose less.
TEST(ComplianceLadder, LeavingOutIsAsFittingAgain) {
  RandomStream stream(11, 0);
  DrawnArm drawn(KrQuantecR2700(), {{2, 3e-10}}, 1e-5);
  drawn.payload = 40;
  for (const double noise : {0.01, 0.3}) {
    const std::vector<LoadCase> cases = drawn.Measured(24, noise, stream);
    const ComplianceModels models = TryModels(drawn.arm, cases, {});
    ASSERT_EQ(models.tried.size(), 8u);  // links 4 and 5 tilt about axes 5 and 4 too
    size_t at_zero = 0;
    for (const ComplianceModel& model : models.tried) {
      if (model.payload() && noise > 0.1) continue;  // with a payload it holds to first order
      const double again = ForetoldOneByOne(drawn.arm, cases, OptionsOf(model));
      EXPECT_NEAR(model.mean_square / again, 1, model.payload() ? 0.05 : 1e-8)
          << model.unknowns << " " << noise;
      for (const GiveEstimate& give : IdentifyJointStiffness(drawn.arm, cases, OptionsOf(model)).beside)
        at_zero += give.determined ? 0 : 1;
    }
    EXPECT_GT(at_zero, 5u);
  }
}

TEST(ComplianceLadder, FindsLostMotion) {
  RandomStream stream(12, 0);
  DrawnArm drawn(KrQuantecR2700(), {});
  drawn.takes_up << 4e-5, 6e-5, 9e-5, 2e-4, 3e-4, 3e-4;  // some 0.3 to 2 arcmin of gap
  const std::vector<LoadCase> cases = drawn.Measured(60, 0.005, stream);
  const ComplianceModels models = TryModels(drawn.arm, cases, {});
  const ComplianceModel& chosen = models.tried[models.chosen];
  ASSERT_EQ(chosen.steps, (std::vector<ComplianceStep>{{Kind::kLostMotion}}));
  EXPECT_LT(chosen.mean_square, 0.2 * models.tried[0].mean_square);
  const Identification exact =
      IdentifyJointStiffness(drawn.arm, drawn.Measured(60, 0, stream), OptionsOf(chosen));
  ASSERT_EQ(exact.beside.size(), 6u);
  for (size_t j = 0; j < 6; ++j) {
    const auto at = static_cast<Eigen::Index>(j);
    EXPECT_NEAR(exact.beside[j].compliance / drawn.takes_up[at], 1, 1e-8);
    EXPECT_NEAR(exact.joints[j].stiffness / drawn.arm.stiffness[at], 1, 1e-8);
  }
}

TEST(ComplianceLadder, FindsAPayload) {
  RandomStream stream(13, 0);
  DrawnArm drawn(KrQuantecR2700(), {});
  for (const double payload : {120.0, -80.0}) {
    drawn.payload = payload;
    const std::vector<LoadCase> cases = drawn.Measured(40, 0.01, stream);
    const ComplianceModels models = TryModels(drawn.arm, cases, {});
    const ComplianceModel& chosen = models.tried[models.chosen];
    ASSERT_EQ(chosen.steps, (std::vector<ComplianceStep>{{Kind::kPayload}}));
    const Identification found = IdentifyJointStiffness(drawn.arm, cases, OptionsOf(chosen));
    ASSERT_TRUE(found.payload && found.payload->determined);
    EXPECT_NEAR(found.payload->weight, payload, 10);
    EXPECT_LT(found.payload->upper - found.payload->lower, 30);
    const Identification exact =
        IdentifyJointStiffness(drawn.arm, drawn.Measured(40, 0, stream), OptionsOf(chosen));
    EXPECT_NEAR(exact.payload->weight, payload, 1e-5);
    EXPECT_NEAR(exact.joints[2].stiffness / drawn.arm.stiffness[2], 1, 1e-7);
  }
}

// Loads of one size straight down: a payload is so much more of each load, and axis 1 carries nothing.
TEST(ComplianceLadder, SaysWhatLoadsDownwardsCannotTell) {
  RandomStream stream(14, 0);
  const DrawnArm drawn(KrQuantecR2700(), {});
  std::vector<LoadCase> cases;
  for (const LoadCase& one : drawn.Measured(30, 0, stream))
    cases.push_back(drawn.Loaded(one.q, Vector3d(0, 0, -600), 0.01, stream));
  const ComplianceModels models = TryModels(drawn.arm, cases, {});
  const auto payload =
      std::ranges::find(models.untold, Kind::kPayload, [](const UntoldStep& one) { return one.step.kind; });
  ASSERT_NE(payload, models.untold.end());
  EXPECT_NE(payload->reason.find("combination"), std::string::npos) << payload->reason;
  for (const ComplianceModel& model : models.tried) {
    EXPECT_FALSE(model.payload());
    EXPECT_EQ(std::ranges::count(model.gives, TakingUpOf(1)), 0);
  }
}

/// Of one kind of arm, stiffnesses drawn; `kind` 0: springs alone; 1 to 3: that link tilts too; 4: the joints
/// have gaps.
DrawnArm Draw(int kind, RandomStream& stream) {
  std::vector<std::pair<int, double>> tilts;
  if (kind >= 1 && kind <= 3) tilts.emplace_back(kind, stream.Uniform(4e-10, 1.2e-9));
  DrawnArm drawn(KrQuantecR2700(), tilts);
  for (double& stiffness : drawn.arm.stiffness) stiffness *= stream.Uniform(0.5, 2);
  for (int j = 0; kind == 4 && j < 6; ++j) drawn.takes_up[j] = stream.Uniform(1, 3) * (j < 3 ? 5e-5 : 2e-4);
  return drawn;
}

std::vector<ComplianceStep> StepsOf(int kind) {
  if (kind == 0) return {};
  return {kind == 4 ? ComplianceStep{Kind::kLostMotion} : ComplianceStep{Kind::kTilting, kind}};
}

struct Count {
  int inside = 0, all = 0;
  void Add(double lower, double truth, double upper) {
    inside += lower <= truth && truth <= upper ? 1 : 0;
    ++all;
  }
  double share() const { return static_cast<double>(inside) / all; }
};

// By the model that the rule chooses, whatever the arm is: of each kind, and of joints and the rest apart.
TEST(ComplianceLadder, IntervalsOfTheChosenModelHoldTheTruth) {
  const int draws = OfTier(120, 1000);
  Count joints, beside;
  std::array<Count, 5> of_kind;
  int as_drawn = 0;
  for (int draw = 0; draw < draws; ++draw) {
    RandomStream stream(15, static_cast<uint64_t>(draw));
    const int kind = draw % 5;
    const DrawnArm drawn = Draw(kind, stream);
    const std::vector<LoadCase> cases = drawn.Measured(50, 0.01, stream);
    const ComplianceModels models = TryModels(drawn.arm, cases, {});
    const ComplianceModel& chosen = models.tried[models.chosen];
    as_drawn += chosen.steps == StepsOf(kind) ? 1 : 0;
    const Identification found = IdentifyJointStiffness(drawn.arm, cases, OptionsOf(chosen));
    for (size_t j = 0; j < 6; ++j)
      for (Count* count : {&joints, &of_kind[static_cast<size_t>(kind)]})
        count->Add(found.joints[j].lower, drawn.arm.stiffness[static_cast<Eigen::Index>(j)],
                   found.joints[j].upper);
    for (const GiveEstimate& one : found.beside) {
      if (one.give.kind == Give::Kind::kTakesUp && kind == 4)
        beside.Add(one.lower, drawn.takes_up[one.give.link - 1], one.upper);
      if (one.give.kind == Give::Kind::kTilts && one.give.link == kind)
        beside.Add(one.lower, drawn.elements[0].C(3 + one.give.axis, 3 + one.give.axis), one.upper);
    }
  }
  for (size_t kind = 0; kind < of_kind.size(); ++kind)
    RecordProperty(fmt::format("joints_share_of_kind_{}", kind),
                   fmt::format("{:.4f}", of_kind[kind].share()));
  RecordProperty("joints_share", fmt::format("{:.4f}", joints.share()));
  RecordProperty("beside_share", fmt::format("{:.4f}", beside.share()));
  RecordProperty("as_drawn", as_drawn);
  const double slack = OfTier(15, 0) * 1e-3;  // two deviations of the share in few draws
  EXPECT_GE(joints.share(), 0.93 - slack);
  EXPECT_LE(joints.share(), 0.97 + slack);
  EXPECT_GE(beside.share(), 0.93 - slack);
  EXPECT_LE(beside.share(), 0.97 + slack);
  // What is drawn stands out here; intervals know nothing of a choice that went wrong.
  EXPECT_GE(as_drawn, draws * 95 / 100);
}

// A model richer than the data supports: springs alone are drawn, springs alone are chosen.
TEST(ComplianceLadder, SpringsAloneWhereNothingElseGives) {
  const int draws = OfTier(60, 1000);
  int springs = 0;
  for (int draw = 0; draw < draws; ++draw) {
    RandomStream stream(16, static_cast<uint64_t>(draw));
    const DrawnArm drawn = Draw(0, stream);
    springs += TryModels(drawn.arm, drawn.Measured(30, 0.02, stream), {}).chosen == 0 ? 1 : 0;
  }
  RecordProperty("springs", springs);
  EXPECT_GE(springs, draws * 95 / 100);
}

TEST(ComplianceLadder, FewPosesTrySpringsAlone) {
  RandomStream stream(17, 0);
  const DrawnArm drawn(KrQuantecR2700(), {});
  EXPECT_EQ(TryModels(drawn.arm, drawn.Measured(8, 0.02, stream), {}).tried.size(), 1u);
  const ComplianceModels one = TryModels(drawn.arm, drawn.Measured(1, 0.02, stream), {});
  EXPECT_EQ(one.tried.size(), 1u);
  EXPECT_FALSE(one.tried[0].judged);
}

}  // namespace
}  // namespace millpose
