// SPDX-License-Identifier: GPL-3.0-or-later
// Parts that their clamps bend: laws of the bent plate, and drawn panels whose bending comes back.
#include "base/rotation.hpp"
#include "base/student.hpp"
#include "geometry/import/mesh_import.hpp"
#include "tests/base/tier.hpp"
#include "tests/geometry/panel.hpp"
#include "tests/geometry/shapes.hpp"

namespace millpose {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

PartBending Some(size_t modes, double mm) {
  PartBending bending;
  bending.origin = {10, -20, 5};
  bending.u = {300, 40, 0};
  bending.v = RotationAbout(bending.u.normalized(), 0.3) * Vector3d(-40, 300, 0) * 0.6;
  RandomStream random(43, 20);
  for (size_t i = 0; i < modes; ++i) bending.modes.push_back(mm * random.Normal());
  return bending;
}

// Gauss and Legendre's rule of four points is exact for what is looked at.
TEST(Bending, ModesStandAtRightAnglesToEachOtherAndToRigidMotion) {
  const double a = std::sqrt(3.0 / 7 - 2.0 / 7 * std::sqrt(1.2)),
               b = std::sqrt(3.0 / 7 + 2.0 / 7 * std::sqrt(1.2));
  const double wa = (18 + std::sqrt(30.0)) / 36, wb = (18 - std::sqrt(30.0)) / 36;
  const std::array<std::pair<double, double>, 4> rule = {{{-a, wa}, {a, wa}, {-b, wb}, {b, wb}}};
  PartBending bending = Some(kMostModes, 1);
  Eigen::Matrix<double, kMostModes + 3, kMostModes + 3> products;
  products.setZero();
  const auto values_at = [&](double u, double v) {
    const Vector3d p = bending.origin + u * bending.u + v * bending.v;
    Eigen::Matrix<double, kMostModes + 3, 1> values;
    values << 1, u, v, bending.ModeShifts(p).transpose() * bending.Across();
    return values;
  };
  for (const auto& [u, wu] : rule)
    for (const auto& [v, wv] : rule) products += wu * wv * values_at(u, v) * values_at(u, v).transpose();
  for (int i = 0; i < products.rows(); ++i)
    for (int j = 0; j < i; ++j) EXPECT_NEAR(products(i, j), 0, 1e-12) << i << ' ' << j;
  EXPECT_LT((values_at(1, 1).array() - 1).abs().maxCoeff(), 1e-12);
}

TEST(Bending, DerivativesAreThoseOfWhereItTakesPoints) {
  RandomStream random(43, 21);
  const PartBending bending = Some(kMostModes, 0.5);
  for (int trial = 0; trial < 50; ++trial) {
    const Vector3d p = bending.origin + random.Uniform(-1, 1) * bending.u +
                       random.Uniform(-1, 1) * bending.v + random.Uniform(-30, 30) * bending.Across();
    EXPECT_LT((bending.Unbent(bending.Bent(p)) - p).norm(), 1e-9);
    Matrix3d gradient;
    for (int k = 0; k < 3; ++k)
      gradient.col(k) =
          (bending.Bent(p + 1e-2 * Vector3d::Unit(k)) - bending.Bent(p - 1e-2 * Vector3d::Unit(k))) / 2e-2;
    EXPECT_LT((gradient - bending.Gradient(p)).cwiseAbs().maxCoeff(), 1e-8);
    const Vector3d n = NormalVector(random).normalized(), t = n.unitOrthogonal();
    const Matrix3d turn = bending.Turn(p, n);
    EXPECT_LT((turn.transpose() * turn - Matrix3d::Identity()).norm(), 1e-12);
    EXPECT_LT((turn * n - bending.BentNormal(p, n)).norm(), 1e-12);
    EXPECT_NEAR(bending.BentNormal(p, n).dot(bending.Gradient(p) * t), 0, 1e-12);  // stays across the surface
    // It turns as the plate does, but for squares of the slope and the surface's strain.
    EXPECT_LT((turn * t - t - bending.SmallTurn(p).cross(t)).norm(), 0.1 * bending.Slope(p) + 2e-3);
    EXPECT_LT((turn * n - n - bending.SmallTurn(p).cross(n)).norm(), 0.1 * bending.Slope(p) + 2e-3);
  }
}

TEST(Bending, ThePlatesFrameFollowsThePart) {
  RandomStream random(43, 22);
  const Eigen::Isometry3d X = SmallMove(random, 1000);
  const Triangles box = BoxShape({-100, 50, 20}, {500, 350, 30});
  const PartBending frame = PlateFrame(SoundMesh(box)), moved = PlateFrame(SoundMesh(Moved(box, X)));
  EXPECT_LT((frame.origin - Vector3d(200, 200, 25)).norm(), 1e-3);
  EXPECT_LT((frame.u - Vector3d(300, 0, 0)).norm(), 1e-3);
  EXPECT_LT((frame.v.cwiseAbs() - Vector3d(0, 150, 0)).norm(), 1e-3);
  EXPECT_LT((frame.Across() - Vector3d::UnitZ()).norm(), 1e-6);
  EXPECT_LT((moved.origin - X * frame.origin).norm(), 1e-3);
  EXPECT_NEAR(std::abs(moved.u.dot(X.linear() * frame.u)), 300.0 * 300, 1);
  EXPECT_NEAR(std::abs(moved.v.dot(X.linear() * frame.v)), 150.0 * 150, 1);
  // Of a square one nobody tells the axes: they are the part's own.
  const PartBending square = PlateFrame(SoundMesh(BoxShape({0, 0, 0}, {80, 80, 4})));
  EXPECT_LT((square.u - Vector3d(40, 0, 0)).norm(), 1e-3);
}

// A box has twelve triangles: bent, its sides follow the plate, its volume stays, it is whole.
TEST(Bending, ABentMeshLiesOnTheBentSurface) {
  constexpr double kWithin = 1e-3;
  Triangles box = BoxShape({-300, -200, 0}, {300, 200, 6});
  box.source.assign(box.faces.size(), 0);
  for (size_t i = 0; i < box.source.size(); ++i) box.source[i] = static_cast<int>(i);
  box.source_faces.resize(box.faces.size());
  PartBending bending = PlateFrame(SoundMesh(box));
  EXPECT_EQ(BentTriangles(box, bending, kWithin).faces, box.faces);
  bending.modes = {0.8, -0.3, 0.5, 0.1, -0.2, 0.1};
  const Triangles bent = BentTriangles(box, bending, kWithin);
  EXPECT_GT(bent.faces.size(), 200u);
  EXPECT_LT(bent.faces.size(), 20000u);
  ASSERT_EQ(bent.source.size(), bent.faces.size());
  const Mesh whole{bent};
  double volume = 0;
  for (int f = 0; f < whole.face_count(); ++f) {
    for (int k = 0; k < 3; ++k) EXPECT_GE(whole.Neighbour(f, k), 0);
    const Vector3d &a = whole.Corner(f, 0), &b = whole.Corner(f, 1), &c = whole.Corner(f, 2);
    volume += a.dot(b.cross(c)) / 6;
    // Each triangle is a part of the one it comes from.
    const auto& source = box.faces[static_cast<size_t>(bent.source[static_cast<size_t>(f)])];
    const Vector3d corner = box.vertices[static_cast<size_t>(source[0])];
    const Vector3d n = (box.vertices[static_cast<size_t>(source[1])] - corner)
                           .cross(box.vertices[static_cast<size_t>(source[2])] - corner)
                           .normalized();
    for (const Vector3d& p : {a, b, c}) EXPECT_LT(std::abs(n.dot(bending.Unbent(p) - corner)), 1e-8);
    for (const Vector3d& p : {Vector3d((a + b + c) / 3), Vector3d((a + b) / 2)})
      EXPECT_LT(std::abs(n.dot(bending.Unbent(p) - corner)), 2 * kWithin);
  }
  EXPECT_NEAR(volume / (600.0 * 400 * 6), 1, 1e-3);
}

/// The panel with drawn modes, some `mm` each.
PartBending DrawBending(RandomStream& random, size_t modes, double mm) {
  PartBending bending = PlateFrame(ThePanel().part.mesh());
  for (size_t i = 0; i < modes; ++i)
    bending.modes.push_back(mm * random.Uniform(0.5, 1.5) * (random.Below(2) == 0 ? -1 : 1));
  return bending;
}

std::optional<BentRegistration> Ask(const Drawn& drawn) {
  const Registration rigid = Register(ThePanel().part, drawn.points, drawn.start);
  return RegisterBent(ThePanel().part, drawn.points, rigid);
}

TEST(BentPanel, IsFoundExactlyWhereNothingDisturbs) {
  RandomStream random(43, 23);
  for (const size_t modes : {3u, 6u}) {
    const PartBending bending = DrawBending(random, modes, 0.5);
    Drawn drawn = Draw(random, 80, 30, 0, 3, bending);
    for (ProbedPoint& point : drawn.points) point.sd = 0.01;
    const auto bent = Ask(drawn);
    ASSERT_TRUE(bent);
    EXPECT_LT(bent->p, 1e-10);
    EXPECT_EQ(bent->found.bending->modes.size(), modes);
    EXPECT_LT(Off(ThePanel().skin, drawn.X_true, bent->found.X, bending, bent->found.bending), 2e-4);
    for (size_t i = 0; i < modes; ++i) EXPECT_NEAR(bent->found.bending->modes[i], bending.modes[i], 5e-4);
    EXPECT_NEAR(bent->largest, LargestBending(ThePanel().part.mesh().triangles(), bending).first, 1e-3);
  }
}

// Each coefficient lies within its interval as often as said, the face within its bound, and the face is
// nearer than a rigid part's.
TEST(BentPanel, ModesLieWithinTheirIntervalsAsOftenAsSaid) {
  const int draws = OfTier(60, 4000);
  RandomStream random(43, 24);
  int within = 0, told = 0, found = 0, face_within = 0;
  std::vector<double> rigid_off, bent_off;
  for (int trial = 0; trial < draws; ++trial) {
    const PartBending bending = DrawBending(random, 3, 0.4);
    const Drawn drawn = Draw(random, 40, 12, 0.06, 3, bending);
    const Registration rigid = Register(ThePanel().part, drawn.points, drawn.start);
    const auto bent = RegisterBent(ThePanel().part, drawn.points, rigid);
    if (!bent) continue;  // so few points may leave an end of the panel untold
    ++found;
    rigid_off.push_back(Off(ThePanel().milled, drawn.X_true, rigid.X, bending));
    bent_off.push_back(Off(ThePanel().milled, drawn.X_true, bent->found.X, bending, bent->found.bending));
    const FaceError error =
        ErrorOfFace(bent->found.covariance, bent->found.centre, ThePanel().milled, bent->found.Bending());
    face_within += bent_off.back() <= error.off_95 ? 1 : 0;
    for (Eigen::Index i = 0; i < 3; ++i) {
      const double off =
          bent->found.bending->modes[static_cast<size_t>(i)] - bending.modes[static_cast<size_t>(i)];
      within += std::abs(off) <= kNormal95 * std::sqrt(bent->found.covariance(6 + i, 6 + i)) ? 1 : 0;
      ++told;
    }
  }
  const double share = 100.0 * within / told, face_share = 100.0 * face_within / found;
  RecordProperty("coverage_percent", fmt::format("{:.1f}", share));
  RecordProperty("face_coverage_percent", fmt::format("{:.1f}", face_share));
  RecordProperty("median_rigid_mm", fmt::format("{:.3f}", Median(rigid_off)));
  RecordProperty("median_bent_mm", fmt::format("{:.3f}", Median(bent_off)));
  EXPECT_GE(found, draws * 95 / 100);
  EXPECT_GE(share, OfTier(900, 930) / 10.0);
  EXPECT_LE(share, OfTier(1000, 970) / 10.0);
  EXPECT_GE(face_share, OfTier(880, 930) / 10.0);
  EXPECT_LE(Median(bent_off), 0.25 * Median(rigid_off));
}

TEST(BentPanel, ARigidOneIsSeldomTakenAsBent) {
  const int draws = OfTier(150, 1500);
  RandomStream random(43, 25);
  int taken = 0;
  for (int trial = 0; trial < draws; ++trial) taken += Ask(Draw(random, 40, 12, 0.06)) ? 1 : 0;
  RecordProperty("taken_percent", fmt::format("{:.2f}", 100.0 * taken / draws));
  EXPECT_LE(taken, draws * 2 / 100);
}

// A panel that is only twisted at one end needs more modes than three, and gets them.
TEST(BentPanel, AsManyModesAsThePointsAskFor) {
  RandomStream random(43, 26);
  PartBending bending = PlateFrame(ThePanel().part.mesh());
  bending.modes = {0, 0, 0, 0, 0.3};
  const auto bent = Ask(Draw(random, 60, 16, 0.04, 3, bending));
  ASSERT_TRUE(bent);
  EXPECT_EQ(bent->found.bending->modes.size(), 5u);
  EXPECT_NEAR(bent->found.bending->modes[4], 0.3, 0.1);
}

// Twenty points do not tell nine unknowns thrice, nor do any number of them that look at a corner.
TEST(BentPanel, TooFewPointsAreNeverGivenModes) {
  RandomStream random(43, 27);
  for (int trial = 0; trial < OfTier(20, 100); ++trial) {
    const PartBending bending = DrawBending(random, 3, 1);
    EXPECT_FALSE(Ask(Draw(random, 18, 8, 0.02, 3, bending)));
    Drawn drawn = Draw(random, 400, 20, 0.02, 3, bending);
    const Eigen::Isometry3d back = drawn.X_true.inverse(Eigen::Isometry);
    const PartBending frame = PlateFrame(ThePanel().part.mesh());
    std::erase_if(drawn.points, [&](const ProbedPoint& point) {
      const Vector3d p = back * point.measured - frame.origin;
      return std::max(p.dot(frame.u) / frame.u.squaredNorm(), p.dot(frame.v) / frame.v.squaredNorm()) > -0.2;
    });
    EXPECT_GT(drawn.points.size(), 30u);
    EXPECT_FALSE(Ask(drawn));
  }
}

// A chip under the ball is named on a bent panel too, and a rigid panel with one is not bent by it.
TEST(BentPanel, AChipIsNoBending) {
  RandomStream random(43, 28);
  int named = 0, bent_by_chip = 0;
  const int draws = OfTier(20, 200);
  for (int trial = 0; trial < draws; ++trial) {
    const PartBending bending = DrawBending(random, 3, 0.4);
    for (const bool is_bent : {true, false}) {
      Drawn drawn = Draw(random, 40, 12, 0.06, 3, is_bent ? bending : PartBending{});
      drawn.points[3].measured +=
          drawn.X_true.linear() * drawn.start.linear().transpose() * *drawn.points[3].normal;
      const auto bent = Ask(drawn);
      if (is_bent) named += bent && bent->found.residuals[3].outlier ? 1 : 0;
      if (!is_bent) bent_by_chip += bent ? 1 : 0;
    }
  }
  EXPECT_GE(named, draws * 9 / 10);
  EXPECT_LE(bent_by_chip, std::max(1, draws * 2 / 100));
}

TEST(BentPanel, AScanIsFoundInSeconds) {
  RandomStream random(43, 30);
  const auto count = static_cast<size_t>(OfTier(4000, 100000));
  const PartBending bending = DrawBending(random, 3, 0.4);
  const auto bent = Ask(Draw(random, count * 9 / 10, count / 10, 0.1, 0, bending));
  ASSERT_TRUE(bent);
  for (size_t i = 0; i < 3; ++i) EXPECT_NEAR(bent->found.bending->modes[i], bending.modes[i], 0.03);
}

TEST(BentPanel, AnyNumberOfThreadsFindsTheSameBits) {
  RandomStream random(43, 29);
  const Drawn drawn = Draw(random, 2500, 500, 0.1, 3, DrawBending(random, 4, 0.2));
  const Registration rigid = Register(ThePanel().part, drawn.points, drawn.start);
  const auto one = RegisterBent(ThePanel().part, drawn.points, rigid, 1);
  const auto two = RegisterBent(ThePanel().part, drawn.points, rigid, 2);
  ASSERT_TRUE(one && two);
  EXPECT_EQ(one->found.X.matrix(), two->found.X.matrix());
  EXPECT_EQ(one->found.bending->modes, two->found.bending->modes);
  EXPECT_EQ(one->found.covariance, two->found.covariance);
  EXPECT_EQ(one->p, two->p);
}

}  // namespace
}  // namespace millpose
