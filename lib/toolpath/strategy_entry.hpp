// SPDX-License-Identifier: GPL-3.0-or-later
// A strategy as the registry knows it: its name, and its options as a section of the job's `toolpath:`.
#pragma once

#include "base/registry.hpp"
#include "base/yaml/lifted.hpp"
#include "base/yaml/section.hpp"
#include "toolpath/strategy.hpp"

namespace millpose {

using StrategyPointer = std::shared_ptr<const Strategy>;

struct StrategyEntry {
  std::string name;
  std::string section;  ///< the key of `toolpath` that holds its options; empty: it has none
  std::string doc;
  std::function<StrategyPointer()> make;      ///< with default options
  yaml::Codec<StrategyPointer> options = {};  ///< of the section
};

/// The entry of a strategy without options.
template <class S>
StrategyEntry EntryOf() {
  return {S().Name(), "", "", [] { return std::make_shared<const S>(); }};
}

/// The entry of a strategy S whose options are read into its members by `fields`.
template <class S>
StrategyEntry EntryOf(std::string section, std::string doc, yaml::Codec<S> fields) {
  StrategyEntry entry{S().Name(), std::move(section), std::move(doc),
                      [] { return std::make_shared<const S>(); }};
  entry.options = yaml::Lifted<StrategyPointer, S>(
      fields, [](S options) { return std::make_shared<const S>(std::move(options)); },
      [write = fields.write](const StrategyPointer& strategy) {
        const auto* options = dynamic_cast<const S*>(strategy.get());
        return options ? write(*options) : yaml::Value();
      });
  return entry;
}

/// All strategies; programs that link the library may add theirs.
Registry<StrategyEntry>& Strategies();

}  // namespace millpose
