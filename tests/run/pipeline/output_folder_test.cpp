// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/output_folder.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <mutex>
#include <thread>

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/hash.hpp"
#include "base/writer_name.hpp"
#include "store/folder_checkpoints.hpp"
#include "store/read_whole.hpp"
#include "store/result_swap.hpp"
#include "tests/base/refusal.hpp"

namespace millpose {
namespace {
namespace fs = std::filesystem;

// A name as a process had it that is gone: no process has a number as large.
std::string OfEnded(const std::string& name) {
  std::string temporary = TemporaryName(name);
  const std::string own = fmt::format(".{}.", ::getpid());
  return temporary.replace(temporary.find(own), own.size(), ".4194305.");
}

class OutputFolderTest : public testing::Test {
 protected:
  void SetUp() override { fs::create_directories(base_); }
  void TearDown() override { fs::remove_all(base_); }

  // A set of these files, each holding its own name and `text`.
  void Publish(const std::vector<std::string>& names, const std::string& text) const {
    const OutputFolder folder(base_ / "out", FolderUse::kResults);
    ResultSet set(folder, kPlanNames);
    for (const std::string& name : names) set.Add(name, name + text);
    const std::string manifest = set.AddManifest(text);
    set.AddRun(fmt::format("{{\"manifest\": \"{}\"}}", manifest));
    set.Publish();
  }

