// SPDX-License-Identifier: GPL-3.0-or-later
// Laws that hold of every key of the sample files, found by walking through them: whatever is wrong at a key
// is an error at that key's own line.
#include "base/error.hpp"
#include "base/file.hpp"
#include "base/yaml/value.hpp"
#include "job/config/config.hpp"
#include "tests/base/source_dir.hpp"
#include "tests/base/tier.hpp"

namespace millpose {
namespace {

using yaml::Value;
using Parse = std::function<void(const std::string& text)>;

/// The way to a value: an index into Value::items at every level.
using Way = std::vector<size_t>;

Value& At(Value& root, const Way& way) {
  Value* value = &root;
  for (const size_t i : way) value = &value->items[i];
  return *value;
}

/// For messages: toolpath.region[0].
std::string NameOf(const Value& root, const Way& way) {
  std::string name;
  const Value* value = &root;
  for (const size_t i : way) {
    name += value->kind == Value::Kind::kMap ? "." + value->keys[i].text : fmt::format("[{}]", i);
    value = &value->items[i];
  }
  return name;
}

void FindAll(const Value& value, Way& way, std::vector<Way>& found) {
  found.push_back(way);
  for (size_t i = 0; i < value.items.size(); ++i) {
    way.push_back(i);
    FindAll(value.items[i], way, found);
    way.pop_back();
  }
}

std::vector<Way> AllOf(const Value& root) {
  std::vector<Way> found;
  Way way;
  FindAll(root, way, found);
  return found;
}

/// A sample file as it is resolved, every default written, and how it is read.
struct Sample {
  std::string name, text;
  Parse parse;
};

std::vector<Sample> Samples() {
  std::vector<Sample> samples;
  const std::filesystem::path top = SourceDir();
  for (const char* name : {"support_pad", "cabin_holes", "cabin_trim"}) {
    const std::string file = fmt::format("toolpaths/{}/job.yaml", name);
    samples.push_back({name, WriteJob(ParseJob(ReadFile(top / file), file)),
                       [](const std::string& text) { ParseJob(text, "f.yaml"); }});
  }
  for (const char* name : {"kr500_two_tools", "ur10e"}) {
    const std::string file = fmt::format("cells/{}.yaml", name);
    samples.push_back({name, WriteCell(ParseCell(ReadFile(top / file), file)),
                       [](const std::string& text) { ParseCell(text, "f.yaml"); }});
  }
  return samples;
}

/// Whether reading the changed tree names line of the value at `way` (or of the key that holds it).
testing::AssertionResult IsNamed(const Sample& sample, Value root, const Way& way, const std::string& what) {
  const std::string text = yaml::WriteYaml(root), name = NameOf(root, way);
  Value read = yaml::ReadYaml(text, "f.yaml");
  const int line = At(read, way).mark.line;
  int key_line = line;
  if (!way.empty()) {
    const Value& holder = At(read, Way(way.begin(), way.end() - 1));
    if (holder.kind == Value::Kind::kMap) key_line = holder.keys[way.back()].mark.line;
  }
  try {
    sample.parse(text);
  } catch (const InputError& error) {
    for (const Problem& problem : error.problems())
      if ((problem.place.line == line || problem.place.line == key_line) && problem.place.column > 0)
        return testing::AssertionSuccess();
    return testing::AssertionFailure()
           << sample.name << name << " = " << what << ", line " << line << ": " << error.what();
  }
  return testing::AssertionFailure() << sample.name << name << " = " << what << " is accepted";
}

TEST(EveryKey, RefusesAMapWhereItTakesASingleValueAndNamesItsLine) {
  for (const Sample& sample : Samples()) {
    const Value root = yaml::ReadYaml(sample.text, "f.yaml");
    for (const Way& way : AllOf(root)) {
      Value changed = root;
      if (At(changed, way).kind != Value::Kind::kScalar) continue;
      Value map = Value::Map();
      map.Put("xyzzy", Value::Plain("1"));
      At(changed, way) = map;
      EXPECT_TRUE(IsNamed(sample, changed, way, "a map"));
    }
  }
}

TEST(EveryKey, ThatIsANumberHasBounds) {
  int numbers = 0;
  for (const Sample& sample : Samples()) {
    const Value root = yaml::ReadYaml(sample.text, "f.yaml");
    for (const Way& way : AllOf(root)) {
      const Value& value = At(const_cast<Value&>(root), way);
      if (value.kind != Value::Kind::kScalar || !value.plain ||
          value.text.find_first_not_of("-+.0123456789e") != std::string::npos)
        continue;
      ++numbers;
      for (int side = 0; side < OfTier(1, 2); ++side) {  // by turns, or both
        const char* huge = (numbers + side) % 2 == 0 ? "1e300" : "-1e300";
        Value changed = root;
        At(changed, way) = Value::Plain(huge);
        EXPECT_TRUE(IsNamed(sample, changed, way, huge));
      }
    }
  }
  EXPECT_GT(numbers, 200);
}

/// Maps whose keys the user names: packages of a URDF and the like.
bool HasFreeKeys(const std::string& name) { return name.ends_with(".packages"); }

TEST(EveryKey, AStrangerAmongThemIsNamed) {
  for (const Sample& sample : Samples()) {
    const Value root = yaml::ReadYaml(sample.text, "f.yaml");
    for (const Way& way : AllOf(root)) {
      Value changed = root;
      Value& map = At(changed, way);
      if (map.kind != Value::Kind::kMap || HasFreeKeys(NameOf(root, way))) continue;
      map.Put("xyzzy", Value::Plain("1"));
      Way stranger = way;
      stranger.push_back(map.items.size() - 1);
      EXPECT_TRUE(IsNamed(sample, changed, stranger, "1"));
    }
  }
}

TEST(EveryKey, ResolvesToTheSameWhateverTheirOrder) {
  for (const Sample& sample : Samples()) {
    Value turned = yaml::ReadYaml(sample.text, "f.yaml");
    for (const Way& way : AllOf(turned)) {
      Value& map = At(turned, way);
      if (map.kind != Value::Kind::kMap) continue;
      std::ranges::reverse(map.keys);
      std::ranges::reverse(map.items);
      break;  // the file's own; those within keep theirs
    }
    EXPECT_NO_THROW(sample.parse(yaml::WriteYaml(turned))) << sample.name;
  }
}

}  // namespace
}  // namespace millpose
