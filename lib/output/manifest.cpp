// SPDX-License-Identifier: GPL-3.0-or-later
#include "output/manifest.hpp"

#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/hash.hpp"

namespace millpose {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;

// A name that a manifest may give: a file below the folder.
bool StaysInside(const fs::path& name) {
  return name.is_relative() && !name.empty() &&
         std::ranges::none_of(name, [](const fs::path& part) { return part == ".."; });
}

// What is wrong with one file, or nothing.
std::string Difference(const fs::path& file, const Manifest::File& expected) {
  if (!Exists(file)) return "is missing";
  const std::string bytes = ReadFile(file);
  return bytes.size() == expected.bytes && Hash(bytes) == expected.hash ? ""
                                                                        : "was changed or is of another plan";
}

// Programs that stand in the folder and not in the manifest.
void FindForeignPrograms(const fs::path& folder, const fs::path& at, const Manifest& manifest,
                         std::vector<Problem>* problems) {
  for (const fs::path& entry : EntriesOf(at)) {
    if (fs::is_directory(entry))
      FindForeignPrograms(folder, entry, manifest, problems);
    else if (!manifest.files.contains(entry.lexically_relative(folder).string()))
      problems->push_back({Place{entry.string()}, "is not of this plan"});
  }
}

// run.json is of the plan whose manifest it names.
std::string WrongRun(const fs::path& file, const std::string& manifest) {
  if (!Exists(file)) return "is missing";
  const Json run = Json::parse(ReadFile(file), nullptr, false);
  return run.is_object() && run.value("manifest", Json()) == Hash(manifest) ? "" : "is of another plan";
}

}  // namespace

std::string ManifestJson(const Manifest& manifest) {
  Json files = Json::array();
  for (const auto& [name, file] : manifest.files)
    files.push_back({{"path", name}, {"bytes", file.bytes}, {"hash", file.hash}});
  return Json{{"schema_version", 1}, {"key", manifest.key}, {"files", files}}.dump(2) + "\n";
}

Manifest ParseManifest(std::string_view text, const std::string& name) {
  try {
    const Json json = Json::parse(text);
    if (json.at("schema_version") != 1) throw InputError({name}, "is of another version of millpose");
    Manifest manifest{json.at("key").get<std::string>(), {}};
    for (const Json& file : json.at("files")) {
      const auto path = file.at("path").get<std::string>();
      if (!StaysInside(path)) throw InputError({name}, fmt::format("{} is no file of this folder", path));
      manifest.files[path] = {file.at("bytes").get<size_t>(), file.at("hash").get<std::string>()};
    }
    return manifest;
  } catch (const Json::exception& error) {
    throw InputError({name}, fmt::format("is no manifest: {}", error.what()));
  }
}

Manifest CheckManifest(const fs::path& folder, std::vector<std::string>* changed) {
  const fs::path file = folder / kManifestFile;
  if (!Exists(file))
    throw InputError({file.string()},
                     "is missing: what the folder holds cannot be distinguished; plan again");
  const std::string text = ReadFile(file);
  Manifest manifest = ParseManifest(text, file.string());
  std::vector<Problem> problems;
  for (const auto& [name, expected] : manifest.files) {
    const std::string difference = Difference(folder / name, expected);
    if (difference.empty()) continue;
    if (changed && *fs::path(name).begin() == kProgramsFolder && Exists(folder / name))
      changed->push_back(name);
    else
      problems.push_back({Place{(folder / name).string()}, difference + " (manifest.json)"});
  }
  FindForeignPrograms(folder, folder / kProgramsFolder, manifest, &problems);
  const std::string run = WrongRun(folder / kRunFile, text);
  if (!run.empty()) problems.push_back({Place{(folder / kRunFile).string()}, run + " (manifest.json)"});
  if (!problems.empty()) throw InputError(std::move(problems));
  return manifest;
}

}  // namespace millpose
