// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "report/summary_sheet.hpp"

namespace millpose {

/// How much of everything a made-up sheet has.
struct LongSummary {
  size_t operations = 1, programs = 1, findings = 0, warnings = 0;
  size_t words = 3;  ///< of each sentence
};

/// A sheet as SummaryOfFolder makes them: all columns, bars and charts there may be.
SummarySheet MakeLongSummary(const LongSummary& much);

}  // namespace millpose
