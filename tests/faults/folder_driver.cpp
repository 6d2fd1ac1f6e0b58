// SPDX-License-Identifier: GPL-3.0-or-later
// Writes a small set of results as a plan does, to be killed on the way.
// Usage: folder_driver FOLDER LETTER: files hold the letter; with set B one file less and one more than with
// A; with C and D the same of two operations, of which the second of D is another than that of C.
// `folder_driver FOLDER -` repairs the folder, as `plan` does that finds one open, and checks its
// manifest; `… sign` makes the manifest one of what stands there.
#include <fmt/format.h>

#include <cstdio>

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/hash.hpp"
#include "store/output_folder.hpp"

namespace millpose {
namespace {

void Write(const std::string& folder_name, const std::string& letter) {
  const OutputFolder folder(folder_name, FolderUse::kResults);
  folder.WriteCheckpoint("key" + letter, letter);
  ResultSet set(folder, kPlanNames);
  for (const char* name : {"job.yaml", "summary.json", "programs/krl/a.src", "programs/krl/a.dat"})
    set.Add(name, letter + letter);
  set.Add(letter == "A" ? "deflection.csv" : "path.vtp", letter);
  set.Add(letter == "A" ? "programs/linuxcnc/a.ngc" : "programs/sinumerik/a.mpf", letter);
  const std::string manifest = set.AddManifest(letter);
  set.AddRun(fmt::format("{{\"manifest\": \"{}\"}}\n", manifest));
  set.Publish();
}

void AddFiles(ResultSet& set, const std::string& letter) {
  for (const char* name : {"job.yaml", "summary.json", "programs/krl/a.src"}) set.Add(name, letter + letter);
  set.AddRun(fmt::format("{{\"manifest\": \"{}\"}}\n", set.AddManifest(letter)));
}

void WriteSeveral(const std::string& folder_name, const std::string& letter) {
  const OutputFolder folder(folder_name, FolderUse::kResults);
  ResultSet whole(folder, kPlanNames);
  const std::string second = letter == "C" ? "02_trim" : "02_drill";
  for (const std::string& name : {std::string("01_face"), second}) {
    const OutputFolder operation = folder.Operation(name);
    operation.WriteCheckpoint("key" + letter, letter);
    ResultSet own(whole, operation);
    AddFiles(own, letter);
  }
  AddFiles(whole, letter);
  whole.Publish();
  folder.KeepOperations({"01_face", second});
}

void Sign(const std::filesystem::path& folder) {
  Manifest manifest = ParseManifest(ReadFile(folder / kManifestFile), kManifestFile);
  const std::string before = Hash(ManifestJson(manifest));
  for (auto& [name, file] : manifest.files) {
    const std::string bytes = ReadFile(folder / name);
    file = {bytes.size(), Hash(bytes)};
  }
  std::string run = ReadFile(folder / kRunFile);
  run.replace(run.find(before), before.size(), Hash(ManifestJson(manifest)));
  WriteFileAtomically(folder / kManifestFile, ManifestJson(manifest));
  WriteFileAtomically(folder / kRunFile, run);
}

void Repair(const std::string& folder) {
  FinishSwap(folder, {});
  fmt::print("{}\n", CheckManifest(folder).key);
}

int Run(const std::string& folder, const std::string& what) {
  try {
    if (what == "-")
      Repair(folder);
    else if (what == "sign")
      Sign(folder);
    else if (what == "A" || what == "B")
      Write(folder, what);
    else
      WriteSeveral(folder, what);
    return 0;
  } catch (const InputError& error) {
    std::fputs((std::string(error.what()) + '\n').c_str(), stderr);
    return 2;
  }
}

}  // namespace
}  // namespace millpose

int main(int argc, char** argv) { return argc == 3 ? millpose::Run(argv[1], argv[2]) : 2; }
