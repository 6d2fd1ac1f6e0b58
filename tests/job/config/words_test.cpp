// SPDX-License-Identifier: GPL-3.0-or-later
// Every word that a schema offers for a key is read, and stands in the resolved file again.
#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/yaml/value.hpp"
#include "job/config/config.hpp"
#include "tests/base/source_dir.hpp"

namespace millpose {
namespace {

using yaml::Value;
using Json = nlohmann::json;

/// A key with its words: the keys on the way to it; "[]" for the first item of a list.
struct Choice {
  std::vector<std::string> path;
  std::vector<std::string> words;
};

std::string PathOf(const Choice& choice) { return fmt::format("{}", fmt::join(choice.path, ".")); }

void FindChoices(const Json& schema, const std::vector<std::string>& path, std::vector<Choice>& found) {
  if (schema.contains("enum") && schema["enum"][0].is_string()) found.push_back({path, schema["enum"]});
  const auto inside = [&](const std::string& key, const Json& inner) {
    std::vector<std::string> longer = path;
    longer.push_back(key);
    FindChoices(inner, longer, found);
  };
  if (schema.contains("properties"))
    for (const auto& [key, inner] : schema["properties"].items()) inside(key, inner);
  if (schema.contains("items") && schema["items"].is_object()) inside("[]", schema["items"]);
}

/// The place of a key; null where what it lies in is not given.
Value* PlaceOf(Value& root, const Choice& choice) {
  Value* place = &root;
  for (const std::string& key : choice.path) {
    if (key == "[]") {
      if (place->kind != Value::Kind::kList || place->items.empty()) return nullptr;
      place = &place->items.front();
      continue;
    }
    if (place->kind != Value::Kind::kMap) return nullptr;
    if (place->Find(key) == nullptr && &key == &choice.path.back()) place->Put(key, Value::Text(""));
    const auto at = std::ranges::find(place->keys, key, &Value::Key::text);
    if (at == place->keys.end()) return nullptr;
    place = &place->items[static_cast<size_t>(at - place->keys.begin())];
  }
  return place;
}

/// Tries every word in `file`; how many were taken. Others need keys beside them that the file has not.
template <class Resolve>
int TryEach(const std::string& file, const std::string& schema, const Resolve& resolve) {
  std::vector<Choice> choices;
  FindChoices(Json::parse(schema), {}, choices);
  const Value root = yaml::ReadYaml(ReadFile(std::filesystem::path(SourceDir()) / file), file);
  const std::string unchanged = resolve(yaml::WriteYaml(root));
  int taken = 0;
  for (const Choice& choice : choices) {
    for (const std::string& word : choice.words) {
      Value changed = root;
      Value* place = PlaceOf(changed, choice);
      if (place == nullptr) continue;
      *place = Value::Text(word);
      std::string written;
      try {
        written = resolve(yaml::WriteYaml(changed));
      } catch (const InputError&) {
        continue;
      }
      ++taken;
      EXPECT_EQ(resolve(written), written) << PathOf(choice) << ": " << word;
      Value again = yaml::ReadYaml(written, "written");
      const Value* back = PlaceOf(again, choice);
      const bool stands = back != nullptr && back->text == word;
      EXPECT_TRUE(stands || written == unchanged) << PathOf(choice) << ": " << word;  // or is the default
    }
  }
  return taken;
}

TEST(Words, OfJobsSurvive) {
  const int taken = TryEach("toolpaths/support_pad/job.yaml", JobSchema(),
                            [](const std::string& yaml) { return WriteJob(ParseJob(yaml, "job")); });
  EXPECT_GT(taken, 30);
}

TEST(Words, OfCellsSurvive) {
  const int taken = TryEach("cells/kr500_r2830.yaml", CellSchema(),
                            [](const std::string& yaml) { return WriteCell(ParseCell(yaml, "cell")); });
  EXPECT_GT(taken, 40);
}

}  // namespace
}  // namespace millpose
