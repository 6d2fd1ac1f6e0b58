// SPDX-License-Identifier: GPL-3.0-or-later
// What reading and repairing takes, measured in a child process of its own: never more than four times what
// the file and the finished mesh hold, and for a refused file four times the file.
#include <malloc.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/error.hpp"
#include "geometry/import/mesh_import.hpp"
#include "tests/geometry/formats.hpp"
#include "tests/geometry/shapes.hpp"

namespace millpose {
namespace {

struct Use {
  double peak_MB = 0, kept_MB = 0;  ///< above the start: at most, and with the mesh alone
  bool refused = false;
};

double Resident() {
  long pages = 0, resident = 0;
  FILE* file = std::fopen("/proc/self/statm", "r");
  if (file == nullptr || std::fscanf(file, "%ld %ld", &pages, &resident) != 2) std::abort();
  std::fclose(file);
  return static_cast<double>(resident) * static_cast<double>(::sysconf(_SC_PAGESIZE)) / (1 << 20);
}

double Peak() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024;
}

Use Imported(const std::string& bytes) {
  Use use;
  const double start = std::max(Resident(), Peak());
  try {
    const ImportResult import = ImportMesh(ReadMesh(bytes, "part"), {}, "part");
    use.peak_MB = Peak() - start;
    ::malloc_trim(0);
    use.kept_MB = Resident() - start;
  } catch (const InputError&) {
    use.refused = true;
    use.peak_MB = Peak() - start;
  }
  return use;
}

// Large blocks go back at once, so that what is resident is what is held.
Use InChild(const std::string& bytes) {
  int ends[2];
  EXPECT_EQ(::pipe(ends), 0);
  ::malloc_trim(0);  // what other tests have left is not the import's
  const pid_t child = ::fork();
  if (child == 0) {
    const Use use = Imported(bytes);
    const ssize_t written = ::write(ends[1], &use, sizeof use);
    ::_exit(written == sizeof use ? 0 : 1);
  }
  Use use;
  int status = 0;
  ::close(ends[1]);
  EXPECT_EQ(::read(ends[0], &use, sizeof use), static_cast<ssize_t>(sizeof use));
  ::close(ends[0]);
  ::waitpid(child, &status, 0);
  EXPECT_EQ(status, 0);
  return use;
}

TEST(CorpusMemory, StaysBelowFourTimesWhatFileAndMeshNeed) {
#if defined(MILLPOSE_SANITIZED)
  GTEST_SKIP() << "sanitizers hold memory back";
#endif
  ::mallopt(M_MMAP_THRESHOLD, 65536);
  const Triangles sphere = SphereShape(500, 64);  // 16,000 triangles
  Triangles sound = sphere, damaged = sphere;
  Append(damaged, sphere);
  for (size_t f = 0; f < sphere.faces.size(); f += 2) Flip(damaged, f);
  for (size_t f = 0; f < sphere.faces.size(); f += 3)
    damaged.faces.push_back({sphere.faces[f][0], sphere.faces[f][1], sphere.faces[f][1]});
  for (const auto& [name, mesh] : {std::pair("sound", &sound), std::pair("damaged", &damaged)})
    for (const auto& [format, bytes] : InAllFormats(Polygons(*mesh))) {
      SCOPED_TRACE(std::string(name) + ", " + format);
      const double file = static_cast<double>(bytes.size()) / (1 << 20);
      const Use use = InChild(bytes);
      EXPECT_FALSE(use.refused);
      EXPECT_GT(use.kept_MB, 0.5);
      EXPECT_LE(use.peak_MB, 4 * (file + use.kept_MB));
      const Use cut = InChild(bytes.substr(0, bytes.size() / 2));
      EXPECT_TRUE(cut.refused || format == "obj");
      EXPECT_LE(cut.peak_MB, 4 * (file / 2 + (cut.refused ? 0.5 : cut.kept_MB)));
    }
}

}  // namespace
}  // namespace millpose
