// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/infeasibility.hpp"

namespace millpose {

std::string ToString(Infeasibility obstacle) {
  switch (obstacle) {
    case Infeasibility::kNone:
      return "none";
    case Infeasibility::kUnreachable:
      return "unreachable";
    case Infeasibility::kLimit:
      return "limit";
    case Infeasibility::kSingular:
      return "singular";
    case Infeasibility::kInterference:
      return "interference";
    case Infeasibility::kStep:
      return "step";
    case Infeasibility::kSource:
      return "source";
    case Infeasibility::kGouge:
      return "gouge";
    case Infeasibility::kAccess:
      return "access";
    case Infeasibility::kOverMissing:
      return "over_missing";
    case Infeasibility::kIncomplete:
      return "incomplete";
    case Infeasibility::kStock:
      return "stock";
  }
  return "unknown";
}

}  // namespace millpose
