// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/progress.hpp"

namespace millpose {
namespace {

class SilentProgress : public Progress {
 public:
  void Begin(std::string_view /*stage*/, size_t /*total*/) override {}
  void Advance(size_t /*count*/) override {}
  void End(std::string_view /*outcome*/) override {}
};

}  // namespace

Progress& Silent() {
  static SilentProgress silent;
  return silent;
}

}  // namespace millpose
