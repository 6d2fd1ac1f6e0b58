// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "base/progress.hpp"

namespace millpose {

/// Says which of several pieces of work a stage belongs to: "NAME: stage".
class NamedProgress final : public Progress {
 public:
  NamedProgress(Progress& progress, std::string name) : progress_(progress), name_(std::move(name)) {}
  void Begin(std::string_view stage, size_t total) override {
    progress_.Begin(name_ + ": " + std::string(stage), total);
  }
  void Advance(size_t count) override { progress_.Advance(count); }
  void Percent(int percent) override { progress_.Percent(percent); }
  void End(std::string_view outcome) override { progress_.End(outcome); }

 private:
  Progress& progress_;
  std::string name_;
};

}  // namespace millpose
