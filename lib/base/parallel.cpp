// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/parallel.hpp"

#include <atomic>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>

#include "base/error.hpp"

namespace millpose {

void CheckStop(const std::stop_token& stop) {
  if (stop.stop_requested()) throw Interrupted();
}

namespace {

constexpr size_t kMostWorkers = 1023;

// One call of ParallelFor: its caller and the workers that help it take shares of the indices.
class Loop {
 public:
  Loop(size_t count, size_t threads, std::stop_token stop, const std::function<void(size_t)>& work)
      : helpers_wanted(std::min({count, threads, kMostWorkers + 1}) - 1),
        count_(count),
        threads_(threads),
        stop_(std::move(stop)),
        work_(work) {}

  // Works until no index is left; failures are kept for Finish().
  void Work() noexcept {
    for (size_t begin = 0, end = 0; Take(begin, end);)
      for (size_t i = begin; i < end && !failed_.load(std::memory_order_relaxed); ++i) Do(i);
  }
  bool HasWork() const { return next_.load(std::memory_order_relaxed) < count_; }
  // Once nobody works at it any more.
  void Finish() {
    if (failure_) std::rethrow_exception(failure_);
  }

  const size_t helpers_wanted;
  size_t helpers = 0;  // at work; the crew's lock
  size_t number = 0;   // in the order of beginning; the crew's lock

 private:
  // Large shares first, single indices towards the end: neither the counter nor the last share holds up.
  bool Take(size_t& begin, size_t& end) {
    begin = next_.load(std::memory_order_relaxed);
    do {
      if (begin >= count_) return false;
      end = begin + std::max<size_t>(1, (count_ - begin) / (8 * threads_));
    } while (!next_.compare_exchange_weak(begin, end, std::memory_order_relaxed));
    return true;
  }

  void Do(size_t i) noexcept {
    try {
      CheckStop(stop_);
      work_(i);
    } catch (...) {
      const std::lock_guard lock(failing_);
      if (!failure_) failure_ = std::current_exception();
      failed_ = true;
      next_ = count_;
    }
  }

  const size_t count_, threads_;
  const std::stop_token stop_;
  const std::function<void(size_t)>& work_;
  std::atomic<size_t> next_ = 0;
  std::atomic<bool> failed_ = false;
  std::mutex failing_;
  std::exception_ptr failure_;
};

// The threads of the process beside those that call ParallelFor. They are made when first wanted; where the
// system gives none, there are fewer, and in the end callers work alone.
class Crew {
 public:
  // Never ends: its threads wait in it as long as the process lives.
  static Crew& Get() {
    static Crew* const crew = new Crew;
    return *crew;
  }

  void Run(Loop& loop, size_t threads) {
    Begin(loop, threads);
    loop.Work();
    End(loop);
  }

 private:
  void Begin(Loop& loop, size_t threads) {
    const std::lock_guard lock(mutex_);
    loop.number = ++begun_;
    open_.push_back(&loop);
    const size_t most = std::min(threads - 1, kMostWorkers);
    while (idle_ + starting_ < loop.helpers_wanted && workers_ < most && StartWorker()) {
    }
    for (size_t i = 0; i < std::min(loop.helpers_wanted, idle_); ++i) work_waits_.notify_one();
    callers_wait_.notify_all();
  }

  // Without the loop's last helpers there is work of loops that began later, such as those inside of it.
  void End(Loop& loop) {
    std::unique_lock lock(mutex_);
    std::erase(open_, &loop);
    while (loop.helpers > 0) {
      if (Loop* later = FirstOpen(loop.number))
        Help(*later, lock);
      else
        callers_wait_.wait(lock);
    }
  }

  bool StartWorker() {
    try {
      std::thread([this] { Serve(); }).detach();
    } catch (const std::system_error&) {
      return false;
    }
    ++workers_;
    ++starting_;
    return true;
  }

  void Serve() {
    std::unique_lock lock(mutex_);
    --starting_;
    for (;;) {
      if (Loop* loop = FirstOpen(0)) {
        Help(*loop, lock);
      } else {
        ++idle_;
        work_waits_.wait(lock);
        --idle_;
      }
    }
  }

  // The first of the loops that began after `number` and want help: outer ones come before inner ones.
  Loop* FirstOpen(size_t number) const {
    for (Loop* loop : open_)
      if (loop->number > number && loop->helpers < loop->helpers_wanted && loop->HasWork()) return loop;
    return nullptr;
  }

  void Help(Loop& loop, std::unique_lock<std::mutex>& lock) {
    ++loop.helpers;
    lock.unlock();
    loop.Work();
    lock.lock();
    if (--loop.helpers == 0) callers_wait_.notify_all();
  }

  std::mutex mutex_;
  std::condition_variable work_waits_, callers_wait_;
  std::vector<Loop*> open_;
  size_t begun_ = 0, workers_ = 0, idle_ = 0, starting_ = 0;
};

}  // namespace

void ParallelFor(size_t count, int threads, std::stop_token stop, const std::function<void(size_t)>& work) {
  if (count == 0) return;
  const auto wanted = static_cast<size_t>(std::max(1, threads));
  Loop loop(count, wanted, std::move(stop), work);
  if (loop.helpers_wanted == 0)
    loop.Work();
  else
    Crew::Get().Run(loop, wanted);
  loop.Finish();
}

}  // namespace millpose
