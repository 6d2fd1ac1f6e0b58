// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>

#include "base/error.hpp"
#include "toolpath/cam/cam_path.hpp"

namespace millpose {

/// ORIGIN and TRANS of CLDATA: where a postprocessor puts the machine's zero. One ORIGIN for the whole file
/// says nothing of the part; where it changes between points, or TRANS shifts them, the same numbers may mean
/// two places, and the job has to say that points stand as they are written.
class MachineZeros {
 public:
  explicit MachineZeros(const CamReadOptions& options) : options_(options) {}
  /// `moving`: points were read before. Throws InputError.
  void Take(const std::string& word, const std::vector<double>& numbers, const SourceLocation& place,
            bool moving);
  size_t count() const { return count_; }
  bool used_key() const { return used_key_; }

 private:
  const CamReadOptions& options_;
  std::map<std::string, std::vector<double>> last_;
  size_t count_ = 0;
  bool used_key_ = false;
};

}  // namespace millpose
