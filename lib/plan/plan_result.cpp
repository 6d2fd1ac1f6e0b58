// SPDX-License-Identifier: GPL-3.0-or-later
#include "plan/plan_result.hpp"

namespace millpose {

std::string ToString(SkipReason reason) {
  switch (reason) {
    case SkipReason::kNone:
      return "none";
    case SkipReason::kUnreachable:
      return "unreachable";
    case SkipReason::kLimit:
      return "limit";
    case SkipReason::kSingular:
      return "singular";
    case SkipReason::kInterference:
      return "interference";
    case SkipReason::kStep:
      return "step";
    case SkipReason::kSource:
      return "source";
    case SkipReason::kGouge:
      return "gouge";
    case SkipReason::kAccess:
      return "access";
    case SkipReason::kOverMissing:
      return "over_missing";
  }
  return "unknown";
}

}  // namespace millpose
