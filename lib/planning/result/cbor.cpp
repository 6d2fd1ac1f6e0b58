// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/result/cbor.hpp"

#include <bit>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace millpose {
namespace {

constexpr int kUnsigned = 0, kNegative = 1, kText = 3, kSimple = 7;
constexpr int kOneByte = 24, kHalf = 25, kSingle = 26, kDouble = 27;  // of the additional information
constexpr uint64_t kLargest = std::numeric_limits<int64_t>::max();

[[noreturn]] void Refuse(const char* why) { throw std::runtime_error(why); }

/// Of halves only these are written: what no number holds.
double OfHalf(uint64_t bits) {
  if (bits == 0x7c00) return std::numeric_limits<double>::infinity();
  if (bits == 0xfc00) return -std::numeric_limits<double>::infinity();
  if (bits == 0x7e00) return std::numeric_limits<double>::quiet_NaN();
  Refuse("a number of a kind that is not written");
}

}  // namespace

void CborWriter::BigEndian(uint64_t value, int bytes) {
  char text[8];
  for (int i = 0; i < bytes; ++i) text[i] = static_cast<char>(value >> (8 * (bytes - 1 - i)));
  out_.append(text, static_cast<size_t>(bytes));
}

void CborWriter::Head(int major, uint64_t value) {
  const auto put = [&](int info) { out_ += static_cast<char>(major << 5 | info); };
  if (value < kOneByte) return put(static_cast<int>(value));
  const int power = value <= 0xff ? 0 : value <= 0xffff ? 1 : value <= 0xffffffff ? 2 : 3;
  put(kOneByte + power);
  BigEndian(value, 1 << power);
}

void CborWriter::Text(std::string_view text) {
  Head(kText, text.size());
  out_ += text;
}

void CborWriter::Integer(int64_t value) {
  if (value >= 0)
    Head(kUnsigned, static_cast<uint64_t>(value));
  else
    Head(kNegative, static_cast<uint64_t>(-(value + 1)));
}

void CborWriter::Number(double value) {
  if (!std::isfinite(value)) {
    out_ += static_cast<char>(kSimple << 5 | kHalf);
    return BigEndian(std::isnan(value) ? 0x7e00 : value > 0 ? 0x7c00 : 0xfc00, 2);
  }
  const auto single = static_cast<float>(value);
  if (std::bit_cast<uint64_t>(static_cast<double>(single)) == std::bit_cast<uint64_t>(value)) {
    out_ += static_cast<char>(kSimple << 5 | kSingle);
    return BigEndian(std::bit_cast<uint32_t>(single), 4);
  }
  out_ += static_cast<char>(kSimple << 5 | kDouble);
  BigEndian(std::bit_cast<uint64_t>(value), 8);
}

uint8_t CborReader::Byte() {
  if (rest_.empty()) Refuse("ends too early");
  const auto byte = static_cast<uint8_t>(rest_.front());
  rest_.remove_prefix(1);
  return byte;
}

uint64_t CborReader::BigEndian(int bytes) {
  uint64_t value = 0;
  for (int i = 0; i < bytes; ++i) value = value << 8 | Byte();
  return value;
}

uint64_t CborReader::Argument(int info) {
  if (info < kOneByte) return static_cast<uint64_t>(info);
  if (info > kDouble) Refuse("a length of a kind that is not written");
  return BigEndian(1 << (info - kOneByte));
}

uint64_t CborReader::Head(int major) {
  const uint8_t byte = Byte();
  if (byte >> 5 != major) Refuse("another kind of value expected");
  return Argument(byte & 31);
}

uint64_t CborReader::Count(int major) {
  const uint64_t count = Head(major);
  if (count > rest_.size()) Refuse("ends too early");
  return count;
}

std::string_view CborReader::Text() {
  const std::string_view text = rest_.substr(0, Count(kText));
  rest_.remove_prefix(text.size());
  return text;
}

bool CborReader::IsNext(std::string_view text) const {
  CborReader ahead(rest_);
  return !rest_.empty() && static_cast<uint8_t>(rest_.front()) >> 5 == kText && ahead.Text() == text;
}

uint64_t CborReader::Unsigned() { return Head(kUnsigned); }

int64_t CborReader::Integer() {
  if (rest_.empty()) Refuse("ends too early");
  const bool negative = static_cast<uint8_t>(rest_.front()) >> 5 == kNegative;
  const uint64_t value = Head(negative ? kNegative : kUnsigned);
  if (value > kLargest) Refuse("a number out of range");
  return negative ? -1 - static_cast<int64_t>(value) : static_cast<int64_t>(value);
}

bool CborReader::Bool() {
  const uint8_t byte = Byte();
  if (byte != 0xf4 && byte != 0xf5) Refuse("true or false expected");
  return byte == 0xf5;
}

double CborReader::Number() {
  if (rest_.empty()) Refuse("ends too early");
  if (static_cast<uint8_t>(rest_.front()) >> 5 != kSimple) return static_cast<double>(Integer());
  switch (Byte() & 31) {
    case kHalf:
      return OfHalf(BigEndian(2));
    case kSingle:
      return std::bit_cast<float>(static_cast<uint32_t>(BigEndian(4)));
    case kDouble:
      return std::bit_cast<double>(BigEndian(8));
    default:
      Refuse("a number expected");
  }
}

}  // namespace millpose
