// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "base/csv.hpp"
#include "base/error.hpp"
#include "base/file.hpp"
#include "commands.hpp"
#include "machine/identification/flatness.hpp"

namespace millpose {
namespace {

struct FlatnessOptions {
  std::string file;
  bool json = false;
};

nlohmann::ordered_json ToJson(const Flatness& found, const CsvTable& table) {
  nlohmann::ordered_json outliers = nlohmann::ordered_json::array();
  for (const size_t i : found.outliers)
    outliers.push_back({{"line", table.line(i)}, {"distance_mm", found.distances[i]}});
  const auto vector = [](const Eigen::Vector3d& v) { return nlohmann::ordered_json{v.x(), v.y(), v.z()}; };
  return {{"points", found.distances.size()},
          {"flatness_mm", found.flatness},
          {"rms_mm", found.rms},
          {"minimum_zone_mm", found.minimum_zone},
          {"centre_mm", vector(found.centre)},
          {"normal", vector(found.normal)},
          {"minimum_zone_normal", vector(found.zone_normal)},
          {"outliers", outliers}};
}

void Print(const Flatness& found, const CsvTable& table) {
  fmt::print("points              {}\n", found.distances.size());
  fmt::print("flatness            {:.6g} mm   d_max - d_min about the least-squares plane\n", found.flatness);
  fmt::print("RMS                 {:.6g} mm\n", found.rms);
  fmt::print("minimum zone        {:.6g} mm   least distance of two parallel planes around all points\n",
             found.minimum_zone);
  fmt::print("plane through       {:.6g} {:.6g} {:.6g} mm\n", found.centre.x(), found.centre.y(),
             found.centre.z());
  fmt::print("plane normal        {:.9f} {:.9f} {:.9f}\n", found.normal.x(), found.normal.y(),
             found.normal.z());
  fmt::print("outliers            {}\n", found.outliers.size());
  for (const size_t i : found.outliers)
    fmt::print("  line {:<6}        {:+.6g} mm\n", table.line(i), found.distances[i]);
}

int Measure(const FlatnessOptions& options) {
  const CsvTable table =
      ReadCsv(ReadFile(options.file), options.file, {{"x_mm", "y_mm", "z_mm"}, {"error_um"}});
  std::vector<Eigen::Vector3d> points;
  for (size_t i = 0; i < table.size(); ++i)
    points.emplace_back(table.At(i, "x_mm"), table.At(i, "y_mm"), table.At(i, "z_mm"));
  constexpr double kMost = 1e6;  // mm, of any coordinate
  for (size_t i = 0; i < points.size(); ++i)
    if (points[i].cwiseAbs().maxCoeff() > kMost)
      throw InputError({options.file, table.line(i)}, "a point beyond a kilometre; allowed: within ±1e6 mm");
  const std::optional<Flatness> found = MeasureFlatness(points);
  if (!found)
    throw InputError(
        {options.file},
        fmt::format("{} points span no plane; allowed: at least 3 that are not on a line", points.size()));
  if (options.json)
    fmt::print("{}\n", ToJson(*found, table).dump(2));
  else
    Print(*found, table);
  return kDone;
}

}  // namespace

void AddFlatnessCommand(CLI::App& app, Run& run) {
  CLI::App* command = app.add_subcommand(
      "flatness", "Least-squares plane, flatness and minimum zone of measured points (docs/flatness.md)");
  static FlatnessOptions options;
  command->add_option("points", options.file, "CSV with columns x_mm,y_mm,z_mm")->required();
  command->add_flag("--json", options.json, "Results as JSON on stdout");
  command->callback([&run] { run = [](Session&) { return Measure(options); }; });
}

}  // namespace millpose
