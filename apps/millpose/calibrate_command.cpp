// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "base/loose_file.hpp"
#include "base/yaml/edit.hpp"
#include "commands.hpp"
#include "run/pipeline/commands/calibrate_part.hpp"

namespace millpose {
namespace {

using Json = nlohmann::ordered_json;
constexpr double kMicrometres = 1000;

struct CalibrateOptions {
  std::filesystem::path measured, plan, job, write_job;
  bool json = false;
};

Json ToJson(const CalibratedFactor& factor) {
  if (!factor.determined) return {{"readings", factor.readings}, {"factor", nullptr}};
  return {{"readings", factor.readings},
          {"factor", factor.value},
          {"lower_95", factor.low},
          {"upper_95", factor.high}};
}

Json ToJson(const CalibratedPart& part) {
  const Calibration& c = part.found;
  Json sides;
  for (const CutSide side : {CutSide::kUp, CutSide::kDown, CutSide::kSlot})
    sides[Name(side)] = ToJson(c.sides[static_cast<size_t>(side)]);
  return {
      {"schema_version", 1},
      {"readings", c.readings},
      {"farthest_from_a_point_mm", part.farthest},
      {"offset_um", kMicrometres * c.offset},
      {"scale", ToJson(c.scale)},
      {"sides", sides},
      {"explained_share", c.explained},
      {"residual_um", kMicrometres * c.residual},
      {"repeatability_um", c.repeatability ? Json(kMicrometres * *c.repeatability) : Json(nullptr)},
      {"explains_variation", c.explains_variation},
      {"explains_size", c.explains_size},
      {"verdict", c.verdict},
      {"force_factors",
       c.usable() ? Json{{"up", part.factors.up}, {"down", part.factors.down}, {"slot", part.factors.slot}}
                  : Json(nullptr)}};
}

void PrintFactor(const char* name, const CalibratedFactor& factor) {
  if (factor.readings == 0) return;
  if (factor.determined)
    fmt::print("{:<14} {:>8.3f}   95 %: {:.3f} to {:.3f}   {} readings\n", name, factor.value, factor.low,
               factor.high, factor.readings);
  else
    fmt::print("{:<14} not determined by {} readings\n", name, factor.readings);
}

void Print(const CalibratedPart& part) {
  const Calibration& c = part.found;
  fmt::print("readings       {:>8}   at most {:.2f} mm from the planned point each is compared with\n",
             c.readings, part.farthest);
  fmt::print("offset         {:>8.2f} µm\n", kMicrometres * c.offset);
  PrintFactor("scale", c.scale);
  for (const CutSide side : {CutSide::kUp, CutSide::kDown, CutSide::kSlot})
    PrintFactor(fmt::format("  {}", Name(side)).c_str(), c.sides[static_cast<size_t>(side)]);
  fmt::print("explained      {:>8.1f} % of the measured variation\n", 100 * c.explained);
  fmt::print("residual       {:>8.2f} µm, standard deviation\n", kMicrometres * c.residual);
  if (c.repeatability)
    fmt::print("repeatability  {:>8.2f} µm, standard deviation of one reading\n",
               kMicrometres * *c.repeatability);
  fmt::print("\n{}\n", c.verdict);
}

std::string FactorsText(const ForceFactors& factors) {
  return fmt::format("{{up: {:.3f}, down: {:.3f}, slot: {:.3f}}}", factors.up, factors.down, factors.slot);
}

int Calibrate(const CalibrateOptions& options) {
  CalibrateArguments arguments{options.measured, options.plan, std::nullopt, {}};
  if (!options.job.empty()) arguments.job = options.job;
  const CalibratedPart part = CalibratePart(arguments);
  if (options.json)
    fmt::print("{}\n", ToJson(part).dump(2));
  else
    Print(part);
  if (!part.found.usable()) {
    if (!options.write_job.empty())
      fmt::print(stderr, "millpose: {} is unchanged: the model does not explain the part\n",
                 options.write_job.string());
    return kFindings;
  }
  const std::string factors = FactorsText(part.factors);
  if (options.write_job.empty()) {
    if (!options.json) fmt::print("for the next plan: process.force_factors: {}\n", factors);
    return kDone;
  }
  const std::string name = options.write_job.string();
  EditLooseFile(name, [&](const std::string& text) {
    return yaml::WithKey(text, name, "process", "force_factors", factors);
  });
  fmt::print(stderr, "millpose: {} updated: process.force_factors: {}\n", name, factors);
  return kDone;
}

}  // namespace

void AddCalibrateCommand(CLI::App& app, Run& run) {
  CLI::App* command = app.add_subcommand(
      "calibrate",
      "A milled part's measured face against the deflection that was predicted for it: scale, factors of the "
      "cutting force, and whether the model explains the part (docs/compensation.md).\n"
      "Exit status 1: it does not.");
  static CalibrateOptions options;
  command
      ->add_option(
          "measured", options.measured,
          "CSV with columns x_mm,y_mm,z_mm (workpiece's frame) and error_um (along the normal, above 0 "
          "where material was left)")
      ->required();
  command->add_option("--plan", options.plan, "Output folder of the plan that the part was milled by")
      ->required();
  command->add_option("--job", options.job, "Its job file, if that is not next to the folder");
  command->add_option("--write-job", options.write_job,
                      "Put the factors into this job file, keeping its comments");
  command->add_flag("--json", options.json, "Results as JSON on stdout");
  command->callback([&run] { run = [](Session&) { return Calibrate(options); }; });
}

}  // namespace millpose
