// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Message_ProgressIndicator.hxx>
#include <Message_ProgressScope.hxx>
#include <cstdio>

namespace millpose {

/// Tells on stderr how far the reading has come, in percent of all.
inline void TellPercent(int percent) {
  static int told = -1;
  if (percent <= told) return;
  told = percent;
  std::fprintf(stderr, "progress %d\n", percent);
}

/// One of OpenCASCADE's steps as a part (from, to) of all, in percent.
class StepProgress : public Message_ProgressIndicator {
 public:
  StepProgress(int from, int to) : from_(from), to_(to) {}

 protected:
  void Show(const Message_ProgressScope& /*scope*/, Standard_Boolean /*force*/) override {
    TellPercent(from_ + static_cast<int>(GetPosition() * (to_ - from_)));
  }

 private:
  int from_, to_;
};

}  // namespace millpose
