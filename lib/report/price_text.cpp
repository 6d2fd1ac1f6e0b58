// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/price_text.hpp"

#include <fmt/format.h>

namespace millpose {
namespace {

std::string InMicrometres(const char* of, const PriceParts& parts) {
  return fmt::format("{} {:.3g} µm = interference {:.3g} + continuity {:.3g} + smoothing {:.3g}", of,
                     1e3 * parts.total, 1e3 * parts.interference, 1e3 * parts.continuity,
                     1e3 * parts.smoothing);
}

}  // namespace

std::vector<std::string> PriceLines(const Price& price) {
  std::vector<std::string> lines;
  if (price.is_length) {
    lines.push_back(InMicrometres("above each point's own best pose: worst", price.worst));
    lines.push_back(InMicrometres("mean", price.mean));
  } else if (price.ratio.total > 0) {
    lines.push_back(fmt::format(
        "{:.4f} times each point's own best pose = interference {:.4f} x continuity {:.4f} x "
        "smoothing {:.4f}",
        price.ratio.total, price.ratio.interference, price.ratio.continuity, price.ratio.smoothing));
  }
  std::string gaps;
  if (price.worst_gap) gaps += fmt::format(" {:.2f} % in the worst value", 100 * *price.worst_gap);
  if (price.sum_gap)
    gaps += fmt::format("{} {:.2f} % in the sum with joint motion", gaps.empty() ? "" : ",",
                        100 * *price.sum_gap);
  if (!gaps.empty())
    lines.push_back("no free path through the same candidates is better by more than" + gaps);
  return lines;
}

}  // namespace millpose
