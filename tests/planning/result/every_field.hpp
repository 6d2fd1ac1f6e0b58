// SPDX-License-Identifier: GPL-3.0-or-later
// Values with every field set, and whether two are the same in every field: the compiler finds the fields, so
// that one that is added later is looked at without a line here.
#pragma once

#include <bit>
#include <tuple>

#include "base/random.hpp"
#include "base/value_bytes.hpp"
#include "planning/result/plan_result.hpp"

namespace millpose::every_field {

using value_bytes_detail::FieldsOf;

// Numbers first, then what holds others.
inline void Fill(std::string& text, RandomStream& random) {
  text = "text \"" + std::to_string(random.Below(1000)) + "\" \xc3\xa4";
}
template <class T>
requires std::is_arithmetic_v<T>
void Fill(T& number, RandomStream& random) {
  if constexpr (std::is_same_v<T, bool>)
    number = true;
  else if constexpr (std::is_integral_v<T>)
    number = static_cast<T>(1 + random.Below(1000));
  else
    number = random.Normal() / 3;
}
template <class T>
requires std::is_enum_v<T>
void Fill(T& word, RandomStream&) { word = static_cast<T>(1); }
template <int kRows, int kCols>
void Fill(Eigen::Matrix<double, kRows, kCols>& matrix, RandomStream& random) {
  for (Eigen::Index i = 0; i < matrix.size(); ++i) Fill(matrix.data()[i], random);
}
inline void Fill(Pose& pose, RandomStream& random) {
  pose = Eigen::AngleAxisd(random.Uniform(0, 3), Eigen::Vector3d(1, 2, random.Normal()).normalized());
  pose.translation() = Eigen::Vector3d(random.Normal(), random.Normal(), random.Normal());
}
template <class T>
void Fill(T& value, RandomStream& random);
template <class T, size_t kSize>
void Fill(std::array<T, kSize>& list, RandomStream& random) {
  for (T& item : list) Fill(item, random);
}
template <class T>
void Fill(std::vector<T>& list, RandomStream& random) {
  list.resize(2);
  for (T& item : list) Fill(item, random);
}
template <MayBeMissing T>
void Fill(T& value, RandomStream& random) {
  Fill(value.emplace(), random);
}
template <class T>
void Fill(T& value, RandomStream& random) {
  std::apply([&](auto&... field) { (Fill(field, random), ...); }, FieldsOf(value));
  if constexpr (std::is_same_v<T, MillingPoint>) value.own.reset();  // not kept, on purpose
}

template <class T>
bool Same(const T& a, const T& b);
template <class T>
inline constexpr bool kIsList = false;
template <class T>
inline constexpr bool kIsList<std::vector<T>> = true;
template <class T, size_t kSize>
inline constexpr bool kIsList<std::array<T, kSize>> = true;

/// Bit for bit.
template <class T>
bool Same(const T& a, const T& b) {
  if constexpr (std::is_same_v<T, double>) {
    return std::bit_cast<uint64_t>(a) == std::bit_cast<uint64_t>(b);
  } else if constexpr (std::is_arithmetic_v<T> || std::is_enum_v<T> || std::is_same_v<T, std::string>) {
    return a == b;
  } else if constexpr (std::is_same_v<T, Pose>) {
    return a.matrix() == b.matrix();
  } else if constexpr (kIsList<T>) {
    return std::ranges::equal(a, b, [](const auto& x, const auto& y) { return Same(x, y); });
  } else if constexpr (MayBeMissing<T>) {
    return a.has_value() == b.has_value() && (!a || Same(*a, *b));
  } else if constexpr (requires { a.rows(); }) {
    for (Eigen::Index i = 0; i < a.size(); ++i)
      if (!Same(a.data()[i], b.data()[i])) return false;
    return true;
  } else {
    return std::apply(
        [&](const auto&... x) {
          return std::apply([&](const auto&... y) { return (Same(x, y) && ...); }, FieldsOf(b));
        },
        FieldsOf(a));
  }
}

}  // namespace millpose::every_field
