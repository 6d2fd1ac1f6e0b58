// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/placement/place_search.hpp"

#include <nlopt.h>

#include <cstdint>
#include <exception>
#include <limits>
#include <memory>
#include <stdexcept>
#include <vector>

namespace millpose {
namespace {

/// What NLopt's callback carries through C.
struct Asked {
  const ValueAt& value;
  int left;  ///< evaluations
  nlopt_opt optimiser = nullptr;
  std::vector<double> best;
  double least = std::numeric_limits<double>::infinity();
  std::exception_ptr failed;
};

double Ask(unsigned count, const double* shares, double* /*gradient*/, void* data) {
  auto& asked = *static_cast<Asked*>(data);
  if (asked.failed || asked.left <= 0) {
    nlopt_force_stop(asked.optimiser);
    return std::numeric_limits<double>::max();
  }
  --asked.left;
  try {
    const double value = asked.value({shares, count});
    if (value < asked.least) {
      asked.least = value;
      asked.best.assign(shares, shares + count);
    }
    return value;
  } catch (...) {  // not through C
    asked.failed = std::current_exception();
    nlopt_force_stop(asked.optimiser);
    return std::numeric_limits<double>::max();
  }
}

void Run(nlopt_algorithm algorithm, int evaluations, double step, std::vector<double> start, Asked& asked) {
  const auto count = static_cast<unsigned>(start.size());
  const std::unique_ptr<nlopt_opt_s, decltype(&nlopt_destroy)> optimiser(nlopt_create(algorithm, count),
                                                                         &nlopt_destroy);
  if (!optimiser) throw std::runtime_error("NLopt has no room");
  asked.optimiser = optimiser.get();
  asked.left = evaluations;
  nlopt_set_lower_bounds1(optimiser.get(), 0);
  nlopt_set_upper_bounds1(optimiser.get(), 1);
  nlopt_set_min_objective(optimiser.get(), Ask, &asked);
  nlopt_set_maxeval(optimiser.get(), evaluations);
  nlopt_set_initial_step1(optimiser.get(), step);
  nlopt_set_xtol_abs1(optimiser.get(), 1e-4);
  double least = 0;
  nlopt_optimize(optimiser.get(), start.data(), &least);  // its status says which of our bounds ended it
  if (asked.failed) std::rethrow_exception(asked.failed);
}

}  // namespace

void SearchShares(const std::vector<double>& start, int evaluations, uint64_t seed, const ValueAt& value) {
  Asked asked{.value = value, .left = 0, .optimiser = nullptr, .best = {}, .failed = nullptr};
  const int everywhere = std::max(1, evaluations * 4 / 5);
  nlopt_srand(static_cast<unsigned long>(seed));  // of this thread
  Run(NLOPT_GN_CRS2_LM, everywhere, 0.5, start, asked);
  if (evaluations > everywhere) Run(NLOPT_LN_SBPLX, evaluations - everywhere, 0.05, asked.best, asked);
}

}  // namespace millpose
