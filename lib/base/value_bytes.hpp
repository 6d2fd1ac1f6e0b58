// SPDX-License-Identifier: GPL-3.0-or-later
// The bytes of a value with every field that it has, found by the compiler: a field that is added later is
// part of them without a line here, so nothing that keys are made from can be forgotten.
#pragma once

#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <array>
#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "base/boxed.hpp"
#include "base/hash.hpp"

namespace millpose {
namespace value_bytes_detail {

// Stands for any value while fields are counted; never made.
struct AnyField {
  template <class T>
  operator T() const;  // NOLINT(google-explicit-constructor): that is its purpose
};

template <class T, class... Given>
consteval size_t CountFields() {
  if constexpr (requires { T{Given{}..., AnyField{}}; })
    return CountFields<T, Given..., AnyField>();
  else
    return sizeof...(Given);
}

/// References to the fields of an aggregate, in their order.
template <class T>
auto FieldsOf(T& value) {
  constexpr size_t kCount = CountFields<std::remove_const_t<T>>();
  static_assert(kCount >= 1 && kCount <= 32, "add a line below");
#define MILLPOSE_FIELDS(count, ...)  \
  if constexpr (kCount == (count)) { \
    auto& [__VA_ARGS__] = value;     \
    return std::tie(__VA_ARGS__);    \
  }
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
  MILLPOSE_FIELDS(29, a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, s, t, u, v, w, x, y, z, aa, ab,
                  ac)
  MILLPOSE_FIELDS(30, a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, s, t, u, v, w, x, y, z, aa, ab,
                  ac, ad)
  MILLPOSE_FIELDS(31, a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, s, t, u, v, w, x, y, z, aa, ab,
                  ac, ad, ae)
  MILLPOSE_FIELDS(32, a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, s, t, u, v, w, x, y, z, aa, ab,
                  ac, ad, ae, af)
#undef MILLPOSE_FIELDS
}

template <class T>
inline constexpr bool kIsNumber = std::is_arithmetic_v<T> || std::is_enum_v<T>;

}  // namespace value_bytes_detail

/// Collects the bytes of values: numbers bit for bit, lists and texts with their length in front. Classes
/// with an interface (no aggregates) need a function `void AppendTo(ValueBytes&, const T&)` beside them.
/// ReadValue() (value_reader.hpp) makes values of them again.
class ValueBytes {
 public:
  ValueBytes() = default;
  /// Hands its bytes on to `hasher` instead of collecting them.
  explicit ValueBytes(Hasher& hasher) : hasher_(&hasher) {}

  template <class... T>
  ValueBytes& Add(const T&... values) {
    (Append(values), ...);
    return *this;
  }
  const std::string& bytes() const { return bytes_; }
  void HandOn() {
    hasher_->Add(bytes_);
    bytes_.clear();
  }

 private:
  void AppendRaw(const void* at, size_t size) {
    constexpr size_t kMost = 1 << 16;  // bytes that wait to be hashed
    bytes_.append(static_cast<const char*>(at), size);
    if (hasher_ != nullptr && bytes_.size() > kMost) HandOn();
  }

  void Append(const std::string& text) {
    Append(text.size());
    AppendRaw(text.data(), text.size());
  }
  template <class T, int kRows, int kCols>
  void Append(const Eigen::Matrix<T, kRows, kCols>& matrix) {
    Append(matrix.size());
    AppendRaw(matrix.data(), sizeof(T) * static_cast<size_t>(matrix.size()));
  }
  void Append(const Eigen::Isometry3d& pose) { Append(Eigen::Matrix4d(pose.matrix())); }
  template <class T>
  void Append(const std::vector<T>& list) {
    AppendList(list);
  }
  template <class T, size_t kSize>
  void Append(const std::array<T, kSize>& list) {
    AppendList(list);
  }
  template <class Key, class T>
  void Append(const std::map<Key, T>& map) {
    AppendList(map);
  }
  template <class A, class B>
  void Append(const std::pair<A, B>& pair) {
    Add(pair.first, pair.second);
  }
  template <MayBeMissing T>
  void Append(const T& value) {
    Append(value.has_value());
    if (value) Append(*value);
  }
  template <class... T>
  void Append(const std::variant<T...>& value) {
    Append(value.index());
    std::visit([this](const auto& held) { this->Append(held); }, value);
  }
  template <class T>
  void Append(const std::shared_ptr<const T>& value) {
    AppendTo(*this, *value);
  }
  template <class T>
  requires value_bytes_detail::kIsNumber<T>
  void Append(const T& number) { AppendRaw(&number, sizeof number); }
  template <class T>
  requires std::is_aggregate_v<T>
  void Append(const T& value) {
    std::apply([this](const auto&... field) { this->Add(field...); }, value_bytes_detail::FieldsOf(value));
  }

  template <class List>
  void AppendList(const List& list) {
    Append(list.size());
    for (const auto& item : list) Append(item);
  }

  std::string bytes_;
  Hasher* hasher_ = nullptr;
};

/// The hash of values.
template <class... T>
std::string HashOfValues(const T&... values) {
  Hasher hasher;
  ValueBytes bytes(hasher);
  bytes.Add(values...);
  bytes.HandOn();
  return hasher.Digits();
}

}  // namespace millpose
