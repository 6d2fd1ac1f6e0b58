// SPDX-License-Identifier: GPL-3.0-or-later
// Values of the bytes that ValueBytes made of them, by this very program on a machine of this kind.
#pragma once

#include <cstring>
#include <string_view>

#include "base/value_bytes.hpp"

namespace millpose {

class ValueReader {
 public:
  explicit ValueReader(std::string_view bytes) : rest_(bytes) {}

  /// False where the bytes are not those of a T; `value` may be anything then.
  template <class T>
  bool Read(T& value) {
    Take(value);
    return good_ && rest_.empty();
  }

 private:
  void TakeRaw(void* to, size_t size) {
    good_ = good_ && size <= rest_.size();
    if (!good_) return;
    std::memcpy(to, rest_.data(), size);
    rest_.remove_prefix(size);
  }
  /// Of a list or text, whose items are a byte long at least.
  size_t TakeSize() {
    size_t size = 0;
    TakeRaw(&size, sizeof size);
    good_ = good_ && size <= rest_.size();
    return good_ ? size : 0;
  }

  void Take(std::string& text) {
    text.resize(TakeSize());
    TakeRaw(text.data(), text.size());
  }
  template <class T, int kRows, int kCols>
  void Take(Eigen::Matrix<T, kRows, kCols>& matrix) {
    Eigen::Index size = 0;
    TakeRaw(&size, sizeof size);
    good_ = good_ && size == matrix.size();
    TakeRaw(matrix.data(), sizeof(T) * static_cast<size_t>(matrix.size()));
  }
  void Take(Eigen::Isometry3d& pose) {
    Eigen::Matrix4d matrix;
    Take(matrix);
    pose.matrix() = matrix;
  }
  template <class T>
  void Take(std::vector<T>& list) {
    const size_t size = TakeSize();
    list.clear();
    for (size_t i = 0; i < size && good_; ++i) Take(list.emplace_back());
  }
  template <class T>
  requires value_bytes_detail::kIsNumber<T>
  void Take(std::vector<T>& list) {
    const size_t size = TakeSize();
    good_ = good_ && size <= rest_.size() / sizeof(T);
    list.resize(good_ ? size : 0);
    if (!list.empty()) TakeRaw(list.data(), sizeof(T) * list.size());
  }
  template <class T, size_t kSize>
  void Take(std::array<T, kSize>& list) {
    good_ = good_ && TakeSize() == kSize;
    for (T& item : list) Take(item);
  }
  template <class Key, class T>
  void Take(std::map<Key, T>& map) {
    const size_t size = TakeSize();
    map.clear();
    for (size_t i = 0; i < size && good_; ++i) {
      Key key{};
      Take(key);
      Take(map[key]);
    }
  }
  template <class A, class B>
  void Take(std::pair<A, B>& pair) {
    Take(pair.first);
    Take(pair.second);
  }
  template <MayBeMissing T>
  void Take(T& value) {
    bool given = false;
    Take(given);
    value.reset();
    if (given && good_) Take(value.emplace());
  }
  template <class T>
  requires value_bytes_detail::kIsNumber<T>
  void Take(T& number) { TakeRaw(&number, sizeof number); }
  template <class T>
  requires std::is_aggregate_v<T>
  void Take(T& value) {
    std::apply([this](auto&... field) { (this->Take(field), ...); }, value_bytes_detail::FieldsOf(value));
  }

  std::string_view rest_;
  bool good_ = true;
};

}  // namespace millpose
