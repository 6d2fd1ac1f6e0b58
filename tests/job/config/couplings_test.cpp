// SPDX-License-Identifier: GPL-3.0-or-later
// controllers.*.axis_couplings: read with places, written back, and what it means.
#include <gtest/gtest.h>

#include "base/error.hpp"
#include "base/random.hpp"
#include "base/units.hpp"
#include "job/config/config.hpp"
#include "tests/job/config/cell_head.hpp"

namespace millpose {
namespace {

CellSettings CoupledCell(const std::string& section) {
  return ParseCell(std::string(kCellHead) + R"(  stack:
    - {name: cutter, class: cutter, length_mm: 60, diameter_mm: 20}
bodies:
  - {name: base, class: link, mount: base, shape: {sphere: {diameter_mm: 900}}}
controllers:
  linuxcnc: {)" + section +
                       "}\n",
                   "f.yaml");
}

constexpr const char* kFanuc =
    "axis_signs: [1, -1, 1, 1, 1, 1], axis_offsets_deg: [0, 90, -5, 0, 0, 0], axis_couplings: [{axis: 3, "
    "factors: [0, -1, "
    "0, 0, 0, 0]}]";

TEST(Couplings, AreAddedToTheControllersOwnCounts) {
  const PostOptions options = CoupledCell(kFanuc).controllers.at("linuxcnc").shared;
  const AxisConvention alone = options.UncoupledAxes(), axes = options.Axes();
  RandomStream random(1, 0);
  for (int k = 0; k < 50; ++k) {
    Joints q;
    for (double& angle : q) angle = random.Uniform(-3, 3);
    Joints counted = alone.FromArm(q);
    EXPECT_DOUBLE_EQ(counted[1], kPi / 2 - q[1]);
    counted[2] -= counted[1];
    EXPECT_LT((axes.FromArm(q) - counted).cwiseAbs().maxCoeff(), 1e-14);
    EXPECT_LT((axes.ToArm(counted) - q).cwiseAbs().maxCoeff(), 1e-14);
  }
}

TEST(Couplings, AreWrittenAsTheyWereGiven) {
  for (const std::string& section : {std::string(kFanuc), std::string("axis_couplings: []"),
                                     std::string("axis_couplings: [{axis: 2, factors: [0.5, 0, 0, 0, 0, 0]}, "
                                                 "{axis: 6, factors: [0, 0, 0, 0, -0.1, 0]}]")}) {
    const std::string written = WriteCell(CoupledCell(section));
    EXPECT_NE(written.find("axis_couplings:"), std::string::npos) << written;
    const CellSettings again = ParseCell(written, "written");
    EXPECT_EQ(WriteCell(again), written);
    EXPECT_EQ(again.controllers.at("linuxcnc").shared.Axes().matrix(),
              CoupledCell(section).controllers.at("linuxcnc").shared.Axes().matrix());
  }
  EXPECT_EQ(WriteCell(CoupledCell("")).find("axis_couplings"), std::string::npos);
}

TEST(Couplings, SlipsAreNamedWithTheirPlace) {
  const auto expect = [](const std::string& couplings, const std::string& place, const std::string& message) {
    try {
      CoupledCell("axis_couplings: " + couplings);
      ADD_FAILURE() << "accepted: " << couplings;
    } catch (const InputError& error) {
      ASSERT_EQ(error.problems().size(), 1u) << error.what();
      EXPECT_NE(std::string(error.what())
                    .find("f.yaml:23:" + place + ": controllers.linuxcnc.axis_couplings" + message),
                std::string::npos)
          << error.what();
    }
  };
  expect("[{axis: 7, factors: [0, 1, 0, 0, 0, 0]}]", "38", "[0].axis: given 7; allowed: integer 1…6");
  expect("[{axis: 3, factors: [0, -1, 0]}]", "50",
         "[0].factors: given a list of 3; allowed: list of 6 numbers");
  expect("[{axis: 3, factors: [0, -1, 1, 0, 0, 0]}]", "58",
         "[0].factors[2]: given 1; allowed: 0, as axis 3 counts itself once");
  expect("[{axis: 3, factors: [0, 0, 0, 0, 0, 0]}]", "50",
         "[0].factors: given 0 six times, which has no effect");
  expect("[{axis: 3}]", "31", "[0].factors: missing");
  expect("[{axis: 3, factors: [0, 1, 0, 0, 0, 0]}, {axis: 3, factors: [1, 0, 0, 0, 0, 0]}]", "78",
         "[1].axis: given 3 twice; allowed: once");
  expect("[{axis: 2, factors: [0, 0, 1, 0, 0, 0]}, {axis: 3, factors: [0, 1, 0, 0, 0, 0]}]", "30",
         ": given couplings that cannot be undone");
}

}  // namespace
}  // namespace millpose
