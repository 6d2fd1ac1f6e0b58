// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/pass/face_sequence.hpp"

#include <gtest/gtest.h>

#include <random>

namespace millpose {
namespace {

using Candidates = std::vector<std::vector<PassFace>>;

JobFace Of(const Candidates& candidates, const std::vector<size_t>& chosen,
           const std::vector<NeighbourPieces>& neighbours) {
  std::vector<const PassFace*> faces;
  for (size_t i = 0; i < chosen.size(); ++i) faces.push_back(&candidates[i][chosen[i]]);
  return ValueOf(faces, neighbours);
}

/// Every sequence there is.
JobFace BestOfAll(const Candidates& candidates, const std::vector<NeighbourPieces>& neighbours,
                  double limit) {
  std::vector<size_t> chosen(candidates.size(), 0);
  JobFace best = Of(candidates, chosen, neighbours);
  for (;;) {
    size_t i = 0;
    while (i < chosen.size() && ++chosen[i] == candidates[i].size()) chosen[i++] = 0;
    if (i == chosen.size()) return best;
    const JobFace value = Of(candidates, chosen, neighbours);
    if (IsBetter(value, best, limit)) best = value;
  }
}

TEST(ChooseSequence, IsAsGoodAsTheBestOfAllSequences) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> between(-1, 1);
  std::uniform_int_distribution<size_t> count(1, 4), pieces(1, 2);
  for (int trial = 0; trial < 300; ++trial) {
    Candidates candidates(5);
    std::vector<NeighbourPieces> neighbours;
    for (size_t i = 0; i < candidates.size(); ++i) {
      candidates[i].resize(count(random));
      const size_t of = pieces(random);
      for (PassFace& face : candidates[i]) {
        face.resize(of);
        for (FaceChoiceFigures& piece : face) {
          piece.middle = between(random);
          piece.worst = std::abs(piece.middle) + 0.3 * std::abs(between(random));
          piece.marks = 1 + between(random);
          piece.count = trial % 5 == 0 && of == 2 ? 0 : 3;
        }
      }
      if (i == 0) continue;
      for (size_t a = 0; a < candidates[i - 1][0].size(); ++a)
        for (size_t b = 0; b < of; ++b)
          if (between(random) < 0.5) neighbours.push_back({i - 1, a, i, b});
    }
    for (const double limit : {0.0, 0.5, 3.0}) {
      const std::vector<size_t> chosen = ChooseSequence(candidates, neighbours, limit);
      ASSERT_EQ(chosen.size(), candidates.size());
      const JobFace found = Of(candidates, chosen, neighbours),
                    best = BestOfAll(candidates, neighbours, limit);
      EXPECT_DOUBLE_EQ(std::max(found.Largest(), limit), std::max(best.Largest(), limit));
      EXPECT_NEAR(found.marks, best.marks, 1e-12);
    }
  }
}

TEST(ChooseSequence, IsEmptyWhereAPassHasNoCandidate) {
  EXPECT_TRUE(ChooseSequence({{PassFace(1)}, {}}, {}, 0).empty());
  EXPECT_TRUE(ChooseSequence({}, {}, 0).empty());
}

/// Passes along x at these heights of y, mm; `piece` cuts from x = 0 to 100 unless told otherwise.
PassResult AlongX(int number, double y, const std::vector<std::pair<double, double>>& cuts, bool back) {
  PassResult pass;
  pass.pass = number;
  for (const auto& [from, to] : cuts) {
    const int first = static_cast<int>(pass.points.size());
    for (double x = from; x <= to; x += 10) {
      PlannedPoint planned;
      planned.point.position = {x, y, 0};
      planned.point.feed = Eigen::Vector3d::UnitX() * (back ? -1 : 1);
      planned.point.engagement.side = CutSide::kDown;
      pass.points.push_back(planned);
    }
    pass.pieces.push_back({number, static_cast<int>(pass.pieces.size()), first,
                           static_cast<int>(pass.points.size()) - 1, false});
  }
  return pass;
}

TEST(FindNeighbourPieces, AreTheNextOnesToEitherSideAndNoFartherThanTheCutterIsWide) {
  const std::vector<PassResult> passes = {AlongX(0, 0, {{0, 100}}, false),
                                          AlongX(1, 6, {{0, 30}, {70, 100}}, true),
                                          AlongX(2, 12, {{0, 100}}, false), AlongX(3, 40, {{0, 100}}, true)};
  const auto pairs = [&](size_t first, double width) {
    std::vector<std::array<size_t, 4>> all;
    for (const NeighbourPieces& pair : FindNeighbourPieces(passes, first, width))
      all.push_back({pair.pass, pair.piece, pair.other_pass, pair.other_piece});
    return all;
  };
  using Pairs = std::vector<std::array<size_t, 4>>;
  // Where pass 1 does not cut, 0 and 2 lie side by side.
  EXPECT_EQ(pairs(0, 20), (Pairs{{0, 0, 1, 0}, {0, 0, 1, 1}, {0, 0, 2, 0}, {1, 0, 2, 0}, {1, 1, 2, 0}}));
  EXPECT_EQ(pairs(1, 20), (Pairs{{1, 0, 2, 0}, {1, 1, 2, 0}}));
  EXPECT_EQ(pairs(0, 5), Pairs{});
  EXPECT_EQ(pairs(2, 30), (Pairs{{2, 0, 3, 0}}));
}

}  // namespace
}  // namespace millpose
