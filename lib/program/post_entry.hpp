// SPDX-License-Identifier: GPL-3.0-or-later
// A controller as the registry knows it: its name, and its section of a cell's `controllers:`.
#pragma once

#include "base/registry.hpp"
#include "base/yaml/lifted.hpp"
#include "program/post.hpp"
#include "program/post_keys.hpp"

namespace millpose {

using PostPointer = std::shared_ptr<const Post>;

/// A controller's section of a cell: what controllers share, and the post with what is its own.
struct ControllerOptions {
  PostOptions shared;
  PostPointer post;
};

struct PostEntry {
  std::string name;
  std::function<std::unique_ptr<Post>()> make;  ///< with default options
  yaml::Codec<ControllerOptions> section;
};

/// A section as it is read.
template <class Own>
struct PostSection {
  PostOptions shared;
  Own own;
};

/// The same field of the whole that a part is in.
template <class Whole, class Part>
yaml::Field<Whole> FieldOfPart(const yaml::Field<Part>& field, Part Whole::*part) {
  yaml::Field<Whole> lifted;
  static_cast<yaml::FieldText&>(lifted) = field;
  lifted.read = [read = field.read, part](const yaml::Value& value, const yaml::Context& context,
                                          Whole& whole) { read(value, context, whole.*part); };
  lifted.write = [write = field.write, part](const Whole& whole) { return write(whole.*part); };
  return lifted;
}

/// A row of a controller's table: a shared key, or one of its own.
template <class Own>
struct PostKey : yaml::Field<PostSection<Own>> {
  PostKey(const SharedKey& key)  // NOLINT(google-explicit-constructor): rows of one table
      : yaml::Field<PostSection<Own>>(FieldOfPart(key, &PostSection<Own>::shared)) {}
  PostKey(const yaml::Field<Own>& key)  // NOLINT(google-explicit-constructor)
      : yaml::Field<PostSection<Own>>(FieldOfPart(key, &PostSection<Own>::own)) {}
};

/// The entry of a post P, made from the options of its own, a P::Options, which `options()` gives back.
/// `check` sees the whole section when all keys were good.
template <class P>
PostEntry EntryOf(const std::vector<PostKey<typename P::Options>>& keys,
                  yaml::ReadOf<PostSection<typename P::Options>> check = {}) {
  using Own = typename P::Options;
  using Whole = PostSection<Own>;
  const yaml::Codec<Whole> fields = yaml::Section<Whole>({keys.begin(), keys.end()}, std::move(check));
  return {P(Own{}).Name(), [] { return std::make_unique<P>(Own{}); },
          yaml::Lifted<ControllerOptions, Whole>(
              fields,
              [](Whole whole) {
                return ControllerOptions{std::move(whole.shared),
                                         std::make_shared<const P>(std::move(whole.own))};
              },
              [write = fields.write](const ControllerOptions& controller) {
                return write({controller.shared, dynamic_cast<const P&>(*controller.post).options()});
              })};
}

/// All controllers; programs that link the library may add theirs.
Registry<PostEntry>& Posts();

}  // namespace millpose
