// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/plan_key.hpp"

#include "base/parallel.hpp"
#include "base/value_bytes.hpp"

namespace millpose {

std::string KeyOf(const std::vector<PassResult>& passes, int threads) {
  std::vector<std::string> keys(passes.size());
  ParallelFor(passes.size(), threads, {}, [&](size_t i) { keys[i] = HashOfValues(passes[i]); });
  return HashOfValues(keys);
}

std::string KeyOf(std::vector<LinkMove> gaps) {
  for (LinkMove& gap : gaps) gap.poses_checked = 0;
  return HashOfValues(gaps);
}

std::string KeyOf(const PlanResult& plan, int threads) {
  // Every field has its name here, so that one that is added cannot be forgotten.
  const auto& [job, cell, input_hash, seed, arm, external_axes, X_WB, X_FT, X_WP, home, spindle_speed, passes,
               gaps, objective_name, objective_unit, stiffness_origin] = plan;
  return HashOfValues(job, cell, seed, arm, external_axes, X_WB, X_FT, X_WP, home, spindle_speed,
                      KeyOf(passes, threads), KeyOf(gaps), objective_name, objective_unit, stiffness_origin);
}

}  // namespace millpose
