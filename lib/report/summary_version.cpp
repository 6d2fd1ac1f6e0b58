// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/summary_version.hpp"

#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "report/report.hpp"

namespace millpose {

void CheckSummaryVersion(const std::string& summary_json, const std::string& name) {
  const nlohmann::json summary = nlohmann::json::parse(summary_json, nullptr, false);
  if (summary.is_discarded()) throw InputError({name}, "is not JSON");
  if (!summary.is_object() || !summary.contains("schema_version"))
    throw InputError({name}, "is no summary of millpose plan: schema_version is missing");
  const nlohmann::json& version = summary["schema_version"];
  if (version == kSummaryVersion) return;
  throw InputError({name},
                   fmt::format("schema_version: given {}; allowed: {}: another version of millpose wrote "
                               "this folder; plan its job.yaml again",
                               version.dump(), kSummaryVersion));
}

}  // namespace millpose
