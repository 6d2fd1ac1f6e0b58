// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/smoothing/smoothing.hpp"

#include <limits>

#include "base/decompositions.hpp"
#include "machine/motion/line.hpp"
#include "planning/smoothing/box_step.hpp"
#include "tests/planning/pass/rough_row.hpp"

namespace millpose {
namespace {

TEST(SmoothPath, HalvesTheAccelerationsOfStairsAtLittleLoss) {
  RoughRow course(60, 10, Stairs);
  const double before = course.Rms(), objective = course.Objective();
  const std::vector<PathNode> start = course.path;
  const SmoothOptions options = course.Options();
  SmoothPath(course.scorers, course.points, course.ranges, options, course.path);
  EXPECT_LT(course.Rms(), 0.25 * before);
  EXPECT_LE(course.Objective(), 1.01 * objective);
  for (size_t t = 0; t < start.size(); ++t) {
    const PathNode& node = course.path[t];
    const Candidate candidate = course.scorers[t].ScoreOne(node.freedoms, node.branch);
    EXPECT_EQ(candidate.obstacle, Infeasibility::kNone);
    EXPECT_LT((candidate.q - node.q).cwiseAbs().maxCoeff(), 1e-12);
    EXPECT_EQ(candidate.objective, node.objective);
    if (t > 0) {
      EXPECT_LE((node.q - course.path[t - 1].q).cwiseAbs().maxCoeff(), DegToRad(5));
    }
  }
  // The same again gives the same bits.
  std::vector<PathNode> again = start;
  SmoothPath(course.scorers, course.points, course.ranges, options, again);
  for (size_t t = 0; t < start.size(); ++t) EXPECT_EQ(again[t].q, course.path[t].q);
}

// A place that stands is neither scored nor judged again.
TEST(FreedomCourse, JudgesMovedPlacesAsIfAllWereNew) {
  for (const bool closed : {false, true}) {
    RoughRow row(30, 10, Stairs);
    SmoothOptions options = row.Options();
    const FreedomCourse course(row.scorers, row.points, row.path, closed, {options.max_step});
    std::vector<CoursePlace> places = course.Start(row.ranges);
    course.Judge(places);
    std::vector<double> x;
    for (size_t t = 0; t < places.size(); ++t)
      x.push_back(places[t].x + (t % 7 == 0 || t == 29 ? DegToRad(0.1) : 0.0));
    std::vector<CoursePlace> moved = course.Moved(x, row.ranges, places);
    const Merit merit = course.Judge(moved);
    EXPECT_NE(moved[7].q, places[7].q);
    std::vector<CoursePlace> fresh = moved;
    for (CoursePlace& place : fresh) place.judged = false, place.off.setZero();
    const Merit anew = course.Judge(fresh);
    EXPECT_EQ(merit.square, anew.square);
    EXPECT_EQ(merit.violation, anew.violation);
    for (size_t t = 0; t < course.motions(); ++t) EXPECT_EQ(moved[t].off, fresh[t].off) << t;
  }
}

TEST(SmoothPath, LosesNoMoreThanAllowed) {
  double last = std::numeric_limits<double>::infinity();
  for (const double loss : {0.0, 0.001, 0.01, 0.1}) {
    // A jump that is cheaper to keep than to spread.
    RoughRow course(40, 10, [](int t) { return DegToRad(t < 20 ? 0 : 3); });
    SmoothOptions options = course.Options();
    options.loss = loss;
    SmoothPath(course.scorers, course.points, course.ranges, options, course.path);
    EXPECT_LE(course.Objective(), (1 + loss) * options.before.objective * (1 + 1e-12));
    EXPECT_LE(course.Rms(), last * 1.05);  // more may be given, more is gained
    last = course.Rms();
  }
}

TEST(SmoothPath, SaysWithWhichWeightItCameOut) {
  RoughRow course(60, 10, Stairs);
  SmoothOptions options = course.Options();
  const auto smooth = [&](std::vector<PathNode> path, double weight) {
    options.weight = weight;
    const Smoothed smoothed = SmoothPath(course.scorers, course.points, course.ranges, options, path);
    return std::pair(smoothed.weight, std::move(path));
  };
  const auto square = [&](const std::vector<PathNode>& path) {
    return MeasurePath(course.scorers, course.points, options, path).square;
  };
  const auto [weight, found] = smooth(course.path, 0);
  ASSERT_GT(weight, 0);
  const double least = square(found);
  // With it the path gets no worse, with much more for the objective it would be another.
  const double again = square(smooth(found, weight).second);
  EXPECT_LE(again, least);
  EXPECT_GT(again, 0.5 * least);
  EXPECT_GT(square(smooth(course.path, 1000 * weight).second), 1.2 * least);
  EXPECT_EQ(smooth(course.path, weight).first, weight);
}

TEST(SmoothPath, KeepsToItsRanges) {
  RoughRow course(60, 10, Stairs);
  for (size_t t = 0; t < course.path.size(); ++t) {
    const double value = course.path[t].freedoms[0];
    course.ranges[t] = t % 10 == 0 ? FreedomRange{value, value} : FreedomRange{value, 10};  // one side only
  }
  const std::vector<PathNode> start = course.path;
  const double before = course.Rms();
  SmoothPath(course.scorers, course.points, course.ranges, course.Options(), course.path);
  for (size_t t = 0; t < start.size(); ++t) {
    EXPECT_GE(course.path[t].freedoms[0], start[t].freedoms[0]);
    if (t % 10 == 0) {
      EXPECT_EQ(course.path[t].q, start[t].q);
    }
  }
  EXPECT_LT(course.Rms(), before);
}

TEST(SmoothPath, RepairsMotionsThatDeviateHalfway) {
  RoughRow course(60, 10, [](int t) { return DegToRad(std::clamp(4.0 * (t - 28), 0.0, 16.0)); });
  const auto deviation = [&] {
    const Carrier carrier{course.problem.arm, course.problem.X_WB, course.problem.X_FT};
    double most = 0;
    for (size_t t = 1; t < course.path.size(); ++t) {
      most = std::max(most, HalfwayDeviation(carrier, course.path[t - 1].q, course.path[t].q).position);
    }
    return most;
  };
  SmoothOptions options = course.Options();
  options.max_deviation = 0.25 * deviation();
  options.loss = 0.05;
  SmoothPath(course.scorers, course.points, course.ranges, options, course.path);
  EXPECT_LE(deviation(), options.max_deviation);
}

TEST(SmoothPath, LetsNoDeviationGrowThatItCannotRepair) {
  RoughRow course(40, 10, [](int t) { return DegToRad(std::clamp(4.0 * (t - 18), 0.0, 16.0)); });
  const Carrier carrier{course.problem.arm, course.problem.X_WB, course.problem.X_FT};
  const auto deviation = [&](size_t t) {
    return HalfwayDeviation(carrier, course.path[t].q, course.path[t + 1].q).position;
  };
  std::vector<double> before;
  for (size_t t = 0; t + 1 < course.path.size(); ++t) before.push_back(deviation(t));
  SmoothOptions options = course.Options();
  options.max_deviation = 0.01;
  options.loss = 0.001;
  const double rms = course.Rms();
  SmoothPath(course.scorers, course.points, course.ranges, options, course.path);
  for (size_t t = 0; t + 1 < course.path.size(); ++t) {
    EXPECT_LE(deviation(t), std::max(options.max_deviation, before[t] / 0.95) + 1e-9) << t;
  }
  EXPECT_LE(course.Objective(), 1.001 * options.before.objective * (1 + 1e-12));
  EXPECT_LE(course.Rms(), rms);
}

// Bands with rows that reach back to the first columns, as a ring's last ones do.
TEST(EnvelopeMatrix, SolvesAsADenseMatrixDoes) {
  RandomStream random(6, 0);
  for (int round = 0; round < 100; ++round) {
    const size_t count = 1 + random.Below(30);
    std::vector<size_t> first(count);
    for (size_t i = 0; i < count; ++i)
      first[i] = i + 4 > count && random.Below(2) ? random.Below(static_cast<int>(i) + 1)
                                                  : i - std::min<size_t>(i, random.Below(3));
    EnvelopeMatrix matrix(first);
    Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(count, count);
    for (size_t i = 0; i < count; ++i)
      for (size_t k = first[i]; k <= i; ++k)
        dense(i, k) = dense(k, i) = matrix.At(i, k) = i == k ? 40 : random.Normal();
    std::vector<double> x(count), product(count, 1.0);
    for (double& value : x) value = random.Normal();
    const Eigen::VectorXd right = Eigen::Map<Eigen::VectorXd>(x.data(), count);
    matrix.AddProduct(x, product);
    EXPECT_LT(
        (Eigen::Map<Eigen::VectorXd>(product.data(), count) - Eigen::VectorXd::Ones(count) - dense * right)
            .norm(),
        1e-10);
    ASSERT_TRUE(matrix.Factor());
    matrix.Solve(x);
    EXPECT_LT((Eigen::Map<Eigen::VectorXd>(x.data(), count) - SolvePositive(dense, right)).norm(), 1e-12);
  }
  EnvelopeMatrix flat({0, 0});
  flat.At(0, 0) = flat.At(1, 0) = flat.At(1, 1) = 1;
  EXPECT_FALSE(flat.Factor()) << "two equal rows";
}

TEST(BoxLeastSquares, MeetsTheConditionsOfItsLeast) {
  RandomStream random(5, 0);
  int bound = 0;
  for (int round = 0; round < 200; ++round) {
    const size_t count = 3 + random.Below(20);
    BoxLeastSquares squares(count);
    Eigen::MatrixXd H = Eigen::MatrixXd::Zero(count, count);
    Eigen::VectorXd g = Eigen::VectorXd::Zero(count);
    for (size_t t = 0; t < count; ++t) {  // round the end
      const std::array<size_t, 3> at{t, (t + 1) % count, (t + 2) % count};
      const std::array<double, 3> c{random.Normal(), random.Normal(), random.Normal()};
      const double weight = random.Uniform(0.5, 2), residual = random.Normal();
      squares.Add<3>(weight, residual, {{{at[0], c[0]}, {at[1], c[1]}, {at[2], c[2]}}});
      for (int i = 0; i < 3; ++i) {
        g[at[i]] += 2 * weight * residual * c[i];
        for (int k = 0; k < 3; ++k) H(at[i], at[k]) += 2 * weight * c[i] * c[k];
      }
      squares.AddCurve(t, 0.1, 1);
      g[t] += 0.1, H(t, t) += 1;
    }
    H.diagonal().array() += 1e-9 * H.diagonal().maxCoeff();
    std::vector<double> lower, upper;
    for (size_t t = 0; t < count; ++t) {
      lower.push_back(-random.Uniform(0, 0.4));
      upper.push_back(random.Below(4) ? random.Uniform(0, 0.4) : 0.0);
    }
    const std::vector<double> delta = squares.Solve(lower, upper, 1e-9);
    const Eigen::VectorXd slopes = H * Eigen::Map<const Eigen::VectorXd>(delta.data(), count) + g;
    for (size_t t = 0; t < count; ++t) {
      EXPECT_GE(delta[t], lower[t]);
      EXPECT_LE(delta[t], upper[t]);
      const bool below = delta[t]<upper[t], above = delta[t]> lower[t];
      bound += below != above;
      if (below && above) {
        EXPECT_NEAR(slopes[t], 0, 1e-7);
      } else if (above) {
        EXPECT_LE(slopes[t], 1e-7);
      } else if (below) {
        EXPECT_GE(slopes[t], -1e-7);
      }
    }
  }
  EXPECT_GT(bound, 200);
}

}  // namespace
}  // namespace millpose
