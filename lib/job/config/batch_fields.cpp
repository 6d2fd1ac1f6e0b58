// SPDX-License-Identifier: GPL-3.0-or-later
// The keys of a batch manifest: one line each.
#include "job/config/batch_settings.hpp"
#include "job/config/fields.hpp"

namespace millpose {
namespace config {
namespace {

/// A value as a line of YAML, and where it stands.
struct Change {
  std::string value;
  SourceLocation place;
};

// Any value; the job's own fields judge it.
Codec<Change> AnyValue() {
  Codec<Change> codec;
  codec.type = "value of that key";
  codec.schema = Value::Map;
  codec.read = [](const Value& value, const Context& context, Change& result) {
    result = {WriteYamlLine(value), {context.file, value.mark.line, value.mark.column}};
  };
  codec.write = [](const Change& change) { return Value::Plain(change.value); };
  return codec;
}

using Changes = std::map<std::string, Change>;

Codec<BatchEntry> EntryFields() {
  using S = BatchEntry;
  return Section<S>({
      Key<S>("job", MILLPOSE_AT(job_file), Text(), "Job file, relative to the manifest.").Required(),
      Key<S>("name", MILLPOSE_AT(name), FileName(), "Name of the job in this batch, and of its folder.")
          .DefaultText("the job's own"),
      Key<S>("shares", MILLPOSE_AT(shares), Integer(1, 10000),
             "On a cluster: tasks over which the passes of this job are spread.")
          .DefaultText("that of --shares"),
      KeyBy<S, Changes>(
          "set",
          [](const S& s) {
            Changes changes;
            for (const Override& change : s.overrides) changes[change.path] = {change.value, change.place};
            return changes;
          },
          [](S& s, const Changes& changes) {
            for (const auto& [path, change] : changes)
              s.overrides.push_back({path, change.value, change.place});
          },
          MapOf<Change>({}, AnyValue()), "Keys of the job with dots, with the values to use instead."),
  });
}

}  // namespace

const Codec<BatchSettings>& BatchFields() {
  using S = BatchSettings;
  static const Codec<S> fields = Section<S>({
      VersionKey<S>("millpose_batch", 1),
      Key<S>("untrusted", MILLPOSE_AT(untrusted), Flag(),
             "Jobs of others: they read and write nothing outside of the manifest's folder."),
      Key<S>("jobs", MILLPOSE_AT(jobs), ListOf(EntryFields()), "The jobs.").Required(),
  });
  return fields;
}

}  // namespace config
}  // namespace millpose
