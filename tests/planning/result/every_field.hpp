// SPDX-License-Identifier: GPL-3.0-or-later
// Values with every field set, and whether two are the same in every field: the compiler finds the fields, so
// that one that is added later is looked at without a line here.
#pragma once

#include <bit>
#include <tuple>

#include "base/random.hpp"
#include "planning/result/plan_result.hpp"

namespace millpose::every_field {

struct AnyField {
  template <class T>
  operator T() const;  // NOLINT(google-explicit-constructor): that is its purpose
};

template <class T, class... Given>
consteval size_t Count() {
  if constexpr (requires { T{Given{}..., AnyField{}}; })
    return Count<T, Given..., AnyField>();
  else
    return sizeof...(Given);
}

template <class T>
auto FieldsOf(T& value) {
  constexpr size_t kCount = Count<std::remove_const_t<T>>();
  static_assert(kCount >= 1 && kCount <= 36, "add a line below");
#define MILLPOSE_FIELDS(count, ...)  \
  if constexpr (kCount == (count)) { \
    auto& [__VA_ARGS__] = value;     \
    return std::tie(__VA_ARGS__);    \
  }
  // clang-format off
  MILLPOSE_FIELDS(1, a)
  MILLPOSE_FIELDS(2, a, b)
  MILLPOSE_FIELDS(3, a, b, c)
  MILLPOSE_FIELDS(4, a, b, c, d)
  MILLPOSE_FIELDS(5, a, b, c, d, e)
  MILLPOSE_FIELDS(6, a, b, c, d, e, f)
  MILLPOSE_FIELDS(7, a, b, c, d, e, f, g)
  MILLPOSE_FIELDS(8, a, b, c, d, e, f, g, h)
  MILLPOSE_FIELDS(9, a, b, c, d, e, f, g, h, i)
  MILLPOSE_FIELDS(10, a, b, c, d, e, f, g, h, i, j)
  MILLPOSE_FIELDS(11, a, b, c, d, e, f, g, h, i, j, k)
  MILLPOSE_FIELDS(12, a, b, c, d, e, f, g, h, i, j, k, l)
  MILLPOSE_FIELDS(13, a, b, c, d, e, f, g, h, i, j, k, l, m)
  MILLPOSE_FIELDS(14, a, b, c, d, e, f, g, h, i, j, k, l, m, n)
  MILLPOSE_FIELDS(15, a, b, c, d, e, f, g, h, i, j, k, l, m, n, o)
  MILLPOSE_FIELDS(16, a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p)
  MILLPOSE_FIELDS(17, a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q)
  MILLPOSE_FIELDS(18, a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r)
  MILLPOSE_FIELDS(19, a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, s)
  MILLPOSE_FIELDS(20, a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, s, t)
  MILLPOSE_FIELDS(21, a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, s, t, u)
  MILLPOSE_FIELDS(22, a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, s, t, u, v)
  MILLPOSE_FIELDS(23, a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, s, t, u, v, w)
  MILLPOSE_FIELDS(24, a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, s, t, u, v, w, x)
  MILLPOSE_FIELDS(25, a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, s, t, u, v, w, x, y)
  MILLPOSE_FIELDS(26, a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, s, t, u, v, w, x, y, z)
  MILLPOSE_FIELDS(27, a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, s, t, u, v, w, x, y, z, aa)
  MILLPOSE_FIELDS(28, a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, s, t, u, v, w, x, y, z, aa, ab)
  MILLPOSE_FIELDS(29, a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, s, t, u, v, w, x, y, z, aa, ab, ac)
  MILLPOSE_FIELDS(30, a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, s, t, u, v, w, x, y, z, aa, ab, ac, ad)
  MILLPOSE_FIELDS(31, a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, s, t, u, v, w, x, y, z, aa, ab, ac, ad, ae)
  MILLPOSE_FIELDS(32, a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, s, t, u, v, w, x, y, z, aa, ab, ac, ad, ae, af)
  MILLPOSE_FIELDS(33, a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, s, t, u, v, w, x, y, z, aa, ab, ac, ad, ae, af, ag)
  MILLPOSE_FIELDS(34, a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, s, t, u, v, w, x, y, z, aa, ab, ac, ad, ae, af, ag, ah)
  MILLPOSE_FIELDS(35, a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, s, t, u, v, w, x, y, z, aa, ab, ac, ad, ae, af, ag, ah, ai)
  MILLPOSE_FIELDS(36, a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, s, t, u, v, w, x, y, z, aa, ab, ac, ad, ae, af, ag, ah, ai, aj)
  // clang-format on
#undef MILLPOSE_FIELDS
}

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
template <class T>
void Fill(std::optional<T>& value, RandomStream& random) {
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
template <class T>
inline constexpr bool kIsOptional = false;
template <class T>
inline constexpr bool kIsOptional<std::optional<T>> = true;

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
  } else if constexpr (kIsOptional<T>) {
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
