// SPDX-License-Identifier: GPL-3.0-or-later
// Pairs and names of a described cell, against what its world looks at.
#include <gtest/gtest.h>
#include <tinyxml2.h>

#include <set>

#include "machine/collision/world.hpp"
#include "tests/report/ros/ros_cells.hpp"
#include "tests/report/ros/urdf_tree.hpp"

namespace millpose {
namespace {

using Pairs = std::set<std::pair<std::string, std::string>>;

std::pair<std::string, std::string> Sorted(std::string a, std::string b) {
  return a < b ? std::pair(a, b) : std::pair(b, a);
}

Pairs DisabledIn(const std::string& srdf) {
  tinyxml2::XMLDocument document;
  EXPECT_EQ(document.Parse(srdf.c_str()), tinyxml2::XML_SUCCESS);
  Pairs pairs;
  const auto* robot = document.FirstChildElement("robot");
  for (const auto* e = robot->FirstChildElement("disable_collisions"); e;
       e = e->NextSiblingElement("disable_collisions"))
    EXPECT_TRUE(pairs.insert(Sorted(e->Attribute("link1"), e->Attribute("link2"))).second);
  return pairs;
}

/// What a world looks at, as it names its own pairs.
Pairs CheckedBy(const Cell& cell, const RosNames& names) {
  Pairs pairs;
  const World world(cell);
  const auto link = [&](const std::string& body) {
    const auto found = std::ranges::find(cell.bodies, body, &Body::name);
    return found == cell.bodies.end() ? std::string()
                                      : names.bodies[static_cast<size_t>(found - cell.bodies.begin())];
  };
  for (int pair = 0;; ++pair) try {
      const std::string text = world.PairName(pair);
      const size_t at = text.find(" and ");
      const std::string first = link(text.substr(0, at)), second = link(text.substr(at + 5));
      if (!first.empty() && !second.empty()) pairs.insert(Sorted(first, second));
    } catch (const std::out_of_range&) {
      return pairs;
    }
}

TEST(RosSrdf, TheSrdfLeavesOutThePairsThatTheCellDoes) {
  size_t excluded = 0;
  for (auto& [name, cell] : AllCells()) {
    Cell with = cell;
    // One pair more that is looked at, named the other way round than bodies come.
    with.excluded_pairs.emplace_back(with.bodies.back().name, with.bodies.front().name);
    excluded += with.excluded_pairs.size();
    const DescribedCell described(with);
    const Pairs disabled = DisabledIn(described.srdf), checked = CheckedBy(with, described.names);
    EXPECT_FALSE(checked.empty());
    for (size_t i = 0; i < with.bodies.size(); ++i)
      for (size_t j = i + 1; j < with.bodies.size(); ++j) {
        const auto pair = Sorted(described.names.bodies[i], described.names.bodies[j]);
        if (checked.contains(pair)) {
          EXPECT_FALSE(disabled.contains(pair)) << name << ": " << pair.first << " " << pair.second;
        } else if (with.external_axes.empty()) {
          EXPECT_TRUE(disabled.contains(pair)) << name << ": " << pair.first << " " << pair.second;
        }
      }
  }
  EXPECT_GT(excluded, AllCells().size());
}

TEST(RosSrdf, WhatExternalAxesMoveApartIsLookedAt) {
  Cell cell = AllCells().back().cell;
  cell.bodies = {
      {.name = "fence", .mount = Mount::kWorld, .shape = Sphere{1}},
      {.name = "post", .mount = Mount::kWorld, .shape = Sphere{1}},
      {.name = "foot", .body_class = BodyClass::kLink, .mount = Mount::kLink, .shape = Sphere{1}},
      {.name = "table", .mount = Mount::kCarriage, .shape = Sphere{1}, .axis = 1},
      {.name = "top", .mount = Mount::kCarriage, .shape = Sphere{1}, .axis = 2},
      {.name = "part", .body_class = BodyClass::kWorkpiece, .mount = Mount::kWorkpiece, .shape = Sphere{1}}};
  cell.excluded_pairs.clear();
  const DescribedCell described(cell);
  EXPECT_EQ(DisabledIn(described.srdf), (Pairs{{"fence", "post"}, {"table", "top"}, {"part", "top"}}));
}

TEST(RosSrdf, NamesAreCleanAndEachIsThereOnce) {
  Cell cell = AllCells().front().cell;
  cell.name = "a <cell> & \"more\"";
  cell.bodies.clear();
  for (const char* name : {"world", "link_3", "../../up", "Spänner 1", "Sp  nner 1"}) {
    Body& body = cell.bodies.emplace_back();
    body.name = name, body.shape = Convex{{{0, 0, 0}, {9, 0, 0}, {0, 9, 0}, {0, 0, 9}}};
  }
  cell.excluded_pairs.clear();
  const DescribedCell described(cell);
  EXPECT_EQ(described.names.bodies,
            (std::vector<std::string>{"world_2", "link_3_2", "_.._.._up", "Sp__nner_1", "Sp__nner_1_2"}));
  EXPECT_EQ(described.names.cell, "a__cell_____more_");
  EXPECT_TRUE(described.urdf.meshes.contains("_.._.._up.stl"));
  EXPECT_EQ(UrdfTree(described.urdf.text).Links().size(), 5u + 6u + 5u);
}

TEST(RosSrdf, CoupledLimitsAreNamedThoughUrdfCannotKeepThem) {
  Cell cell = AllCells().front().cell;
  CoupledLimit limit;
  limit.factors << 0, -1, 1, 0, 0, 0;
  limit.at_most = 1.25;
  cell.arm.coupled_limits = {limit};
  const DescribedCell described(cell);
  EXPECT_NE(described.urdf.text.find("-1 joint_2 + 1 joint_3 at most 1.25 rad"), std::string::npos);
  EXPECT_NO_THROW(UrdfTree(described.urdf.text).Root());
}

}  // namespace
}  // namespace millpose
