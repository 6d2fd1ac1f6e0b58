// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/csv.hpp"
#include "job/config/batch_settings.hpp"
#include "job/config/config.hpp"
#include "job/config/measurements.hpp"
#include "tests/fuzz/entries.hpp"

namespace millpose {

std::vector<FuzzEntry> YamlEntries() {
  return {
      {"job", [](std::string_view bytes) { LetRefuse([&] { ParseJob(bytes, "fuzz"); }); }},
      {"cell", [](std::string_view bytes) { LetRefuse([&] { ParseCell(bytes, "fuzz"); }); }},
      {"batch", [](std::string_view bytes) { LetRefuse([&] { ParseBatch(bytes, "fuzz"); }); }},
      {"measurements", [](std::string_view bytes) { LetRefuse([&] { ParseMeasurements(bytes, "fuzz"); }); }},
      {"csv", [](std::string_view bytes) {
         LetRefuse([&] { ReadCsv(bytes, "fuzz", {{"x_mm", "y_mm"}, {"z_mm"}}); });
         LetRefuse([&] { ParseMeasurementsCsv(bytes, "fuzz"); });
       }}};
}

}  // namespace millpose
