// SPDX-License-Identifier: GPL-3.0-or-later
#include "identify_compliances.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/units.hpp"

namespace millpose {
namespace {

using Json = nlohmann::ordered_json;

/// "tilting of link 3", "a base that moves"
std::string NameOf(const ComplianceStep& step) {
  switch (step.kind) {
    case ComplianceStep::Kind::kTilting:
      return fmt::format("tilting of link {}", step.link);
    case ComplianceStep::Kind::kBase:
      return "a base that moves";
    case ComplianceStep::Kind::kLostMotion:
      return "lost motion of joints";
    case ComplianceStep::Kind::kPayload:
      return "a payload";
  }
  return {};
}

/// "joint springs, tilting of link 3, lost motion of joints"
std::string NameOf(const ComplianceModel& model) {
  std::string name = "joint springs";
  for (const ComplianceStep& step : model.steps) name += ", " + NameOf(step);
  return name;
}

/// "link 3 about x", "base along z", "lost motion A2"
std::string NameOf(const Give& give) {
  constexpr const char* kAxes[] = {"x", "y", "z"};
  if (give.kind == Give::Kind::kTakesUp) return fmt::format("lost motion A{}", give.link);
  return fmt::format("{} {} {}", give.link == 0 ? std::string("base") : fmt::format("link {}", give.link),
                     give.kind == Give::Kind::kMoves ? "along" : "about", kAxes[give.axis]);
}

const char* UnitOf(const Give& give) {
  switch (give.kind) {
    case Give::Kind::kTilts:
      return "rad/(N·m)";
    case Give::Kind::kMoves:
      return "mm/N";
    case Give::Kind::kTakesUp:
      return "arcmin";
  }
  return "";
}

/// In that unit; a gap that is crossed from its middle is twice as wide as the way taken up.
double Shown(const Give& give, double compliance) {
  constexpr double kArcminPerRad = 60 * kDegPerRad;
  switch (give.kind) {
    case Give::Kind::kTilts:
      return compliance * 1e3;
    case Give::Kind::kMoves:
      return compliance;
    case Give::Kind::kTakesUp:
      return 2 * compliance * kArcminPerRad;
  }
  return 0;
}

std::string UntoldName(const UntoldStep& untold) {
  return NameOf(untold.step) + (untold.give ? fmt::format(" ({})", NameOf(*untold.give)) : "");
}

void PrintBeside(const Identification& found) {
  for (const GiveEstimate& one : found.beside) {
    const char* unit = UnitOf(one.give);
    if (one.determined)
      fmt::print("{:<14} gives {:>10.3g} {:>12.3g} .. {:<10.3g} {}\n", NameOf(one.give),
                 Shown(one.give, one.compliance), Shown(one.give, one.lower), Shown(one.give, one.upper),
                 unit);
    else
      fmt::print("{:<14} no number: {}; below {:.3g} {}\n", NameOf(one.give), one.reason,
                 Shown(one.give, one.upper), unit);
  }
  if (!found.payload) return;
  if (found.payload->determined)
    fmt::print("{:<14} weighs {:>9.3g} {:>12.3g} .. {:<10.3g} N\n", "payload", found.payload->weight,
               found.payload->lower, found.payload->upper);
  else
    fmt::print("{:<14} no number: {}\n", "payload", found.payload->reason);
}

}  // namespace

Json ModelsJson(const ComplianceModels& models) {
  Json list = Json::array(), untold = Json::array();
  for (const ComplianceModel& model : models.tried) {
    Json steps = Json::array();
    for (const ComplianceStep& step : model.steps) steps.push_back(NameOf(step));
    list.push_back({{"beside_springs", steps},
                    {"unknowns", model.unknowns},
                    {"left_out_rms_mm", model.judged ? Json(std::sqrt(model.mean_square)) : Json()},
                    {"left_out_mean_square_mm2", model.judged ? Json(model.mean_square) : Json()},
                    {"standard_error_mm2", model.judged ? Json(model.deviation) : Json()}});
  }
  for (const UntoldStep& one : models.untold)
    untold.push_back({{"what", UntoldName(one)}, {"reason", one.reason}});
  return {{"tried", list}, {"least", models.least}, {"chosen", models.chosen}, {"untold", untold}};
}

Json BesideJson(const Identification& found) {
  Json list = Json::array();
  for (const GiveEstimate& one : found.beside)
    list.push_back({{"what", NameOf(one.give)},
                    {"unit", one.give.kind == Give::Kind::kTilts ? "rad/(N*m)" : UnitOf(one.give)},
                    {"determined", one.determined},
                    {"reason", one.determined ? Json() : Json(one.reason)},
                    {"compliance", one.determined ? Json(Shown(one.give, one.compliance)) : Json()},
                    {"lower_95", Shown(one.give, one.lower)},
                    {"upper_95", Shown(one.give, one.upper)}});
  return list;
}

Json PayloadJson(const Identification& found) {
  if (!found.payload) return {};
  const PayloadEstimate& payload = *found.payload;
  const auto number = [&](double value) { return payload.determined ? Json(value) : Json(); };
  return {{"determined", payload.determined},
          {"reason", payload.determined ? Json() : Json(payload.reason)},
          {"weight_N", number(payload.weight)},
          {"lower_95_N", number(payload.lower)},
          {"upper_95_N", number(payload.upper)}};
}

void PrintModels(const ComplianceModels& models, const Identification& found) {
  PrintBeside(found);
  if (models.tried.size() == 1) return;
  fmt::print(
      "\nmodel: {}, the simplest that foretells poses left out as well as any (within one standard "
      "error)\n",
      NameOf(models.tried[models.chosen]));
  fmt::print("unknowns   left out, mm RMS   model\n");
  for (size_t i = 0; i < models.tried.size(); ++i) {
    const ComplianceModel& model = models.tried[i];
    fmt::print("{:<8} {:>18.4f}   {}{}\n", model.unknowns, std::sqrt(model.mean_square),
               i == 0 ? NameOf(model) : "+ " + NameOf(model.steps.back()),
               i == models.chosen  ? "  <- chosen"
               : i == models.least ? "  (least)"
                                   : "");
  }
  for (const UntoldStep& one : models.untold) fmt::print("not tried: {}: {}\n", UntoldName(one), one.reason);
}

std::vector<ComplianceSettings> CompliancesOf(const Identification& found) {
  std::vector<ComplianceSettings> all;
  for (const GiveEstimate& one : found.beside) {
    if (!one.determined || one.give.kind == Give::Kind::kTakesUp) continue;
    auto same = std::ranges::find(all, one.give.link, &ComplianceSettings::link);
    if (same == all.end()) {
      ComplianceSettings& added = all.emplace_back();
      added.name =
          one.give.link == 0 ? std::string("base") : fmt::format("tilting of link {}", one.give.link);
      added.name += ", 95 %:";
      added.link = one.give.link;
      same = all.end() - 1;
    }
    const bool moves = one.give.kind == Give::Kind::kMoves;
    same->name += fmt::format("{} {} {:.3g} to {:.3g}", same->name.ends_with(':') ? "" : ",",
                              "xyz"[one.give.axis], Shown(one.give, one.lower), Shown(one.give, one.upper));
    (moves ? same->translational : same->rotational)[one.give.axis] = one.compliance;
  }
  return all;
}

std::string NotWritten(const Identification& found) {
  std::vector<std::string> names;
  for (const GiveEstimate& one : found.beside)
    if (one.determined && one.give.kind == Give::Kind::kTakesUp) names.push_back(NameOf(one.give));
  if (found.payload && found.payload->determined) names.emplace_back("the payload");
  if (names.empty()) return {};
  return fmt::format(
      "not written: {}; lost motion is written from readings taken both ways (docs/lost-motion.md), and a "
      "payload belongs to these readings alone",
      fmt::join(names, ", "));
}

}  // namespace millpose
