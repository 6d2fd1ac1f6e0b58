// SPDX-License-Identifier: GPL-3.0-or-later
// Defaults of nested settings are set by their types alone, whatever stood in that memory before: the schema
// and the resolved job print them. (tests/sanitize/valgrind_test.py sees all of them, in the slow tier.)
#include <gtest/gtest.h>

#include <cstring>
#include <new>

#include "toolpath/region.hpp"

namespace millpose {
namespace {

// A T made without arguments in memory full of bytes that are no number.
template <class T>
class InNan {
 public:
  InNan() {
    std::memset(memory_, 0xff, sizeof memory_);
    asm volatile("" : : "r"(memory_) : "memory");  // else the compiler leaves the filling out
    value_ = new (memory_) T;
  }
  ~InNan() { value_->~T(); }
  InNan(const InNan&) = delete;
  InNan& operator=(const InNan&) = delete;
  const T* operator->() const { return value_; }

 private:
  alignas(T) unsigned char memory_[sizeof(T)];
  T* value_;
};

TEST(Defaults, OfRegionsAreSet) {
  const InNan<RegionBox> box;
  EXPECT_TRUE(box->lower.isZero(0) && box->upper.isZero(0));
  const InNan<HalfSpace> half_space;
  EXPECT_TRUE(half_space->point.allFinite() && half_space->normal.allFinite());
  const InNan<ProjectedPolygon> polygon;
  EXPECT_TRUE(polygon->direction.allFinite());
  const InNan<ConnectedFaces> connected;
  EXPECT_TRUE(connected->seed.allFinite() && std::isfinite(connected->crease));
  const InNan<RegionOptions> region;
  EXPECT_TRUE(std::isfinite(region->facing_within) && std::isfinite(region->rim_distance));
}

}  // namespace
}  // namespace millpose