  const fs::path base_ = fs::temp_directory_path() / fmt::format("millpose_output_{}", ::getpid());
};

TEST_F(OutputFolderTest, TakesOnlyWhatIsItsOwn) {
  fs::create_directories(base_ / "theirs");
  WriteFileAtomically(base_ / "theirs" / "thesis.txt", "years of work");
  WriteFileAtomically(base_ / "file", "");
  EXPECT_THROW(OutputFolder(base_ / "theirs", FolderUse::kResults), InputError);
  EXPECT_THROW(OutputFolder(base_ / "file", FolderUse::kResults), InputError);
  EXPECT_EQ(ReadFile(base_ / "theirs" / "thesis.txt"), "years of work");
  EXPECT_NO_THROW(OutputFolder(base_ / "ours", FolderUse::kResults));
  EXPECT_NO_THROW(OutputFolder(base_ / "ours", FolderUse::kResults));
}

TEST_F(OutputFolderTest, OneWritesResultsManyAddCheckpoints) {
  {
    const OutputFolder first(base_ / "out", FolderUse::kCheckpoints);
    const OutputFolder second(base_ / "out", FolderUse::kCheckpoints);
    EXPECT_TRUE(first.warnings().empty());
    EXPECT_THROW(OutputFolder(base_ / "out", FolderUse::kResults), InputError);
  }
  const OutputFolder writer(base_ / "out", FolderUse::kResults);
  try {
    const OutputFolder second(base_ / "out", FolderUse::kResults);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("another run works in this folder"), std::string::npos);
  }
}

TEST_F(OutputFolderTest, WhatAKilledRunLeftHalfWrittenIsRemoved) {
  OutputFolder(base_ / "out", FolderUse::kResults).WriteCheckpoint("key", "content");
  const fs::path half = base_ / "out" / "checkpoints" / OfEnded("other.kept");
  WriteFileAtomically(half, "con");
  EXPECT_EQ(OutputFolder(base_ / "out", FolderUse::kResults).ReadCheckpoint("key"), "content");
  EXPECT_FALSE(fs::exists(half));
}

TEST_F(OutputFolderTest, WhatALiveProcessWritesAndWhatIsTheUsersStays) {
  { const OutputFolder made(base_ / "out", FolderUse::kResults); }
  const fs::path live = base_ / "out" / TemporaryName("points.csv"), users = base_ / "out" / "notes.tmp";
  WriteFileAtomically(live, "half");
  WriteFileAtomically(users, "the user's");
  { const OutputFolder again(base_ / "out", FolderUse::kResults); }
  EXPECT_TRUE(fs::exists(live));
  EXPECT_TRUE(fs::exists(users));
}

TEST_F(OutputFolderTest, AFolderWhoseMarkWasNotFinishedIsTaken) {
  std::filesystem::create_directories(base_ / "killed");
  WriteFileAtomically(base_ / "killed" / OfEnded(".millpose"), "This fol");
  EXPECT_NO_THROW(OutputFolder(base_ / "killed", FolderUse::kResults));
  EXPECT_TRUE(IsOutputFolder(base_ / "killed"));
}

TEST_F(OutputFolderTest, ASetTakesThePlaceOfTheOneBeforeAndOfNothingElse) {
  Publish({"job.yaml", "deflection.csv", "programs/krl/a.src", "programs/krl/a.dat"}, "1");
  WriteFileAtomically(base_ / "out" / "note.txt", "the user's");
  Publish({"job.yaml", "programs/krl/a.src"}, "2");
  EXPECT_EQ(ReadFile(base_ / "out" / "job.yaml"), "job.yaml2");
  EXPECT_EQ(ReadFile(base_ / "out" / "programs" / "krl" / "a.src"), "programs/krl/a.src2");
  EXPECT_FALSE(fs::exists(base_ / "out" / "programs" / "krl" / "a.dat"));
  EXPECT_FALSE(fs::exists(base_ / "out" / "deflection.csv"));
  EXPECT_EQ(ReadFile(base_ / "out" / "note.txt"), "the user's");
  EXPECT_EQ(CheckManifest(base_ / "out").key, "2");
  EXPECT_FALSE(fs::exists(base_ / "out" / kStagingFolder));
  Publish({"job.yaml"}, "3");
  EXPECT_FALSE(fs::exists(base_ / "out" / "programs"));
}

TEST_F(OutputFolderTest, WhatIsNotPublishedIsGone) {
  Publish({"job.yaml"}, "1");
  {
    const OutputFolder folder(base_ / "out", FolderUse::kResults);
    ResultSet(folder, kPlanNames).Add("job.yaml", "2");
  }
  EXPECT_EQ(ReadFile(base_ / "out" / "job.yaml"), "job.yaml1");
  EXPECT_FALSE(fs::exists(base_ / "out" / kStagingFolder));
}

TEST_F(OutputFolderTest, AManifestNamesWhatDiffers) {
  Publish({"job.yaml", "points.csv", "programs/krl/a.src"}, "1");
  WriteFileAtomically(base_ / "out" / "job.yaml", "job.yaml2");
  fs::remove(base_ / "out" / "points.csv");
  WriteFileAtomically(base_ / "out" / "programs" / "krl" / "b.src", "");
  WriteFileAtomically(base_ / "out" / kRunFile, "{\"manifest\": \"of another\"}");
  try {
    CheckManifest(base_ / "out");
    FAIL();
  } catch (const InputError& error) {
    ASSERT_EQ(error.problems().size(), 4U);
    for (size_t i = 0; i < 4; ++i)
      EXPECT_TRUE(error.problems()[i].place.file.ends_with(
          std::array{"job.yaml", "points.csv", "b.src", "run.json"}[i]))
          << error.what();
  }
}

TEST_F(OutputFolderTest, WithoutAManifestThatCanBeReadASetIsMadeAnewAndWhatIsNotOursStays) {
  for (const char* damage : {"", "{", "[]", R"({"schema_version": 7})"}) {
    Publish({"job.yaml", "deflection.csv", "programs/krl/a.src"}, "1");
    WriteFileAtomically(base_ / "out" / "note.txt", "the user's");
    WriteFileAtomically(base_ / "out" / kManifestFile, damage);
    std::vector<std::string> warnings;
    {
      const OutputFolder folder(base_ / "out", FolderUse::kResults);
      ResultSet set(folder, kPlanNames);
      set.Add("job.yaml", "new");
      set.AddRun(fmt::format("{{\"manifest\": \"{}\"}}", set.AddManifest("2")));
      set.Publish();
      warnings = folder.warnings();
    }
    EXPECT_EQ(CheckManifest(base_ / "out").key, "2") << damage;
    EXPECT_FALSE(fs::exists(base_ / "out" / "deflection.csv"));
    EXPECT_FALSE(fs::exists(base_ / "out" / "programs"));
    EXPECT_EQ(ReadFile(base_ / "out" / "note.txt"), "the user's");
    ASSERT_EQ(warnings.size(), 1U);
    EXPECT_NE(warnings.front().find("manifest.json: "), std::string::npos);
    EXPECT_NE(warnings.front().find("left: note.txt"), std::string::npos) << warnings.front();
  }
}

// Links, pipes and folders in the place of everything that millpose names: what they lead to is untouched.
TEST_F(OutputFolderTest, NothingOutsideIsTouchedWhateverAFolderHolds) {
  const std::vector<std::string> names{".lock",       ".journal",      ".staging", ".replaced", "checkpoints",
                                       kManifestFile, kRunFile,        "programs", "meshes",    "job.yaml",
                                       "operations",  ".owner.them.1", kMark};
  for (const std::string& name : names)
    for (const char* kind : {"link to a folder", "link to a file", "dangling link", "pipe", "folder"}) {
      fs::remove_all(base_);
      fs::create_directories(base_ / "outside" / "krl");
      WriteFileAtomically(base_ / "outside" / "krl" / "victim", "theirs");
      WriteFileAtomically(base_ / "outside" / "victim", "theirs");
      Publish({"job.yaml", "programs/krl/a.src"}, "1");
      const fs::path place = base_ / "out" / name;
      fs::remove_all(place);
      const std::string what = kind;
      if (what == "pipe") {
        ASSERT_EQ(::mkfifo(place.c_str(), 0600), 0);
      }
      if (what == "folder") fs::create_directories(place / "krl");
      if (what == "link to a folder") fs::create_symlink("../outside", place);
      if (what == "link to a file") fs::create_symlink("../outside/victim", place);
      if (what == "dangling link") fs::create_symlink("../outside/new", place);
      try {
        Publish({"job.yaml", "programs/krl/victim"}, "2");
        const OutputFolder folder(base_ / "out", FolderUse::kResults);
        folder.WriteCheckpoint("victim", "ours");
        folder.RemoveCheckpoints();
      } catch (const InputError& error) {  // named, and nothing worse
        EXPECT_NE(std::string(error.what()).find(name == kMark ? "out" : name), std::string::npos)
            << error.what();
      }
      size_t count = 0;
      for (const auto& entry : fs::recursive_directory_iterator(base_ / "outside"))
        if (entry.is_regular_file()) {
          EXPECT_EQ(ReadFile(entry.path()), "theirs") << name << ", " << what;
          ++count;
        }
      EXPECT_EQ(count, 2U) << name << ", " << what;
    }
}

TEST_F(OutputFolderTest, OperationsAreOneSetWithTheirJob) {
  const auto publish = [&](const std::string& text, bool keep_first) {
    const OutputFolder folder(base_ / "out", FolderUse::kResults);
    ResultSet whole(folder, kPlanNames);
    for (const char* name : {"01_face", "02_drill"}) {
      const OutputFolder operation = folder.Operation(name);
      operation.WriteCheckpoint("key", name);
      EXPECT_EQ(operation.ReadCheckpoint("key"), name);
      ResultSet own(whole, operation);
      if (keep_first && std::string(name) == "01_face") {
        own.AddStanding();
        continue;
      }
      own.Add("job.yaml", name + text);
      own.Add("programs/krl/a.src", name + text);
      own.AddRun(fmt::format("{{\"manifest\": \"{}\"}}", own.AddManifest(text)));
    }
    whole.Add("job.yaml", text);
    whole.AddRun(fmt::format("{{\"manifest\": \"{}\"}}", whole.AddManifest(text)));
    EXPECT_EQ(Exists(base_ / "out" / "operations"), keep_first) << "before it is published";
    whole.Publish();
  };
  publish("1", false);
  const fs::path operations = base_ / "out" / "operations";
  EXPECT_TRUE(IsOutputFolder(operations / "01_face"));
  EXPECT_EQ(CheckManifest(base_ / "out").files.count("operations/02_drill/programs/krl/a.src"), 1U);
  publish("2", true);
  EXPECT_EQ(CheckManifest(operations / "01_face").key, "1");
  EXPECT_EQ(CheckManifest(operations / "02_drill").key, "2");
  EXPECT_EQ(CheckManifest(base_ / "out").key, "2");
  OutputFolder(base_ / "out", FolderUse::kResults).KeepOperations({"02_drill"});
  EXPECT_FALSE(fs::exists(base_ / "out" / "checkpoints" / "01_face"));
  EXPECT_TRUE(fs::exists(base_ / "out" / "checkpoints" / "02_drill"));
  // Whatever is changed in an operation's folder, the whole is no longer what was planned.
  const auto refused = [&](const fs::path& name, const auto& change) {
    const fs::path copy = base_ / "copy";
    fs::copy(base_ / "out", copy, fs::copy_options::recursive);
    change(copy / "operations" / name);
    EXPECT_THROW(CheckManifest(copy), InputError) << name;
    fs::remove_all(copy);
  };
  refused("", [](const fs::path& path) { fs::remove_all(path); });
  refused("01_face/programs/krl/a.src", [](const fs::path& path) { WriteFileAtomically(path, "edited"); });
  refused("01_face/run.json", [](const fs::path& path) { WriteFileAtomically(path, "{}"); });
  refused("03_more/programs/krl/a.src", [](const fs::path& path) {
    fs::create_directories(path.parent_path());
    WriteFileAtomically(path, "nobody planned it");
  });
}

TEST_F(OutputFolderTest, AReaderSeesOneSetOrSaysThatItIsReplaced) {
  Publish({"job.yaml"}, "1");
  int readings = 0;
  std::string seen;
  const auto read = [&](int replaced) {
    ReadWhole(base_ / "out", [&] {
      seen = ReadFile(base_ / "out" / "job.yaml");
      if (++readings <= replaced)
        Publish({"job.yaml"}, "again");  // the same bytes count too: the set was moved
      if (readings <= replaced) throw InputError({"job.yaml"}, "two sets at once");
    });
  };
  read(2);
  EXPECT_EQ(seen, "job.yamlagain");
  EXPECT_EQ(readings, 3);
  readings = 0;
  EXPECT_NE(RefusalOf([&] { read(3); }).find("is being replaced"), std::string::npos);
  EXPECT_EQ(RefusalOf([&] { ReadWhole(base_ / "out", [] { throw InputError({"a"}, "damaged"); }); }),
            "a: damaged");
  // As a run leaves it that was killed.
  fs::rename(base_ / "out" / kManifestFile, base_ / "out" / ".journal");
  EXPECT_NE(RefusalOf([&] { read(0); }).find("is being replaced"), std::string::npos);
}

TEST_F(OutputFolderTest, AManifestNamesNothingOutsideItsFolder) {
  for (const char* path : {"../secret", "/etc/passwd", "a/../../b", "", "a//../b", "./a"})
    EXPECT_THROW(
        ParseManifest(
            fmt::format(
                R"({{"schema_version": 1, "key": "", "files": [{{"path": "{}", "bytes": 1, "hash": ""}}]}})",
                path),
            "m"),
        InputError);
}

TEST_F(OutputFolderTest, StagesGoAndPassesStayInOperationsToo) {
  const OutputFolder folder(base_ / "out", FolderUse::kResults);
  for (const OutputFolder& one : {folder, folder.Operation("01_face")}) {
    one.WriteCheckpoint("key", "a pass");
    one.WriteStage("surface", "key", "a stage");
  }
  const fs::path deeper = base_ / "out" / "checkpoints" / "01_face" / "01_face";  // nothing of ours
  fs::create_directories(deeper);
  WriteFileAtomically(deeper / "surface.stage", "theirs");
  folder.RemoveStages();
  for (const OutputFolder& one : {folder, folder.Operation("01_face")}) {
    EXPECT_EQ(one.ReadCheckpoint("key"), "a pass");
    EXPECT_FALSE(one.ReadStage("surface", "key"));
  }
  EXPECT_TRUE(fs::exists(deeper / "surface.stage"));
}

TEST_F(OutputFolderTest, WhatACheckpointReplacesIsKeptBesideIt) {
  const OutputFolder folder(base_ / "out", FolderUse::kResults);
  for (const char* bytes : {"first", "second", "third"}) {
    folder.WriteCheckpoint("key", bytes);
    folder.WriteStage("surface", bytes, bytes);
  }
  const FolderCheckpoints kept(folder, true);
  std::vector<std::string> offered;
  const auto refuse = [&](const std::string& bytes) {
    offered.push_back(bytes);
    return false;
  };
  EXPECT_FALSE(kept.Read("key", refuse));
  EXPECT_EQ(offered, (std::vector<std::string>{"third", "second"}));
  for (const char* key : {"first", "second", "third"}) EXPECT_FALSE(kept.ReadStage("surface", key, refuse));
  EXPECT_EQ(offered, (std::vector<std::string>{"third", "second", "second", "third"}));
  EXPECT_FALSE(FolderCheckpoints(folder, false).Read("key", [](const std::string&) { return true; }));
  folder.RemoveStages();
  EXPECT_FALSE(kept.ReadStage("surface", "second", [](const std::string&) { return true; }));
}

// Shares of a job lay the same path at the same time.
TEST_F(OutputFolderTest, RunsThatWriteOneStageAtOnceDoNotMeet) {
  const OutputFolder one(base_ / "out", FolderUse::kCheckpoints),
      other(base_ / "out", FolderUse::kCheckpoints);
  std::string refused;
  std::mutex mutex;
  const auto write = [&](const OutputFolder& folder) {
    for (int i = 0; i < 300; ++i) try {
        folder.WriteStage("surface", "key", "a stage");
      } catch (const InputError& error) {
        const std::lock_guard lock(mutex);
        refused = error.what();
      }
  };
  {
    const std::jthread first([&] { write(one); }), second([&] { write(other); });
  }
  EXPECT_EQ(refused, "");
  EXPECT_EQ(one.ReadStage("surface", "key"), "a stage");
}

TEST_F(OutputFolderTest, DamagedCheckpointsAndThoseOfOthersAreNotUsed) {
  const OutputFolder folder(base_ / "out", FolderUse::kResults);
  EXPECT_FALSE(folder.ReadCheckpoint("key"));
  folder.WriteCheckpoint("key", "content");
  EXPECT_EQ(folder.ReadCheckpoint("key"), "content");
  const fs::path file = base_ / "out" / "checkpoints" / "key.kept";
  std::string bytes = ReadFile(file);
  WriteFileAtomically(base_ / "out" / "checkpoints" / "other.kept", bytes);
  EXPECT_FALSE(folder.ReadCheckpoint("other"));
  for (const size_t at : {size_t{0}, bytes.size() - 1}) {
    std::string damaged = bytes;
    damaged[at] ^= 1;
    WriteFileAtomically(file, damaged);
    EXPECT_FALSE(folder.ReadCheckpoint("key"));
  }
  // As a power cut leaves it: the disk has got none of it, or a part, or blocks of zeros.
  for (size_t size = 0; size < bytes.size(); ++size) {
    WriteFileAtomically(file, bytes.substr(0, size));
    EXPECT_FALSE(folder.ReadCheckpoint("key"));
    WriteFileAtomically(file, bytes.substr(0, size) + std::string(bytes.size() - size, '\0'));
    EXPECT_FALSE(folder.ReadCheckpoint("key"));
  }
  folder.RemoveCheckpoints();
  EXPECT_FALSE(fs::exists(file));
  fs::remove(file);
  fs::create_directories(file / "below");
  EXPECT_FALSE(folder.ReadCheckpoint("key"));
  folder.WriteCheckpoint("key", "again");
  EXPECT_EQ(folder.ReadCheckpoint("key"), "again");
}

}  // namespace
}  // namespace millpose
