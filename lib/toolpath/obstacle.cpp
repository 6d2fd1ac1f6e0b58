// SPDX-License-Identifier: GPL-3.0-or-later
#include "toolpath/obstacle.hpp"

namespace millpose {

std::string ToString(Obstacle obstacle) {
  switch (obstacle) {
    case Obstacle::kNone:
      return "none";
    case Obstacle::kUnreachable:
      return "unreachable";
    case Obstacle::kLimit:
      return "limit";
    case Obstacle::kSingular:
      return "singular";
    case Obstacle::kInterference:
      return "interference";
    case Obstacle::kStep:
      return "step";
    case Obstacle::kSource:
      return "source";
    case Obstacle::kGouge:
      return "gouge";
    case Obstacle::kAccess:
      return "access";
    case Obstacle::kOverMissing:
      return "over_missing";
    case Obstacle::kIncomplete:
      return "incomplete";
  }
  return "unknown";
}

}  // namespace millpose
