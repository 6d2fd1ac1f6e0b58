// SPDX-License-Identifier: GPL-3.0-or-later
// PlanResult and PassResult as CBOR: writer and reader walk the fields of plan_fields.hpp in their order.
#include "base/error.hpp"
#include "base/gzip.hpp"
#include "planning/result/cbor.hpp"
#include "planning/result/plan_fields.hpp"
#include "planning/result/write_plan.hpp"

namespace millpose {
namespace {

// The type of a field that is neither number, text, matrix nor list must have a Fields() of its own.
template <class T>
concept Scalar = std::is_arithmetic_v<T> || std::is_same_v<T, std::string>;

/// How many fields are written of a value.
struct Counter {
  size_t fields = 0;

  template <class T>
  void operator()(const char*, const T&) {
    ++fields;
  }
  template <MayBeMissing T>
  void operator()(const char*, const T& value) {
    fields += value.has_value();
  }
  template <class E, size_t kCount>
  void Words(const char*, const E&, const EnumWords<E, kCount>&) {
    ++fields;
  }
};

struct Writer {
  std::string& out;
  const ByteSink* sink = nullptr;  ///< takes what `out` holds before and after every pass, where there is one
  int threads = 1;                 ///< that passes are written on for it
  bool packed = false;             ///< each time as a member of a gzip file
  CborWriter to{out};

  template <class T>
  void operator()(const char* key, const T& value) {
    to.Text(key);
    Write(value);
  }
  /// A value that is written where there is one.
  template <MayBeMissing T>
  void operator()(const char* key, const T& value) {
    if (value) (*this)(key, *value);
  }
  /// An enum by its word.
  template <class E, size_t kCount>
  void Words(const char* key, const E& value, const EnumWords<E, kCount>& words) {
    (*this)(key, std::string(WordOf(words, value)));
  }

  void Write(bool value) { to.Bool(value); }
  void Write(double value) { to.Number(value); }
  void Write(uint64_t value) { to.Unsigned(value); }
  void Write(const std::string& value) { to.Text(value); }
  template <class T>
  requires(std::is_enum_v<T> || std::is_integral_v<T>) void Write(const T& value) {
    to.Integer(static_cast<int64_t>(value));
  }
  template <int kRows, int kCols>
  void Write(const Eigen::Matrix<double, kRows, kCols>& value) {
    to.List(static_cast<size_t>(value.size()));
    for (Eigen::Index i = 0; i < value.size(); ++i) to.Number(value.data()[i]);
  }
  void Write(const Pose& value) { Write(Eigen::Matrix4d(value.matrix())); }
  template <size_t kSize>
  void Write(const std::array<double, kSize>& value) {
    to.List(kSize);
    for (const double number : value) to.Number(number);
  }
  template <class T>
  void Write(const std::vector<T>& values) {
    to.List(values.size());
    for (const T& value : values) Write(value);
  }
  void Write(const std::vector<PassResult>& passes) {
    to.List(passes.size());
    Flush();
    const auto pass = [&](size_t i) {
      std::string bytes;
      Writer{bytes}.Write(passes[i]);
      return packed ? Gzip(bytes) : bytes;
    };
    WriteInOrder(passes.size(), threads, {}, pass, *sink);
  }
  void Flush() {
    (*sink)(packed ? Gzip(out) : out);
    out.clear();
  }
  template <class T>
  requires(std::is_class_v<T> && !Scalar<T>) void Write(const T& value) {
    auto& fields = const_cast<T&>(value);  // Fields is shared with the reader; the writer only reads
    Counter counter;
    Fields(counter, fields);
    to.Map(counter.fields);
    Fields(*this, fields);
  }
};

/// Reads the fields of a value in the order in which they are written.
struct Reader {
  CborReader& from;
  size_t left = 0;  ///< entries of the map that is read

