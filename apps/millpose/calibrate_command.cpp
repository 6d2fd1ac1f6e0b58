// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "base/loose_file.hpp"
#include "base/yaml/edit.hpp"
#include "commands.hpp"
#include "run/pipeline/commands/map_part.hpp"

namespace millpose {
namespace {

using Json = nlohmann::ordered_json;
constexpr double kMicrometres = 1000;

struct CalibrateOptions {
  std::filesystem::path measured, plan, job, write_job, map, second;
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

Json ToJson(const MappedPart& part) {
  const FittedErrors& f = part.fitted;
  const auto or_null = [](const std::optional<double>& value) {
    return value ? Json(kMicrometres * *value) : Json(nullptr);
  };
  Json repeats = nullptr;
  if (part.repeats)
    repeats = {{"share", part.repeats->share},
               {"lower_95", part.repeats->low},
               {"upper_95", part.repeats->high},
               {"left_um", kMicrometres * part.repeats->left}};
  return {{"schema_version", 1},
          {"readings", f.readings},
          {"places", f.places},
          {"farthest_from_a_point_mm", part.farthest},
          {"size_um", kMicrometres * f.size},
          {"explained_share", f.explained},
          {"left_um", kMicrometres * f.left},
          {"length_mm", f.field.shape().length},
          {"follows_lost_motion", f.field.shape().by_flanks > 0},
          {"noise_um", kMicrometres * f.field.noise()},
          {"repeatability_um", or_null(f.repeatability)},
          {"significant", f.significant},
          {"second_part", repeats},
          {"taken_share", part.share},
          {"largest_map_um", kMicrometres * part.largest},
          {"largest_deviation_um", kMicrometres * part.largest_sd},
          {"corrected_before", part.corrected_before},
          {"usable", part.usable},
          {"verdict", part.verdict}};
}

void Print(const MappedPart& part) {
  const FittedErrors& f = part.fitted;
  fmt::print("readings       {:>8}   of {} places, at most {:.2f} mm from a cut point\n", f.readings,
             f.places, part.farthest);
  fmt::print("size           {:>8.2f} µm, RMS\n", kMicrometres * f.size);
  fmt::print("smooth part    {:>8.1f} % of the readings' squares, foretold by neighbours over {:.0f} mm{}\n",
             100 * f.explained, f.field.shape().length,
             f.field.shape().by_flanks > 0 ? " that were milled on the same flanks of the gears" : "");
  fmt::print("left           {:>8.2f} µm, RMS of places left out; noise of a reading {:.2f} µm\n",
             kMicrometres * f.left, kMicrometres * f.field.noise());
  if (f.repeatability)
    fmt::print("repeatability  {:>8.2f} µm, standard deviation at places read twice\n",
               kMicrometres * *f.repeatability);
  if (part.repeats)
    fmt::print("second part    {:>8.2f} of the first's comes back   95 %: {:.2f} to {:.2f}\n",
               part.repeats->share, part.repeats->low, part.repeats->high);
  if (part.usable)
    fmt::print("map            {:>8.2f} µm taken out at most{}, known to {:.2f} µm (standard deviation)\n",
               kMicrometres * part.largest, part.corrected_before ? ", with what a former map took" : "",
               kMicrometres * part.largest_sd);
  fmt::print("\n{}\n", part.verdict);
}

int WriteMap(const CalibrateOptions& options, const CalibrateArguments& arguments) {
  if (!options.write_job.empty())
    throw InputError(
        {}, "--write-job and --map: the same readings give factors of the force or a map, never both");
  std::optional<std::filesystem::path> second;
  if (!options.second.empty()) second = options.second;
  const MappedPart part = MapPart(arguments, second);
  if (options.json)
    fmt::print("{}\n", ToJson(part).dump(2));
  else
    Print(part);
  if (!part.usable) return kFindings;
  WriteLooseFile(options.map, part.csv);
  fmt::print(stderr,
             "millpose: {} written; for the next plan: compensation: {{map_csv: {}, max_mm: {:.2f}}}\n",
             options.map.string(), options.map.filename().string(), std::ceil(100 * part.largest + 1) / 100);
  return kDone;
}

int Calibrate(const CalibrateOptions& options) {
  CalibrateArguments arguments{options.measured, options.plan, std::nullopt, {}};
  if (!options.job.empty()) arguments.job = options.job;
  if (!options.map.empty()) return WriteMap(options, arguments);
  if (!options.second.empty()) throw InputError({}, "--second has no effect here: it goes with --map");
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
      "With --map: the smooth part of the error as a map for the next part, milled in the same poses "
      "(docs/error-map.md).\n"
      "Exit status 1: it does not; nothing that a map could correct.");
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
  command->add_option("--map", options.map,
                      "CSV to write: what compensation.map_csv of the next plan takes out");
  command->add_option(
      "--second", options.second,
      "With --map: the same of another part of the same programs; what does not come back on it "
      "is not taken out");
  command->add_flag("--json", options.json, "Results as JSON on stdout");
  command->callback([&run] { run = [](Session&) { return Calibrate(options); }; });
}

}  // namespace millpose
