// SPDX-License-Identifier: GPL-3.0-or-later
#include "piped_objective.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <bit>
#include <cerrno>
#include <cmath>
#include <limits>
#include <mutex>
#include <optional>

#include "base/error.hpp"
#include "base/text.hpp"
#include "planning/pose/expression.hpp"

namespace millpose {
namespace {

constexpr const char* kName = "piped";
constexpr const char* kForce = "force";
static_assert(std::endian::native == std::endian::little);  // numbers cross the pipes as they lie in memory

[[noreturn]] void TellGone(const char* what) {
  throw InputError({}, fmt::format("objective {}: {}; the process that gives its values has ended or closed "
                                   "its pipes",
                                   kName, what));
}

/// The two pipes. One block of indices is under way at a time: the other side needs no threads, and which
/// thread asks first changes no value.
class Pipes {
 public:
  Pipes(int in, int out) : in_(in), out_(out) {}

  void Greet(const std::string& line) {
    const std::scoped_lock lock(mutex_);
    Write(line.data(), line.size());
  }

  void Ask(const std::vector<Lanes>& indices, Lanes& values) {
    std::vector<double> numbers;
    for (const Lanes& index : indices) numbers.insert(numbers.end(), index.v, index.v + kLanes);
    const std::scoped_lock lock(mutex_);
    Write(reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(double));
    Read(reinterpret_cast<char*>(values.v), kLanes * sizeof(double));
  }

 private:
  void Write(const char* bytes, size_t count) const {
    while (count > 0) {
      const ssize_t done = ::write(out_, bytes, count);
      if (done < 0 && errno == EINTR) continue;
      if (done <= 0) TellGone("indices could not be written");
      bytes += done;
      count -= static_cast<size_t>(done);
    }
  }
  void Read(char* bytes, size_t count) const {
    while (count > 0) {
      const ssize_t done = ::read(in_, bytes, count);
      if (done < 0 && errno == EINTR) continue;
      if (done <= 0) TellGone("values could not be read");
      bytes += done;
      count -= static_cast<size_t>(done);
    }
  }

  int in_, out_;
  std::mutex mutex_;
};

std::optional<Pipes>& ThePipes() {
  static std::optional<Pipes> pipes;
  return pipes;
}

/// Minimises what the other side says; poses in which an index is not defined are not asked about.
class PipedObjective final : public Objective {
 public:
  explicit PipedObjective(bool with_force) : with_force_(with_force) {}
  std::string Name() const override { return kName; }
  std::string Unit() const override { return "1"; }
  bool DependsOnFeed() const override { return with_force_; }
  bool NeedsForce() const override { return with_force_; }
  void Evaluate(const ComplianceBlock& c, const ObjectiveContext& context, Lanes& out) const override {
    if (!ThePipes())
      throw InputError({}, fmt::format("objective {}: its values come from another program, and none is "
                                       "connected (docs/python.md)",
                                       kName));
    const std::vector<Lanes> indices = ObjectiveIndices(c, context);
    ThePipes()->Ask(indices, out);
    for (int i = 0; i < kLanes; ++i) {
      const bool defined =
          std::ranges::all_of(indices, [i](const Lanes& index) { return std::isfinite(index.v[i]); });
      if (!defined || !std::isfinite(out.v[i]) || out.v[i] < 0)
        out.v[i] = std::numeric_limits<double>::infinity();
    }
  }

 private:
  bool with_force_;
};

int Descriptor(std::string_view text, const std::string& given) {
  const std::optional<double> number = ParseNumber(text);
  if (!number || *number < 3 || *number > 1e6 || *number != std::floor(*number) ||
      ::fcntl(static_cast<int>(*number), F_SETFD, FD_CLOEXEC) != 0)  // other programs must not hold it open
    throw InputError({}, fmt::format("--objective-pipe: given {}; allowed: IN,OUT, two open descriptors "
                                     "from 3",
                                     given));
  return static_cast<int>(*number);
}

}  // namespace

void AddPipedObjective() {
  // `function` tells settings apart, and with them checkpoints: another function is another objective.
  Objectives().Add(
      {kName,
       {{kForce, 0, 0, {"unread", "read"}, "Of objective piped: whether its function reads the force."},
        {"function", 0, 0}},
       [](const ObjectiveParameters& all) { return std::make_unique<PipedObjective>(all.at(kForce) > 0); }});
}

void ConnectPipedObjective(const std::string& descriptors) {
  const size_t comma = std::min(descriptors.find(','), descriptors.size());
  const std::string_view text = descriptors;
  const int in = Descriptor(text.substr(0, comma), descriptors);
  const int out = Descriptor(text.substr(std::min(comma + 1, text.size())), descriptors);
  ThePipes().emplace(in, out);
  ThePipes()->Greet(
      fmt::format("millpose-objective 1 {} {}\n", kLanes, fmt::join(ObjectiveIndexNames(), " ")));
}

}  // namespace millpose
