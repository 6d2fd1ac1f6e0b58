// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/error.hpp"

namespace millpose {

/// The implementations of an interface by name, in the order in which schemas and pages list them. An Entry
/// has a `name` and whatever else the users of the registry need before anything is made.
///
/// Programs that link the library add their own before they read the first job: schemas and tables of keys
/// are made from the names once, so Add() after a look at them is a mistake of the program
/// (std::logic_error).
template <class Entry>
class Registry {
 public:
  /// `kind`: what an entry is, for messages ("objective").
  Registry(std::string kind, std::vector<Entry> entries)
      : kind_(std::move(kind)), entries_(std::move(entries)) {}

  void Add(Entry entry) {
    if (looked_at_)
      throw std::logic_error("the " + kind_ + "s are in use: add them before the first job is read");
    if (Find(entry.name)) throw std::logic_error("there is a " + kind_ + " \"" + entry.name + "\" already");
    entries_.push_back(std::move(entry));
  }

  /// The entry called `name`. Throws InputError with the nearest name when there is none.
  const Entry& At(std::string_view name) const {
    if (const Entry* found = Find(name)) return *found;
    throw InputError(SourceLocation{}, UnknownName(kind_, std::string(name), Names()));
  }

  const std::vector<Entry>& entries() const {
    looked_at_ = true;
    return entries_;
  }

  std::vector<std::string> Names() const {
    std::vector<std::string> names;
    for (const Entry& entry : entries()) names.emplace_back(entry.name);
    return names;
  }

 private:
  const Entry* Find(std::string_view name) const {
    const auto found = std::ranges::find(entries_, name, &Entry::name);
    return found == entries_.end() ? nullptr : &*found;
  }

  std::string kind_;
  std::vector<Entry> entries_;
  mutable bool looked_at_ = false;
};

}  // namespace millpose
