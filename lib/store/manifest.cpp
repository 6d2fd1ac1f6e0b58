// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/manifest.hpp"

#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "base/folder.hpp"
#include "base/hash.hpp"

namespace millpose {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;

// A name that a manifest may give: a file below the folder.
bool StaysInside(const fs::path& name) {
  return !name.empty() &&
         std::ranges::all_of(name, [](const fs::path& part) { return IsPlainName(part.string()); });
}

// What is wrong with one file, or nothing.
std::string Difference(const Folder& folder, const std::string& name, const Manifest::File& expected) {
  const Folder::Kind kind = folder.KindOf(name);
  if (kind == Folder::Kind::kNothing) return "is missing";
  if (kind != Folder::Kind::kFile) return "is no regular file";
  const std::string bytes = folder.Read(name);
  return bytes.size() == expected.bytes && Hash(bytes) == expected.hash ? ""
                                                                        : "was changed or is of another plan";
}

// A file of the folder `programs` of a plan, or of one of its operations.
bool IsProgram(const fs::path& name) {
  auto part = name.begin();
  if (*part == kOperationsFolder) std::advance(part, std::min<long>(2, std::distance(part, name.end())));
  return part != name.end() && *part == kProgramsFolder;
}

// Programs that stand in the folder and not in the manifest.
void FindForeignPrograms(const Folder& folder, const fs::path& at, const Manifest& manifest,
                         std::vector<Problem>* problems) {
  const Folder::Kind kind = folder.KindOf(at);
  if (kind == Folder::Kind::kFolder) {
    for (const std::string& name : folder.Below(at).Names())
      FindForeignPrograms(folder, at / name, manifest, problems);
  } else if (kind != Folder::Kind::kNothing && !manifest.files.contains(at.string())) {
    problems->push_back({SourceLocation{(folder.path() / at).string()}, "is not of this plan"});
  }
}

// run.json is of the plan whose manifest it names.
std::string WrongRun(const Folder& folder, const fs::path& file, const std::string& manifest) {
  if (folder.KindOf(file) == Folder::Kind::kNothing) return "is missing";
  if (folder.KindOf(file) != Folder::Kind::kFile) return "is no regular file";
  const Json run = Json::parse(folder.Read(file), nullptr, false);
  return run.is_object() && run.value("manifest", Json()) == Hash(manifest) ? "" : "is of another plan";
}

// Runs, and programs that nobody planned: of the folder `at` in an output folder whose manifest says `text`.
void CheckUnlisted(const Folder& folder, const fs::path& at, const std::string& text,
                   const Manifest& manifest, std::vector<Problem>* problems) {
  FindForeignPrograms(folder, at / kProgramsFolder, manifest, problems);
  const std::string run = WrongRun(folder, at / kRunFile, text);
  if (!run.empty())
    problems->push_back({SourceLocation{(folder.path() / at / kRunFile).string()}, run + " (manifest.json)"});
}

// The same of all operations, those that the manifest does not know among them.
void CheckOperations(const Folder& folder, const Manifest& manifest, std::vector<Problem>* problems) {
  if (folder.KindOf(kOperationsFolder) != Folder::Kind::kFolder) return;
  const fs::path operations = kOperationsFolder;
  for (const std::string& name : folder.Below(operations).Names()) {
    if (manifest.files.contains((operations / name / kManifestFile).string()) &&
        folder.KindOf(operations / name / kManifestFile) == Folder::Kind::kFile)
      CheckUnlisted(folder, operations / name, folder.Read(operations / name / kManifestFile), manifest,
                    problems);
    else if (folder.KindOf(operations / name) == Folder::Kind::kFolder)
      FindForeignPrograms(folder, operations / name / kProgramsFolder, manifest, problems);
  }
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
  } catch (const Json::exception&) {
    throw InputError({name}, "is no manifest of millpose; plan again");
  }
}

Manifest CheckManifest(const fs::path& path, std::vector<std::string>* changed) {
  const Folder folder(path);
  const fs::path file = path / kManifestFile;
  if (folder.KindOf(kManifestFile) == Folder::Kind::kNothing)
    throw InputError({file.string()},
                     "is missing: what the folder holds cannot be distinguished; plan again");
  const std::string text = folder.Read(kManifestFile);
  Manifest manifest = ParseManifest(text, file.string());
  std::vector<Problem> problems;
  for (const auto& [name, expected] : manifest.files) {
    const std::string difference = Difference(folder, name, expected);
    if (difference.empty()) continue;
    if (changed && IsProgram(name) && folder.KindOf(name) == Folder::Kind::kFile)
      changed->push_back(name);
    else
      problems.push_back({SourceLocation{(path / name).string()}, difference + " (manifest.json)"});
  }
  CheckUnlisted(folder, "", text, manifest, &problems);
  CheckOperations(folder, manifest, &problems);
  if (!problems.empty()) throw InputError(std::move(problems));
  return manifest;
}

}  // namespace millpose
