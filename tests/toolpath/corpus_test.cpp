// SPDX-License-Identifier: GPL-3.0-or-later
// Files in the style of CAM systems and postprocessors, written for this test, each with what it means beside
// it:
//   R x y z, G x y z            rapid, straight; the tool axis behind "|" (else +z)
//   A to / centre / about / deg arc
//   E x y z                     the end alone
//   holes n                     so many are left out
//   refused text                the file is refused with it
//   circle, tip, code, axis     keys of the job
#include <algorithm>
#include <filesystem>
#include <sstream>

#include "base/error.hpp"
#include "base/file.hpp"
#include "base/units.hpp"
#include "tests/base/source_dir.hpp"
#include "tests/toolpath/path_check.hpp"

namespace millpose {
namespace {

using Vector = Eigen::Vector3d;

struct Meaning {
  CamReadOptions options;
  std::vector<Want> wants;
  size_t holes = 0;
  std::string refused;
};

Vector Read3(std::istream& in) {
  Vector v;
  in >> v.x() >> v.y() >> v.z();
  return v;
}

Want ReadWant(const std::string& kind, std::istream& in) {
  Want want;
  want.kind = kind == "R"   ? Want::Kind::kRapid
              : kind == "A" ? Want::Kind::kArc
              : kind == "E" ? Want::Kind::kEnd
                            : Want::Kind::kStraight;
  want.to = Read3(in);
  std::string mark;
  if (kind == "A") {
    in >> mark;
    want.centre = Read3(in);
    in >> mark;
    want.about = Read3(in);
    in >> mark >> want.angle;
    want.angle = DegToRad(want.angle);
  }
  if (in >> mark) want.axis = Read3(in).normalized();
  EXPECT_FALSE(in.fail() && !in.eof()) << "a line of " << kind;
  return want;
}

void ReadOption(const std::string& key, std::istream& in, Meaning& meaning, std::vector<RotaryAxis>& axes) {
  std::string word, value;
  in >> word;
  if (key == "holes") meaning.holes = std::stoul(word);
  if (key == "circle") meaning.options.circle = word == "axis" ? CircleSense::kAxis : CircleSense::kTangent;
  if (key == "tip") meaning.options.tip_programming = word == "true";
  if (key == "code" && in >> value)
    meaning.options.kinematics_codes[std::stoi(word.substr(1))] = value == "tip";
  if (key != "axis") return;
  RotaryAxis axis;
  axis.letter = word[0];
  axis.direction = Read3(in);
  in >> value;
  axis.carries_workpiece = value == "workpiece";
  axis.point = Read3(in);
  axes.push_back(axis);
}

Meaning ReadMeaning(const std::string& text) {
  Meaning meaning;
  std::vector<RotaryAxis> axes;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream in(line);
    std::string key;
    in >> key;
    if (key == "refused")
      meaning.refused = line.substr(8);
    else if (key.size() == 1)
      meaning.wants.push_back(ReadWant(key, in));
    else
      ReadOption(key, in, meaning, axes);
  }
  meaning.options.rotary_axes = RotaryAxes(axes);
  return meaning;
}

TEST(Corpus, FilesMeanWhatStandsBesideThem) {
  size_t read = 0, refused = 0;
  for (const auto& entry :
       std::filesystem::directory_iterator(std::string(SourceDir()) + "/tests/toolpath/corpus")) {
    if (entry.path().extension() != ".want") continue;
    const std::filesystem::path file = entry.path().parent_path() / entry.path().stem();
    const Meaning meaning = ReadMeaning(ReadFile(entry.path()));
    try {
      const CamPath path = ReadCamPath(ReadFile(file), file.filename(), meaning.options);
      EXPECT_EQ(meaning.refused, "") << file;
      EXPECT_EQ(Difference(path, meaning.wants, 1e-6, meaning.options.chord_tolerance), "") << file;
      EXPECT_EQ(path.holes_left_out.size(), meaning.holes) << file;
      ++read;
    } catch (const InputError& error) {
      EXPECT_FALSE(meaning.refused.empty()) << error.what();
      EXPECT_NE(std::string(error.what()).find(meaning.refused), std::string::npos) << error.what();
      ++refused;
    }
  }
  EXPECT_EQ(read, 29u);
  EXPECT_EQ(refused, 9u);
}

}  // namespace
}  // namespace millpose
