// SPDX-License-Identifier: GPL-3.0-or-later
// How deep and how wide a job may cut for a stated error (docs/advise.md).
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "base/file_root.hpp"
#include "base/progress.hpp"
#include "job/config/config.hpp"

namespace millpose {

struct AdviseLimits {
  double error = 0;             ///< by which the mean force may move the tip anywhere, mm
  std::optional<double> power;  ///< of the spindle, W
};

/// What cuts come to where they are worst.
struct CutLoad {
  double error = 0;  ///< mm
  double power = 0;  ///< W
};

/// What keeps a value from being larger.
enum class AdviceBound : uint8_t {
  kError,
  kPower,
  kLargest,  ///< the cutter allows no more
  kRefused,  ///< `plan` refuses more, or leaves points out
  kSmallest  ///< even the least value that is tried breaks a limit
};

/// How large one setting may be while all others stay.
struct Advice {
  std::string what;               ///< depth | step-over | engagement
  std::vector<std::string> keys;  ///< of the job, as --set takes them; all get the value
  std::string unit;               ///< mm | deg
  double given = 0, value = 0;    ///< value: none where the bound is kSmallest
  CutLoad load;                   ///< with the value; where there is none, with the least that was tried
  AdviceBound bound = AdviceBound::kError;
  double beyond = 0;            ///< at most 5 % more, which is too much; 0 where the value is the largest
  std::optional<CutLoad> over;  ///< with that; none where it is refused
};

struct OperationAdvice {
  AdviseLimits limits;
  CutLoad given;                ///< as the job stands
  std::string without;          ///< why nothing can be advised; else empty
  std::vector<Advice> advices;  ///< depth, then step-over or engagement, as far as the job has them
};

/// The values that are tried: multiples of `grain` from `smallest` to `largest`, `given` first.
struct AdviceRange {
  double given = 0, smallest = 0, largest = 0, grain = 0;
};

/// How large a value may be whose load does not fall with it: one within the limits of which 5 % more is not.
/// `load`: of a value, none where it is refused.
Advice LargestWithin(const AdviseLimits& limits, const AdviceRange& range,
                     const std::function<std::optional<CutLoad>(double)>& load);

/// Plans each operation of a job again and again, with other depths and steps, and writes nothing. An
/// operation finds what those before it leave with their own values. Throws InputError; Interrupted.
std::vector<OperationAdvice> Advise(const std::filesystem::path& job, const std::vector<Override>& overrides,
                                    const AdviseLimits& limits, int threads, const FileRoot& root,
                                    Progress& progress, const std::stop_token& stop);

}  // namespace millpose
