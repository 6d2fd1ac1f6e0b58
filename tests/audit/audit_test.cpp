// SPDX-License-Identifier: GPL-3.0-or-later
// The judge is judged: a good folder passes, and one wrong row or line raises exactly the figure that it
// belongs to.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "audit/distance.hpp"
#include "audit/interference.hpp"
#include "audit/tessellate.hpp"
#include "base/gzip.hpp"
#include "tests/audit/audit_fixture.hpp"
#include "tests/audit/good_folder.hpp"
#include "tests/audit/kinematics.hpp"
#include "tests/audit/laws.hpp"
#include "tests/audit/motions.hpp"
#include "tests/audit/programs.hpp"

namespace millpose::audit {
namespace {

/// Adds `by` to cell `column` of a line of comma-separated values.
std::string AddTo(const std::string& line, size_t column, double by) {
  std::istringstream cells(line);
  std::string cell, result;
  for (size_t i = 0; std::getline(cells, cell, ','); ++i) {
    char text[40];
    std::snprintf(text, sizeof text, "%.17g", i == column ? std::stod(cell) + by : 0.0);
    result += (i ? "," : "") + (i == column ? std::string(text) : cell);
  }
  return result;
}

TEST_F(AuditTest, AGoodFolderPasses) {
  const Verdict verdict = Judged(MakeFolder({}));
  EXPECT_TRUE(verdict.Holds()) << ToJson(verdict);
  EXPECT_GT(verdict.poses_checked, 300);
  EXPECT_LT(verdict["max_tip_error_mm"].value, 1e-9);
  EXPECT_LT(verdict["program_deviation_mm_linuxcnc"].value, 1e-3);
  EXPECT_LT(verdict["program_deviation_mm_krl"].value, 1e-3);
  EXPECT_LT(verdict["program_deviation_mm_sinumerik"].value, 1e-3);
}

TEST_F(AuditTest, AWrongPositionIsATipError) {
  Texts texts = MakeFolder({});
  // Along the block's top, so that the point stays on the surface.
  const std::vector<Row> rows = ReadPoints(texts["out/points.csv"]);
  const Vector3 along = (rows[4].position - rows[3].position).normalized() * 0.001L;
  EditLine(texts["out/points.csv"], 5, [&](std::string line) {
    for (size_t k = 0; k < 3; ++k)
      line = AddTo(line, 6 + k, static_cast<double>(along[static_cast<Eigen::Index>(k)]));
    return line;
  });
  EXPECT_EQ(Broken(texts), Names{"max_tip_error_mm"});
}

TEST_F(AuditTest, AWrongToolAxisIsAnAxisError) {
  Texts texts = MakeFolder({});
  EditLine(texts["out/points.csv"], 3, [](const std::string& line) { return AddTo(line, 12, 1e-6); });
  EXPECT_EQ(Broken(texts), Names{"max_axis_error_deg"});
}

TEST_F(AuditTest, APointOffTheSurfaceIsASliceDistance) {
  EXPECT_EQ(Broken(MakeFolder({.lift_mm = 1e-4})), Names{"max_slice_distance_mm"});
}

TEST_F(AuditTest, CutsStandALayerAboveTheSurface) {
  EXPECT_EQ(Broken(MakeFolder({.layers = true})), Names{});
  EXPECT_EQ(Broken(MakeFolder({.lift_mm = 1e-4, .layers = true})), Names{"max_slice_distance_mm"});
  // One point of the lower pass as high as the upper one.
  const Verdict other = Judged(MakeFolder({.lift_mm = 1, .layers = true}));
  EXPECT_NEAR(other["max_slice_distance_mm"].value, 1, 1e-9);
  const std::string stated = "depth: {total_mm: 2, per_layer_mm: 1}";
  for (const std::string depth : {"depth: {total_mm: 2}", "depth: {total_mm: 2, per_layer_mm: 0.7}",
                                  "depth: {total_mm: 2, allowance_mm: 0.001}", "depth: {}",
                                  "depth: {total_mm: 2, finishing_mm: 0.5}"}) {
    Texts texts = MakeFolder({.layers = true});
    std::string& job = texts["out/job.yaml"];
    job.replace(job.find(stated), stated.size(), depth);
    EXPECT_EQ(Broken(texts), depth == "depth: {total_mm: 2}" ? Names{} : Names{"max_slice_distance_mm"})
        << depth;
  }
}

TEST_F(AuditTest, ALeadMayLeaveTheSurfaceButNotItsPose) {
  EXPECT_EQ(Broken(MakeFolder({.lead_mm = 3})), Names{});
  Texts texts = MakeFolder({.lead_mm = 3});
  std::string& csv = texts["out/points.csv"];
  csv.replace(csv.find("lead-out"), 8, "cut");
  EXPECT_EQ(Broken(texts), Names{"max_slice_distance_mm"});
  texts = MakeFolder({.lead_mm = 3});
  EditLine(texts["out/points.csv"], 12, [](const std::string& line) { return AddTo(line, 7, 1e-5); });
  EXPECT_EQ(Broken(texts), Names{"max_tip_error_mm"});
}

TEST(Layers, EvenStepsDownToTheFinishingCut) {
  const auto near = [](const std::vector<Real>& layers, const std::vector<double>& known) {
    ASSERT_EQ(layers.size(), known.size());
    for (size_t k = 0; k < known.size(); ++k) EXPECT_NEAR(static_cast<double>(layers[k]), known[k], 1e-12);
  };
  near(LayersOf(0, 1, 0.2L, 0), {0.2});
  near(LayersOf(5, 2, 0.2L, 0.5L), {3.7, 2.2, 0.7, 0.2});
  near(LayersOf(3, 1, 0, 0), {2, 1, 0});
  near(LayersOf(0.5L, 1, 0.1L, 2), {0.1});
  near(LayersOf(0.9L, 0.3L, 0, 0), {0.6, 0.3, 0});
}

TEST_F(AuditTest, AnAngleBeyondTheJobsLimitIsALimitViolation) {
  EXPECT_EQ(Broken(MakeFolder({.narrow_limits = true})), Names{"limit_violations"});
}

TEST_F(AuditTest, ASumOfAnglesBeyondItsLimitIsALimitViolation) {
  EXPECT_EQ(Broken(MakeFolder({.coupled_room_deg = 0.01})), Names{});
  EXPECT_EQ(Broken(MakeFolder({.coupled_room_deg = -0.01})), Names{"limit_violations"});
}

TEST_F(AuditTest, AJumpIsAStepViolation) {
  EXPECT_EQ(Broken(MakeFolder({.rotation_deg = 8})), Names{"step_violations"});
}

TEST_F(AuditTest, AStepThatIsTooFastAtTheFeedIsAStepViolation) {
  Texts texts = MakeFolder({.rotation_deg = 4});
  EXPECT_EQ(Broken(texts), Names{});
  const std::string share = "joint_speed_share: 0.25";
  texts["out/job.yaml"].replace(texts["out/job.yaml"].find(share), share.size(), "joint_speed_share: 0.01");
  EXPECT_EQ(Broken(texts), Names{"step_violations"});
}

TEST_F(AuditTest, AWrongIndexIsAnIndexError) {
  for (const size_t column : {23u, 24u, 25u, 26u, 27u, 28u}) {
    Texts texts = MakeFolder({});
    EditLine(texts["out/points.csv"], 7, [&](const std::string& line) {
      std::istringstream cells(line);
      std::string cell;
      for (size_t i = 0; i <= column; ++i) std::getline(cells, cell, ',');
      return AddTo(line, column, 1e-5 * std::stod(cell));
    });
    EXPECT_EQ(Broken(texts), Names{"max_index_error_relative"}) << column;
  }
}

/// Multiplies a cell of a line of comma-separated values.
std::string Scaled(const std::string& line, size_t column, double factor) {
  std::istringstream cells(line);
  std::string cell;
  for (size_t i = 0; i <= column; ++i) std::getline(cells, cell, ',');
  return AddTo(line, column, (factor - 1) * std::stod(cell));
}

/// A point of points.csv that is neither the best nor the worst of all.
size_t PointBetween(const std::string& csv) {
  const std::vector<Row> rows = ReadPoints(csv);
  const auto [best, worst] = std::ranges::minmax_element(rows, {}, &Row::objective);
  for (size_t i = 0; i < rows.size(); ++i)
    if (rows[i].objective > best->objective && rows[i].objective < worst->objective) return i;
  throw std::logic_error("all alike");
}

TEST_F(AuditTest, AGoodFolderWithForcesPasses) {
  const Verdict verdict = Judged(MakeFolder({.forces = true}));
  EXPECT_TRUE(verdict.Holds()) << ToJson(verdict);
  EXPECT_EQ(verdict.objectives_recomputed, 12);
  EXPECT_EQ(verdict.bends_excused, 0);
}

TEST_F(AuditTest, AWrongObjectiveIsAnObjectiveError) {
  Texts texts = MakeFolder({.forces = true});
  EditLine(texts["out/points.csv"], 1 + PointBetween(texts["out/points.csv"]),
           [](const std::string& line) { return Scaled(line, 28, 1 + 1e-7); });
  EXPECT_EQ(Broken(texts), Names{"max_objective_error_relative"});
}

TEST_F(AuditTest, AnUncertaintyThatThePlanDidNotHaveIsAnObjectiveError) {
  for (const std::string stated : {"force_direction_deg: 20", "force_uncertainty_percent: 30"}) {
    Texts texts = MakeFolder({.forces = true});
    std::string& job = texts["out/job.yaml"];
    job.replace(job.find(stated) + stated.size(), 0, ".001");
    EXPECT_EQ(Broken(texts), Names{"max_objective_error_relative"}) << stated;
  }
}

TEST_F(AuditTest, AWrongForceShowsInObjectiveAndDeflection) {
  for (const size_t column : {5u, 6u, 7u}) {
    Texts texts = MakeFolder({.forces = true});
    EditLine(texts["out/deflection.csv"], 4,
             [&](const std::string& line) { return Scaled(line, column, 1 + 1e-5); });
    EXPECT_EQ(Broken(texts), (Names{"max_objective_error_relative", "max_deflection_error_relative"}))
        << column;
  }
}

TEST_F(AuditTest, AWrongDeflectionIsADeflectionError) {
  for (size_t column = 8; column < 15; ++column) {
    Texts texts = MakeFolder({.forces = true});
    EditLine(texts["out/deflection.csv"], 6,
             [&](const std::string& line) { return AddTo(line, column, 1e-5); });
    EXPECT_EQ(Broken(texts), Names{"max_deflection_error_relative"}) << column;
  }
}

TEST_F(AuditTest, ACutPointWithoutAForceIsMissed) {
  Texts texts = MakeFolder({.forces = true});
  std::string& csv = texts["out/deflection.csv"];
  csv.erase(csv.rfind('\n', csv.size() - 2) + 1);
  EXPECT_EQ(Broken(texts), Names{"missing_forces"});
  texts.erase("out/deflection.csv");
  std::filesystem::remove(Path("out/deflection.csv"));
  EXPECT_EQ(Broken(texts), Names{"missing_forces"});
}

TEST_F(AuditTest, AWrongSummaryIsASummaryError) {
  for (const std::string key : {"\"best\": ", "\"worst\": ", "\"halfway_deviation_max_mm\": "}) {
    Texts texts = MakeFolder({.forces = true});
    std::string& json = texts["out/summary.json"];
    json.replace(json.find(key) + key.size(), 0, "1");  // another digit in front
    EXPECT_EQ(Broken(texts), Names{"max_summary_error_relative"}) << key;
  }
}

TEST_F(AuditTest, ABendBeyondTheBoundMustBeThatOfAnUnchangedRotation) {
  const auto judged = [&](double rotation_deg, const std::string& bound) {
    Texts texts = MakeFolder({.rotation_deg = rotation_deg});
    const std::string stated = "max_halfway_deviation_mm: 5";
    std::string& job = texts["out/job.yaml"];
    job.replace(job.find(stated), stated.size(), "max_halfway_deviation_mm: " + bound);
    return Judged(texts);
  };
  // Ten steps, none of them straight to a nanometre; with the rotation unchanged that cannot be repaired.
  const Verdict even = judged(0, "1e-6");
  EXPECT_TRUE(even.Holds()) << ToJson(even);
  EXPECT_EQ(even.bends_excused, 10);
  // Two of them turn the tool: to it and back.
  const Verdict turned = judged(4, "1e-6");
  EXPECT_GT(turned["max_halfway_excess_mm"].value, 0.01);
  EXPECT_EQ(turned.bends_excused, 8);
  const double off = turned["max_halfway_excess_mm"].value;
  EXPECT_TRUE(judged(4, std::to_string(2 * off)).Holds());
  EXPECT_FALSE(judged(4, std::to_string(off / 2)).Holds());
}

TEST_F(AuditTest, APostInTheWayIsAnInterference) {
  EXPECT_EQ(Broken(MakeFolder({.fixture_in_way = true})), Names{"interferences"});
}

TEST_F(AuditTest, AWrongLineOfAProgramIsItsDeviation) {
  Texts texts = MakeFolder({});
  EditLine(texts["out/programs/krl/by_hand.src"], 7,
           [](const std::string& line) { return AddAfter(line, "Y ", 0.05); });
  EXPECT_EQ(Broken(texts), Names{"program_deviation_mm_krl"});

  texts = MakeFolder({});
  EditLine(texts["out/programs/sinumerik/by_hand.mpf"], 13,
           [](const std::string& line) { return AddAfter(line, "B=", 0.05); });
  EXPECT_EQ(Broken(texts), Names{"program_deviation_deg_sinumerik"});

  texts = MakeFolder({});
  EditLine(texts["out/programs/linuxcnc/by_hand.ngc"], 6,
           [](const std::string& line) { return AddAfter(line, "Z", 0.01); });
  EXPECT_EQ(Broken(texts), Names{"program_deviation_mm_linuxcnc"});
}

TEST_F(AuditTest, ToolPosesOfLinuxCncAreReadToo) {
  const Verdict verdict = Judged(MakeFolder({.cartesian = true}));
  EXPECT_TRUE(verdict.Holds()) << ToJson(verdict);
  EXPECT_LT(verdict["program_deviation_mm_linuxcnc"].value, 1e-3);
  EXPECT_LT(verdict["program_deviation_deg_linuxcnc"].value, 1e-3);
  const std::string name = "out/programs/linuxcnc/by_hand.ngc";
  for (const auto& [word, by, figure] : {std::tuple{"Y", 0.05, "program_deviation_mm_linuxcnc"},
                                         std::tuple{"A", 0.05, "program_deviation_deg_linuxcnc"}}) {
    Texts texts = MakeFolder({.cartesian = true});
    size_t line = 0, poses = 0;
    std::istringstream stream(texts[name]);
    for (std::string text; std::getline(stream, text) && poses < 3; ++line)
      poses += text.find(" F80") != std::string::npos;
    EditLine(texts[name], line - 1, [&](const std::string& text) { return AddAfter(text, word, by); });
    EXPECT_EQ(Broken(texts), Names{figure});
  }
}

TEST_F(AuditTest, AMissingEndOfAProgramIsADeviation) {
  Texts texts = MakeFolder({});
  std::string& krl = texts["out/programs/krl/by_hand.src"];
  krl.resize(krl.size() / 2);
  EXPECT_TRUE(Broken(texts).contains("program_deviation_mm_krl"));
}

/// plan.cbor.gz with one gap, from home by some joint angles to home.
std::string PlanWithLinkMove(const std::vector<Angles>& joints) {
  nlohmann::json gap = {
      {"from_pass", -1}, {"from_piece", -1}, {"to_pass", -1}, {"to_piece", -1}, {"planned", true}};
  for (const Angles& angles : joints) {
    std::array<double, 6> six;
    for (size_t i = 0; i < 6; ++i) six[i] = static_cast<double>(angles[i]);
    gap["joints"].push_back(six);
  }
  std::string bytes;
  nlohmann::json::to_cbor(nlohmann::json{{"gaps", {gap}}, {"passes", nlohmann::json::array()}}, bytes);
  return Gzip(bytes);
}

TEST_F(AuditTest, GapsAreJudgedFromThePlanWhereNoProgramIsInJointSpace) {
  const Angles home{0, -90 * kDegree, 90 * kDegree, 0, 0, 0};
  Angles above = home, folded = home;
  above[0] = 5 * kDegree;
  folded[1] = 20 * kDegree, folded[2] = 144 * kDegree;  // the spindle at the column
  for (const bool in_column : {false, true}) {
    Texts texts = MakeFolder({});
    texts.erase("out/programs/linuxcnc/by_hand.ngc");
    texts["out/plan.cbor.gz"] =
        PlanWithLinkMove(in_column ? std::vector{home, folded, home} : std::vector{home, above, home});
    EXPECT_EQ(Broken(texts), in_column ? Names{"interferences"} : Names{}) << in_column;
  }
}

TEST(Programs, ShortWaysAfterLongOnesAreFollowed) {
  // An arm of one joint, 1 m long: a step of 6.4 mm, then one of 2.2 mm in four parts.
  audit::Setup setup{};
  setup.sign.fill(1);
  setup.X_WB = setup.X_WP = Matrix4::Identity();
  setup.X_FT = Shift(0, 0, 1000);
  const std::vector<Real> way{0, 0.0064L, 0.00695L, 0.0075L, 0.00805L, 0.0086L, 0.015L};
  std::vector<Target> targets;
  std::vector<Row> rows;
  for (const Real angle : way) {
    const Angles angles{angle};
    targets.push_back({"way.ngc", static_cast<int>(targets.size()) + 1, angles, Tool(setup, angles)});
    if (angle > 0.0064L && angle < 0.0086L) continue;
    Row row{};
    row.point = static_cast<int>(rows.size());
    row.planned = true;
    row.position = row.normal = row.axis = row.feed_direction = Vector3::Zero();
    row.angles = angles;
    rows.push_back(row);
  }
  std::vector<Cut> cuts = CutsOf(rows, setup);
  ASSERT_EQ(cuts.size(), 1u);
  EXPECT_LT(static_cast<double>(Compare(targets, cuts, setup).position), 1e-3);
  targets[4].X_PT(2, 3) += 0.05L;
  std::vector<Cut> again = CutsOf(rows, setup);
  EXPECT_GT(static_cast<double>(Compare(targets, again, setup).position), 0.04);
}

// Whatever strategy laid it.
TEST(CutsOf, APieceThatReturnsToItsFirstPointIsClosed) {
  std::vector<Row> rows;
  for (int i = 0; i < 8; ++i) {
    Row row{};
    row.point = i;
    row.pass = i / 4;
    row.planned = true;
    row.position = Vector3(i % 4, i % 2, 0);
    rows.push_back(row);
  }
  const auto piece = [](int pass, bool closed) {
    return nlohmann::json{{"pass", pass}, {"piece", 0}, {"closed", closed}};
  };
  std::string bytes;
  const auto pass = [&](int number, bool closed) {
    return nlohmann::json{{"pieces", {piece(number, closed)}}};
  };
  nlohmann::json::to_cbor(nlohmann::json{{"passes", {pass(0, false), pass(1, true)}}}, bytes);
  MarkClosed(bytes, rows);
  const std::vector<Cut> cuts = CutsOf(rows, audit::Setup{});
  ASSERT_EQ(cuts.size(), 2u);
  EXPECT_FALSE(cuts[0].closed);
  EXPECT_TRUE(cuts[1].closed);
  EXPECT_EQ(CutMotions(cuts).size(), 3u + 4u);
}

// Whatever freedom of the job it comes from: one that the judge does not know has no range.
TEST_F(AuditTest, ALeanOutsideOfItsRangeIsALeanViolation) {
  Texts texts = MakeFolder({});
  std::string& points = texts["out/points.csv"];
  std::string told;
  for (size_t begin = 0, end = 0; (end = points.find('\n', begin)) != std::string::npos; begin = end + 1)
    told += points.substr(begin, end - begin) + (begin == 0 ? ",lead_deg,tilt_deg\n" : ",0,0\n");
  points = told;
  EXPECT_EQ(Broken(texts), Names{});
  points.replace(points.rfind(",0,0\n"), 5, ",5,0\n");
  EXPECT_EQ(Broken(texts), (Names{"lean_violations", "max_lean_error_deg"}));
}

/// Three points 10 mm apart: in each of the two steps the tool turns by 12.3° about its axis, which leans
/// over by 0.4° as well.
class TurningCut : public AuditTest {
 protected:
  TurningCut() {
    Judged(MakeFolder({}));  // writes it
    setup_ = ReadFolder(Path("out")).setup;
    X_WM_ = Tool(setup_, ReadFolder(Path("out")).rows[0].angles);
  }

