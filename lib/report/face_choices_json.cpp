// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/face_choices_json.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace millpose {
namespace {

using FaceObject = nlohmann::ordered_json;

constexpr double kMicrometresOf = 1e3;  // a mm

/// Of all pieces.
struct WholeFace {
  double worst = 0, marks = 0, step = 0;
};

WholeFace WholeOf(const std::vector<FaceChoice>& faces, FaceChoiceFigures FaceChoice::*at) {
  WholeFace whole;
  for (const FaceChoice& choice : faces) {
    const FaceChoiceFigures& of = choice.*at;
    if (of.count == 0) continue;
    whole.worst = std::max(whole.worst, of.worst);
    whole.marks += of.marks;
    whole.step = std::max(whole.step, of.step);
  }
  return whole;
}

FaceObject WholeJson(const WholeFace& whole) {
  return {{"worst_um", kMicrometresOf * whole.worst},
          {"marks_sum_um", kMicrometresOf * whole.marks},
          {"step_between_passes_um", kMicrometresOf * whole.step}};
}

FaceObject FiguresJson(const FaceChoiceFigures& figures) {
  return {{"worst_um", kMicrometresOf * figures.worst},
          {"mean_um", figures.count > 0 ? FaceObject(kMicrometresOf * figures.sum / figures.count)
                                        : FaceObject(nullptr)},
          {"level_um", kMicrometresOf * figures.middle},
          {"step_um", kMicrometresOf * figures.step},
          {"marks_sum_um", kMicrometresOf * figures.marks},
          {"crossings", figures.crossings}};
}

std::ptrdiff_t CountOf(const std::vector<FaceChoice>& faces, FaceWay way) {
  return std::ranges::count(faces, way, &FaceChoice::way);
}

}  // namespace

nlohmann::ordered_json FaceChoicesJson(const std::vector<FaceChoice>& faces) {
  if (faces.empty()) return nullptr;
  FaceObject pieces = FaceObject::array(), ways = FaceObject::object();
  for (const auto& [word, way] : kFaceWayWords) ways[std::string(word)] = CountOf(faces, way);
  for (const FaceChoice& choice : faces)
    pieces.push_back({{"pass", choice.pass},
                      {"piece", choice.piece},
                      {"way", std::string(WordOf(kFaceWayWords, choice.way))},
                      {"before", FiguresJson(choice.before)},
                      {"after", FiguresJson(choice.after)}});
  return {{"before", WholeJson(WholeOf(faces, &FaceChoice::before))},
          {"after", WholeJson(WholeOf(faces, &FaceChoice::after))},
          {"ways", ways},
          {"pieces", pieces}};
}

std::string FaceChoicesText(const std::vector<FaceChoice>& faces) {
  const WholeFace before = WholeOf(faces, &FaceChoice::before), after = WholeOf(faces, &FaceChoice::after);
  return fmt::format(
      "force and lost motion displace by at most {:.3g} µm along the normal ({:.3g} µm by the points' own "
      "objective), neighbouring passes step by {:.3g} µm ({:.3g} µm), marks {:.0f} µm summed ({:.0f} µm); "
      "pieces: {} searched, {} at a fixed rotation, {} as "
      "planned",
      kMicrometresOf * after.worst, kMicrometresOf * before.worst, kMicrometresOf * after.step,
      kMicrometresOf * before.step, kMicrometresOf * after.marks, kMicrometresOf * before.marks,
      CountOf(faces, FaceWay::kSearched), CountOf(faces, FaceWay::kFixed), CountOf(faces, FaceWay::kPlanned));
}

}  // namespace millpose
