// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/pipeline/stages/face_candidates.hpp"

namespace millpose {
namespace {

constexpr size_t kMostMixed = 100;  // candidates of a pass that are mixed with any of its neighbours

}  // namespace

PassFace FaceOf(const PlannedFace& planned) {
  PassFace face;
  for (const FaceChoice& choice : planned.choices) face.push_back(choice.after);
  return face;
}

double WorstOf(const PlannedFace& planned) {
  double worst = 0;
  for (const FaceChoice& choice : planned.choices) worst = std::max(worst, choice.after.worst);
  return worst;
}

double MarksOf(const PlannedFace& planned) {
  double marks = 0;
  for (const FaceChoice& choice : planned.choices) marks += choice.after.marks;
  return marks;
}

std::vector<std::vector<size_t>> MixedCandidates(
    const std::vector<std::vector<FaceCandidateOfPass>>& candidates, double most) {
  std::vector<std::vector<size_t>> mixed(candidates.size());
  for (size_t i = 0; i < candidates.size(); ++i) {
    std::vector<size_t> fixed;
    for (size_t c = 0; c < candidates[i].size(); ++c) {
      const FaceCandidateOfPass& candidate = candidates[i][c];
      if (!candidate.fixed)
        mixed[i].push_back(c);
      else if (std::ranges::all_of(candidate.face, [&](const auto& piece) { return piece.worst < most; }))
        fixed.push_back(c);
    }
    std::ranges::stable_sort(fixed, {}, [&](size_t c) { return candidates[i][c].face[0].middle; });
    const size_t every = 1 + fixed.size() / kMostMixed;
    for (size_t k = 0; k < fixed.size(); k += every) mixed[i].push_back(fixed[k]);
  }
  return mixed;
}

}  // namespace millpose