  template <class T>
  void operator()(const char* key, T& value) {
    if (!Take(key)) throw std::runtime_error(fmt::format("{} expected", key));
    Read(value);
  }
  template <MayBeMissing T>
  void operator()(const char* key, T& value) {
    value.reset();
    if (Take(key)) Read(value.emplace());
  }
  template <class E, size_t kCount>
  void Words(const char* key, E& value, const EnumWords<E, kCount>& words) {
    std::string given;
    (*this)(key, given);
    const auto found = std::ranges::find(words, given, [](const auto& word) { return word.first; });
    if (found == words.end()) throw std::runtime_error(fmt::format("{} '{}' is not known", key, given));
    value = found->second;
  }

  void Read(bool& value) { value = from.Bool(); }
  void Read(double& value) { value = from.Number(); }
  void Read(uint64_t& value) { value = from.Unsigned(); }
  void Read(std::string& value) { value = from.Text(); }
  template <class T>
  requires(std::is_enum_v<T> || std::is_integral_v<T>) void Read(T& value) {
    const int64_t given = from.Integer();
    value = static_cast<T>(given);
    if (static_cast<int64_t>(value) != given) throw std::runtime_error("a number out of range");
  }
  template <int kRows, int kCols>
  void Read(Eigen::Matrix<double, kRows, kCols>& value) {
    Numbers(value.data(), static_cast<size_t>(value.size()));
  }
  void Read(Pose& value) {
    Eigen::Matrix4d matrix;
    Read(matrix);
    value.matrix() = matrix;
  }
  template <size_t kSize>
  void Read(std::array<double, kSize>& value) {
    Numbers(value.data(), kSize);
  }
  template <class T>
  void Read(std::vector<T>& values) {
    const size_t count = from.List();
    values.clear();
    values.reserve(std::min<size_t>(count, 1024));                   // whatever damaged bytes say
    for (size_t i = 0; i < count; ++i) Read(values.emplace_back());  // never more than the bytes hold
  }
  template <class T>
  requires(std::is_class_v<T> && !Scalar<T>) void Read(T& value) {
    Reader inner{from, from.Map()};
    Fields(inner, value);
    inner.End();
  }
  void End() const {
    if (left > 0) throw std::runtime_error(fmt::format("'{}' is not known", from.Text()));
  }

 private:
  bool Take(const char* key) {
    if (left == 0 || !from.IsNext(key)) return false;
    from.Text();
    --left;
    return true;
  }
  void Numbers(double* to, size_t count) {
    if (from.List() != count) throw std::runtime_error("wrong number of matrix entries");
    for (size_t i = 0; i < count; ++i) to[i] = from.Number();
  }
};

// The leading field tells a file of ours from others and one version from the next.
constexpr const char* kFormat = "millpose 9";

void Write(const PlanResult& result, int threads, bool packed, const ByteSink& sink) {
  std::string bytes;
  Writer writer{bytes, &sink, threads, packed};
  auto& fields = const_cast<PlanResult&>(result);
  Counter counter;
  Fields(counter, fields);
  writer.to.Map(1 + counter.fields);
  writer("format", std::string(kFormat));
  Fields(writer, fields);
  writer.Flush();
}

}  // namespace

void WritePlan(const PlanResult& result, int threads, const ByteSink& sink) {
  Write(result, threads, true, sink);
}

std::string Serialise(const PlanResult& result) {
  return BytesOf([&](const ByteSink& sink) { Write(result, 1, false, sink); });
}

PlanResult ParsePlanResult(std::string_view bytes, const std::string& name) {
  try {
    CborReader from(bytes);
    Reader reader{from, from.Map()};
    std::string format;
    reader("format", format);
    if (format != kFormat) throw std::runtime_error("written by another version");
    PlanResult value;
    Fields(reader, value);
    reader.End();
    if (!from.AtEnd()) throw std::runtime_error("something follows its end");
    return value;
  } catch (const std::exception& error) {
    throw InputError({name}, fmt::format("not a plan that this version wrote: {}", error.what()));
  }
}

PlanResult ParsePlanFile(std::string_view bytes, const std::string& name) {
  const std::optional<std::string> plan = Gunzip(bytes);
  if (!plan) throw InputError({name}, "not a plan that this version wrote: no gzip file, or damaged");
  return ParsePlanResult(*plan, name);
}

}  // namespace millpose