  Matrix4 Pose(Real step) const {
    return X_WM_ * Shift(10 * step, 0, 0) * Turn(0, 0.4L * kDegree * step) * Turn(2, 12.3L * kDegree * step);
  }

  /// Half-way from the first to the last in one even turn.
  Matrix4 EvenMiddle() const {
    Matrix4 X = Pose(1);
    const Eigen::AngleAxis<Real> whole(Matrix3((Pose(0).inverse() * Pose(2)).block<3, 3>(0, 0)));
    X.block<3, 3>(0, 0) = Pose(0).block<3, 3>(0, 0) *
                          Eigen::AngleAxis<Real>(whole.angle() / 2, whole.axis()).toRotationMatrix();
    return X;
  }

  /// The deviation of a program from first to last point in one motion, deg.
  double Off(const std::string& controller, const Matrix4& middle) {
    Angles angles = ReadFolder(Path("out")).rows[0].angles;
    std::vector<Row> rows;
    for (const Matrix4& X : {Pose(0), middle, Pose(2)}) {
      Row row{};
      row.point = static_cast<int>(rows.size());
      row.planned = true;
      row.position = row.normal = row.axis = row.feed_direction = Vector3::Zero();
      row.angles = angles = Solve(setup_, X, angles);
      rows.push_back(row);
    }
    std::vector<Target> targets = ReadProgram(controller, OneMotion(setup_, Pose(0), Pose(2)), setup_);
    EXPECT_EQ(targets.size(), 2u);
    std::vector<Cut> cuts = CutsOf(rows, setup_);
    return static_cast<double>(Compare(targets, cuts, setup_).angle / kDegree);
  }

  audit::Setup setup_{};
  Matrix4 X_WM_;
};

TEST_F(TurningCut, LinSwivelsTheToolDirectionAndTurnsTheToolAboutIt) {
  EXPECT_LT(Off("krl", Pose(1)), 0.015);
  EXPECT_GT(Off("krl", EvenMiddle()), 0.04);
  setup_.krl_tool_direction = "z";  // across the tool's axis
  EXPECT_GT(Off("krl", Pose(1)), 0.04);
}

TEST_F(TurningCut, SinumerikSwivelsAndMayTurnEvenly) {
  EXPECT_GT(Off("sinumerik", EvenMiddle()), 0.04);
  EXPECT_GT(Off("sinumerik", Pose(1)), 0.04);
  setup_.sinumerik_turn_known = true;
  EXPECT_GT(Off("sinumerik", EvenMiddle()), 0.04);
  EXPECT_LT(Off("sinumerik", Pose(1)), 0.015);
}

}  // namespace
}  // namespace millpose::audit
