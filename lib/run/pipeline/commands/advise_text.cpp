// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/pipeline/commands/advise_text.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

namespace millpose {
namespace {

using AdviceJson = nlohmann::ordered_json;

const char* WordOf(AdviceBound bound) {
  constexpr const char* kWords[] = {"error", "power", "cutter", "refused", "none"};
  return kWords[static_cast<size_t>(bound)];
}

std::string LoadText(const CutLoad& load) {
  return fmt::format("{:.4g} um, {:.3g} kW", 1e3 * load.error, 1e-3 * load.power);
}

AdviceJson LoadTree(const CutLoad& load) {
  return {{"error_um", 1e3 * load.error}, {"power_kW", 1e-3 * load.power}};
}

std::string SettingText(const Advice& advice) {
  std::string text = fmt::format("  {:<18}", advice.what);
  if (advice.bound == AdviceBound::kSmallest)
    return text + fmt::format("none: even {:.6g} {} {}\n", advice.beyond, advice.unit,
                              advice.over ? "makes it " + LoadText(*advice.over) : "is refused");
  text += fmt::format("{:.6g} {} (given {:.6g}): {}", advice.value, advice.unit, advice.given,
                      LoadText(advice.load));
  if (advice.bound == AdviceBound::kLargest) text += "; no more with this cutter";
  if (advice.bound == AdviceBound::kRefused)
    text += fmt::format("; {:.6g} is refused, or leaves points out", advice.beyond);
  if (advice.over) text += fmt::format("; {:.6g} makes it {}", advice.beyond, LoadText(*advice.over));
  text += "\n";
  for (const std::string& key : advice.keys) text += fmt::format("    --set {}={:.6g}\n", key, advice.value);
  return text;
}

}  // namespace

std::string ToText(const OperationAdvice& advice) {
  if (!advice.without.empty()) return fmt::format("advice              none: {}\n", advice.without);
  std::string text = fmt::format("advice              for {:.6g} um", 1e3 * advice.limits.error);
  if (advice.limits.power) text += fmt::format(" and {:.6g} kW", 1e-3 * *advice.limits.power);
  text += fmt::format("; as given {}\n", LoadText(advice.given));
  for (const Advice& setting : advice.advices) text += SettingText(setting);
  return text;
}

std::string ToJson(const OperationAdvice& advice) {
  AdviceJson settings = AdviceJson::array();
  for (const Advice& setting : advice.advices) {
    const bool found = setting.bound != AdviceBound::kSmallest;
    settings.push_back({{"setting", setting.what},
                        {"unit", setting.unit},
                        {"keys", setting.keys},
                        {"given", setting.given},
                        {"largest", found ? AdviceJson(setting.value) : AdviceJson()},
                        {"limited_by", WordOf(setting.bound)},
                        {"load", found ? LoadTree(setting.load) : AdviceJson()},
                        {"too_much", setting.beyond > 0 ? AdviceJson(setting.beyond) : AdviceJson()},
                        {"load_too_much", setting.over ? LoadTree(*setting.over) : AdviceJson()}});
  }
  const AdviceJson json = {
      {"error_um", 1e3 * advice.limits.error},
      {"power_kW", advice.limits.power ? AdviceJson(1e-3 * *advice.limits.power) : AdviceJson()},
      {"without", advice.without.empty() ? AdviceJson() : AdviceJson(advice.without)},
      {"as_given", advice.without.empty() ? LoadTree(advice.given) : AdviceJson()},
      {"settings", std::move(settings)}};
  return json.dump();
}

}  // namespace millpose
