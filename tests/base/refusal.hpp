// SPDX-License-Identifier: GPL-3.0-or-later
// What input is refused with.
#pragma once

#include <string>

#include "base/error.hpp"

namespace millpose {

/// The message of the InputError that a call ends with; "accepted" where with none.
template <class Call>
std::string RefusalOf(const Call& call) {
  try {
    call();
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

}  // namespace millpose
