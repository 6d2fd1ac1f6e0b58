// SPDX-License-Identifier: GPL-3.0-or-later
// Spoilt CAM paths: each is read or refused with an InputError, and what is read is finite.
#include "base/error.hpp"
#include "tests/geometry/mutate.hpp"
#include "toolpath/cam/cam_import.hpp"

namespace millpose {
namespace {

TEST(CamMutation, SpoiltPathsAreReadOrRefused) {
  const std::string apt =
      "TOOL PATH/P1,TOOL,T\nUNITS/MM\nMSYS/0,0,5,1,0,0,0,1,0\nLOADTL/1\nSPINDL/RPM,3000,CLW\nRAPID\nGOTO/"
      "10,0,20,0,0,1\n"
      "FEDRAT/MMPM,250\nGOTO/10,0,0\nCIRCLE/0,0,0,0,0,1,10\nGOTO/0,10,0,$\n0,0.1,0.99\nGODLTA/0,0,1\nFINI\n";
  const std::string csv =
      "x_mm,y_mm,z_mm,i,j,k,feed_mm_min,pass\n0,0,0,0,0,1,100,1\n5,0,0,0,0,1,100,1\n9,0,0,0,0,1,100,2\n";
  size_t read = 0, refused = 0;
  for (const std::string& seed : {apt, csv}) {
    ASSERT_NO_THROW(ReadCamPath(seed, "seed", {}));
    for (uint64_t i = 0; i < 3000; ++i) {
      RandomStream random(i, 29);
      try {
        const CamPath path = ReadCamPath(Mutated(seed, random), "spoilt", {});
        ++read;
        for (const CamPoint& point : path.points) {
          ASSERT_TRUE(point.position.allFinite() && std::isfinite(point.feed_rate));
          ASSERT_NEAR(point.axis.norm(), 1, 1e-9);
        }
      } catch (const InputError& error) {
        ++refused;
      }
    }
  }
  EXPECT_GT(read, 100);
  EXPECT_GT(refused, 300);
}

}  // namespace
}  // namespace millpose
