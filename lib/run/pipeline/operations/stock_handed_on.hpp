// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "job/inputs.hpp"

namespace millpose {

/// What the operations of a job take off one after the other, as those after them find it.
class StockHandedOn {
 public:
  /// For JobInputs::cut_before; nothing where the job has no raw part.
  std::vector<CutsOfTool> Before(const JobInputs& inputs) const {
    return inputs.job.workpiece.HasStock() ? cuts_ : std::vector<CutsOfTool>();
  }
  /// Of the next operation.
  void Add(CutsOfTool cuts) { cuts_.push_back(std::move(cuts)); }

 private:
  std::vector<CutsOfTool> cuts_;
};

}  // namespace millpose
