// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/yaml/codec.hpp"

namespace millpose {

/// Says what is wrong with keys of a strategy's section when all of them are read.
class SectionCheck {
 public:
  SectionCheck(const yaml::Value& value, const yaml::Context& context) : value_(value), context_(context) {}

  /// Of a key that is given.
  void Add(const char* key, const std::string& message) const {
    context_.Child(key).Add(value_.FindKey(key)->mark, message);
  }
  /// Where the key is given: nothing follows it as the others stand.
  void Useless(const char* key, const std::string& why) const {
    if (value_.FindKey(key)) Add(key, "has no effect here: " + why);
  }

 protected:
  const yaml::Value& value_;
  const yaml::Context& context_;
};

}  // namespace millpose
