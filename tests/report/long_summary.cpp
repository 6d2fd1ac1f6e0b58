// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/report/long_summary.hpp"

#include <fmt/format.h>

namespace millpose {

SummarySheet MakeLongSummary(const LongSummary& much) {
  SummarySheet sheet;
  sheet.job = std::string(3 * much.words, 'j');
  sheet.subtitle = "Cell c, arm a. Inputs 0123456789abcdef.";
  sheet.verdict = much.findings > 0 ? "FINDINGS" : "done";
  // What tables have and what they have not, so that every language has long lines of its own.
  std::string sentence = "pad:";
  for (size_t i = 0; i < much.words; ++i) sentence += fmt::format(" word{}", i);
  sentence += ". The job asks for no programs. Every program file was read back and confirmed.";
  for (size_t i = 0; i < much.operations; ++i) sheet.why.push_back(sentence);
  sheet.tiles = {{"points milled", "123456 / 123456"},
                 {"cycle, h:min:s", "123:45:56 sinumerik"},
                 {"least distance, mm", "13.6"},
                 {"face off by, µm", "50.2"}};
  sheet.operations = {{"operation", "tool", "points", "milled", "passes", "cycle, h:min:s",
                       "least distance, mm", "face off by, µm"},
                      {},
                      2};
  for (size_t i = 0; i < much.operations; ++i)
    sheet.operations.rows.push_back({fmt::format("operation_{}_{}", i, sheet.job), sheet.job, "123456",
                                     "123456", "1234", "123:45:56 sinumerik", "13.6", "50.2"});
  for (const char* name : {"static compliance", "force uncertainty", "lost motion", "registration"})
    sheet.sources.push_back({name, 1.0 + static_cast<double>(sheet.sources.size())});
  for (const char* name : {"gear error", "geometry", "thermal", "dynamics"})
    sheet.sources.push_back({name, {}});
  const std::vector<double> way{0, 1000, 2000};
  sheet.courses = {
      {"Compliance along the normal on the path", "µm/N", way, {{"", "#2d7bd3", {1, 3, 2}}}},
      {"Displacement along the normal on the path",
       "µm",
       way,
       {{"under the mean cutting force", "#cf4500", {1, 3, 2}}, {"by lost motion", "#009e73", {3, 1, 2}}}}};
  sheet.findings.assign(much.findings, sentence);
  sheet.warnings.assign(much.warnings, sentence);
  for (size_t i = 0; i < much.programs; ++i)
    sheet.programs.push_back({"sinumerik", fmt::format("programs/krl/p{}{}.src", i, sheet.job),
                              "but for a stated gap", std::string(32, 'a')});
  sheet.seal = fmt::format(
      "All {} files, restart programs too, stand with their hashes (XXH3, 128 bits) in manifest.json; its "
      "own "
      "hash is {}.",
      much.programs, std::string(32, 'b'));
  return sheet;
}

}  // namespace millpose
