// SPDX-License-Identifier: GPL-3.0-or-later
// Reads path.vtp back with a small parser of its own: tags, attributes, numbers.
#include <sstream>

#include "small_plan.hpp"

namespace millpose {
namespace {

struct Arrays {
  std::map<std::string, std::vector<double>> values;  // by name
  std::map<std::string, std::string> attributes;      // of <Piece>
};

std::string Attribute(const std::string& tag, const std::string& name) {
  const size_t at = tag.find(' ' + name + "=\"");
  if (at == std::string::npos) return "";
  const size_t begin = at + name.size() + 3;
  return tag.substr(begin, tag.find('"', begin) - begin);
}

Arrays ReadVtp(const std::string& xml) {
  Arrays arrays;
  std::vector<std::string> open;
  std::string parent;
  for (size_t at = xml.find('<'); at != std::string::npos; at = xml.find('<', at + 1)) {
    const size_t end = xml.find('>', at);
    const std::string tag = xml.substr(at + 1, end - at - 1);
    if (tag.starts_with("?")) continue;
    if (tag.starts_with("/")) {
      EXPECT_FALSE(open.empty());
      EXPECT_EQ(open.back(), tag.substr(1));
      open.pop_back();
      continue;
    }
    open.push_back(tag.substr(0, tag.find(' ')));
    if (open.back() == "Piece")
      for (const char* name : {"NumberOfPoints", "NumberOfVerts", "NumberOfLines"})
        arrays.attributes[name] = Attribute(tag, name);
    if (open.back() != "DataArray") continue;
    const std::string name = open[open.size() - 2] + "/" + Attribute(tag, "Name");
    std::istringstream numbers(xml.substr(end + 1, xml.find('<', end) - end - 1));
    for (double number; numbers >> number;) arrays.values[name].push_back(number);
  }
  EXPECT_TRUE(open.empty());
  return arrays;
}

}  // namespace

TEST(PathVtp, HasEveryPointPieceAndIndex) {
  const Arrays arrays = ReadVtp(PathVtp(SmallPlan()));
  EXPECT_EQ(arrays.attributes.at("NumberOfPoints"), "4");
  EXPECT_EQ(arrays.attributes.at("NumberOfVerts"), "1");
  EXPECT_EQ(arrays.attributes.at("NumberOfLines"), "1");
  EXPECT_EQ(arrays.values.at("Points/position_mm"),
            (std::vector<double>{0, 0, 0, 1, 0, 0, 2, 0, 0, 3, 0, 0}));
  EXPECT_EQ(arrays.values.at("Lines/connectivity"), (std::vector<double>{0, 1, 2}));
  EXPECT_EQ(arrays.values.at("Lines/offsets"), (std::vector<double>{3}));
  EXPECT_EQ(arrays.values.at("Verts/connectivity"), (std::vector<double>{3}));
  EXPECT_EQ(arrays.values.at("PointData/objective"), (std::vector<double>{1, 2, 3, 0}));
  EXPECT_EQ(arrays.values.at("PointData/planned"), (std::vector<double>{1, 1, 1, 0}));
  for (const char* name : {"lambda_t1_mm_N", "mu", "a6_deg", "clearance_mm", "rotation_deg", "pass"})
    EXPECT_EQ(arrays.values.at(std::string("PointData/") + name).size(), 4u) << name;
  EXPECT_EQ(arrays.values.at("PointData/normal").size(), 12u);
}

TEST(PathVtp, ClosedPiecesReturnToTheirStart) {
  PlanResult plan = SmallPlan();
  plan.passes[0].pieces[0].closed = true;
  const Arrays arrays = ReadVtp(PathVtp(plan));
  EXPECT_EQ(arrays.values.at("Lines/connectivity"), (std::vector<double>{0, 1, 2, 0}));
}

TEST(PathVtp, SecondPassRefersToItsOwnPoints) {
  PlanResult plan = SmallPlan();
  plan.passes.push_back(plan.passes[0]);
  const Arrays arrays = ReadVtp(PathVtp(plan));
  EXPECT_EQ(arrays.values.at("Lines/connectivity"), (std::vector<double>{0, 1, 2, 4, 5, 6}));
  EXPECT_EQ(arrays.values.at("Lines/offsets"), (std::vector<double>{3, 6}));
}

}  // namespace millpose
