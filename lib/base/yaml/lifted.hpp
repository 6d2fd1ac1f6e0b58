// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <utility>

#include "base/yaml/codec.hpp"

namespace millpose::yaml {

/// A value of type Whole, kept and described as one of type Part: `make` turns what was read into it, `write`
/// writes it.
template <class Whole, class Part>
Codec<Whole> Lifted(const Codec<Part>& part, std::function<Whole(Part)> make, WriteOf<Whole> write) {
  Codec<Whole> whole;
  whole.type = part.type;
  whole.schema = part.schema;
  whole.keys = part.keys;
  whole.read = [read = part.read, make = std::move(make)](const Value& value, const Context& context,
                                                          Whole& result) {
    Part options;
    read(value, context, options);
    result = make(std::move(options));
  };
  whole.write = std::move(write);
  return whole;
}

}  // namespace millpose::yaml
