// SPDX-License-Identifier: GPL-3.0-or-later
// What a tool path comes to is known before it is made.
#include "toolpath/budget.hpp"

#include <ctime>

#include "base/error.hpp"
#include "tests/geometry/shapes.hpp"
#include "tests/toolpath/toolpath_laws.hpp"
#include "tests/toolpath/with.hpp"

namespace millpose {
namespace {

double NumberOfPoints(const Toolpath& toolpath) {
  double count = 0;
  for (const Pass& pass : toolpath.passes) count += static_cast<double>(pass.points.size());
  return count;
}

/// The refusal of these options; empty when they are taken. It must come quickly.
std::string QuickRefusal(const char* sample, const ToolpathOptions& options) {
  const std::clock_t start = std::clock();
  std::string text;
  try {
    MakeToolpath(SampleMesh(sample), options, {});
  } catch (const InputError& error) {
    text = error.what();
  }
  EXPECT_LT(static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC, 5) << text;
  return text;
}

ToolpathOptions RingOptions() {
  ToolpathOptions options;
  With<Rings>(options);
  options.stepover = 20;
  options.spacing = 5;
  return options;
}

TEST(Budget, TheWayIsForeseen) {
  // A budget just above the truth is enough, one just below is not: the forecast refuses nothing that fits.
  for (const auto& [sample, options] :
       {std::pair("support_pad", PadOptions()), std::pair("cabin_ring", RingOptions())}) {
    const double points = NumberOfPoints(MakeToolpath(SampleMesh(sample), options, {}));
    ToolpathOptions enough = options, little = options;
    enough.budget.most = 1.05 * points + 2;
    little.budget.most = 0.95 * points - 2;
    EXPECT_EQ(QuickRefusal(sample, enough), "") << sample;
    EXPECT_NE(QuickRefusal(sample, little), "") << sample;
  }
}

TEST(Budget, TheKeyThatAsksForTooMuchIsNamed) {
  const auto refused = [](auto change, const char* sample = "support_pad") {
    ToolpathOptions options = std::string_view(sample) == "support_pad" ? PadOptions() : RingOptions();
    change(options);
    return QuickRefusal(sample, options);
  };
  EXPECT_TRUE(refused([](ToolpathOptions& o) {
                o.stepover = 1e-8;
              }).starts_with("toolpath.stepover_mm: given 1e-08"));
  EXPECT_TRUE(
      refused([](ToolpathOptions& o) { o.spacing = 1e-9; }).starts_with("toolpath.spacing_mm: given 1e-09"));
  EXPECT_TRUE(refused([](ToolpathOptions& o) {
                o.layers = {1000, 0.001, 0, 0};
              }).starts_with("toolpath.depth.per_layer_mm: given 0.001"));
  EXPECT_TRUE(
      refused([](ToolpathOptions& o) { o.ends.overrun = 1e9; }).starts_with("toolpath.ends.overrun_mm"));
  EXPECT_TRUE(refused([](ToolpathOptions& o) { o.stepover = 1e-8; }, "cabin_ring")
                  .starts_with("toolpath.stepover_mm"));
  for (const char* strategy : {"pad", "contours"})
    EXPECT_NE(refused([&](ToolpathOptions& o) {
                Choose(o, strategy);
                o.cutter.radius = 5;
                o.stepover = 1e-4;
              }),
              "")
        << strategy;
}

TEST(Budget, AnOddUnitIsNamedFirst) {
  ToolpathOptions options = PadOptions();
  options.stepover = 1e-4;
  options.budget.unit_doubt = "the part is 500000 mm long";
  EXPECT_TRUE(QuickRefusal("support_pad", options).starts_with("workpiece.unit: the part is 500000 mm long"));
}

}  // namespace
}  // namespace millpose
