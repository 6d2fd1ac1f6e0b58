// SPDX-License-Identifier: GPL-3.0-or-later
// A freedom as the registry knows it: its name, and its key of the job's `toolpath:`.
#pragma once

#include "base/registry.hpp"
#include "base/yaml/section.hpp"
#include "planning/pose/open_toolpath.hpp"

namespace millpose {

struct FreedomEntry {
  std::string name;
  FreedomPointer always = {};                         ///< the freedom that every job has, or
  std::optional<yaml::Field<OpenToolpath>> key = {};  ///< what a job opens it by: sets it in its `freedoms`
  bool leans = false;                                 ///< Freedom::IsLean of it
};

/// The entry of a freedom F that is made from a map of options, an F::Options, which `options()` gives back.
/// Jobs without `key` do not have it.
template <class F>
FreedomEntry EntryOf(std::string key, std::string doc, const yaml::Codec<typename F::Options>& fields) {
  using Given = std::optional<typename F::Options>;
  const F example{typename F::Options{}};
  const std::string name = example.Name();
  return {.name = name,
          .key = yaml::KeyBy<OpenToolpath, Given>(
              std::move(key),
              [name](const OpenToolpath& toolpath) {
                const auto* own = dynamic_cast<const F*>(toolpath.Find(name));
                return own ? Given(own->options()) : Given();
              },
              [name](OpenToolpath& toolpath, const Given& given) {
                toolpath.freedoms[name] = std::make_shared<const F>(*given);
              },
              yaml::Maybe(fields), std::move(doc)),
          .leans = example.IsLean()};
}

/// All freedoms, in the order in which problems have them; programs that link the library may add theirs.
Registry<FreedomEntry>& Freedoms();

/// Those of a job's tool path.
std::vector<FreedomPointer> FreedomsOf(const OpenToolpath& toolpath);

/// The keys of those that lean the tool: "lead_deg or tilt_deg".
std::string LeanKeys();

}  // namespace millpose
