// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/batch/run_here.hpp"

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <numeric>
#include <thread>

#include "base/parallel.hpp"
#include "base/process.hpp"
#include "run/batch/time_left.hpp"

namespace millpose {
namespace fs = std::filesystem;
namespace {

// Lets a job start when what the running ones take, each at most the largest peak seen so far, leaves room
// for one more. Until a job has ended nothing is known, and one runs alone.
class MemoryGate {
 public:
  explicit MemoryGate(double bound_MB) : bound_(bound_MB) {}

  void Enter() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] {
      if (bound_ <= 0 || running_ == 0) return true;
      return largest_ > 0 && largest_ * (running_ + 1) <= bound_;
    });
    ++running_;
  }
  void Leave(double peak_MB) {
    {
      const std::lock_guard lock(mutex_);
      --running_;
      largest_ = std::max(largest_, peak_MB);
    }
    changed_.notify_all();
  }

 private:
  const double bound_;
  std::mutex mutex_;
  std::condition_variable changed_;
  int running_ = 0;
  double largest_ = 0;
};

// The jobs that run, told whenever they change, and how long what is left may take.
class Running {
 public:
  Running(const std::function<void(const std::string&)>& tell, size_t jobs, size_t places)
      : tell_(tell), waiting_(jobs), places_(places) {}

  void Add(const std::string& name) {
    Change([&] {
      names_.push_back(name);
      began_.push_back(Clock::now());
      --waiting_;
    });
  }
  void Remove(const std::string& name) {
    Change([&] {
      const auto at = std::ranges::find(names_, name) - names_.begin();
      ended_.push_back(SecondsSince(began_[static_cast<size_t>(at)]));
      names_.erase(names_.begin() + at);
      began_.erase(began_.begin() + at);
    });
  }
  std::optional<double> Left() {
    const std::lock_guard lock(mutex_);
    BatchState state{ended_, {}, waiting_, places_};
    for (const Clock::time_point began : began_) state.running.push_back(SecondsSince(began));
    return TimeLeft(state);
  }

 private:
  using Clock = std::chrono::steady_clock;
  static double SecondsSince(Clock::time_point time) {
    return std::chrono::duration<double>(Clock::now() - time).count();
  }

  void Change(const std::function<void()>& change) {
    constexpr size_t kMost = 3;
    // Told one at a time, but not under the lock that Left() takes: who is told may be asking for it.
    const std::lock_guard telling(told_);
    std::string names;
    {
      const std::lock_guard lock(mutex_);
      change();
      const std::vector<std::string> shown(names_.begin(), names_.begin() + std::min(kMost, names_.size()));
      const std::string more =
          names_.size() > kMost ? fmt::format(" and {} more", names_.size() - kMost) : "";
      names = fmt::format("{}{}", fmt::join(shown, ", "), more);
    }
    if (tell_) tell_(names);
  }

  const std::function<void(const std::string&)>& tell_;
  std::mutex told_, mutex_;
  std::vector<std::string> names_;
  std::vector<Clock::time_point> began_;  // of them
  std::vector<double> ended_;             // how long each took, s
  size_t waiting_, places_;
};

// Takes the time left away again, also when the batch is interrupted: what tells it does not outlive it.
class LeftTold {
 public:
  LeftTold(const BatchArguments& arguments, Running* running) : tell_(arguments.tell_left) {
    if (tell_) tell_([running] { return running->Left(); });
  }
  ~LeftTold() {
    if (tell_) tell_({});
  }
  LeftTold(const LeftTold&) = delete;
  LeftTold& operator=(const LeftTold&) = delete;

 private:
  const std::function<void(std::function<std::optional<double>()>)>& tell_;
};

// Shares the threads out: a job gets what no other holds, divided by the jobs that could still start beside
// it.
class ThreadPurse {
 public:
  ThreadPurse(int threads, int places, size_t jobs)
      : free_(threads), places_(places), waiting_(static_cast<int>(jobs)) {}

  int Take() {
    const std::lock_guard lock(mutex_);
    const int share = std::max(1, free_ / std::max(1, std::min(places_, waiting_)));
    --waiting_;
    --places_;
    free_ -= share;
    return share;
  }
  void Return(int share) {
    const std::lock_guard lock(mutex_);
    ++places_;
    free_ += share;
  }

 private:
  std::mutex mutex_;
  int free_, places_, waiting_;
};

JobOutcome RunJob(const BatchJob& job, const fs::path& folder, int threads, bool fresh, MemoryGate* gate,
                  std::stop_token stop) {
  ProcessResult result;
  try {
    CheckStop(stop);
    result = RunProcess(PlanCommand(job, folder, threads, fresh), stop);
  } catch (...) {
    gate->Leave(0);
    throw;
  }
  gate->Leave(result.peak_memory_MB);
  JobOutcome outcome = Judge(folder, result.status, result.errors);
  outcome.wall_s = result.wall_s;  // also of a job that left no figures
  outcome.peak_memory_MB = result.peak_memory_MB;
  return outcome;
}

// The places in `jobs` of what an earlier run has not done; what it has done goes into `outcomes`.
std::vector<size_t> Open(const std::vector<BatchJob>& jobs, const fs::path& folder, int threads,
                         std::stop_token stop, std::vector<JobOutcome>* outcomes) {
  std::vector<char> done(jobs.size(), 0);
  ParallelFor(jobs.size(), threads, stop, [&](size_t i) {
    if (const std::optional<JobOutcome> earlier = UpToDate(jobs[i], folder / jobs[i].name)) {
      (*outcomes)[i] = *earlier;
      done[i] = 1;
    }
  });
  std::vector<size_t> open;
  for (size_t i = 0; i < jobs.size(); ++i)
    if (!done[i]) open.push_back(i);
  return open;
}

}  // namespace

std::vector<JobOutcome> RunHere(const std::vector<BatchJob>& jobs, const fs::path& folder,
                                const BatchArguments& arguments, int threads, Progress& progress,
                                std::stop_token stop) {
  std::vector<JobOutcome> outcomes(jobs.size());
  std::vector<size_t> open(jobs.size());
  std::iota(open.begin(), open.end(), size_t{0});
  progress.Begin("batch", jobs.size());
  if (!arguments.fresh) open = Open(jobs, folder, threads, stop, &outcomes);
  progress.Advance(jobs.size() - open.size());
  const int wanted = arguments.parallel > 0 ? std::min(arguments.parallel, threads) : threads;
  const int parallel = std::min(static_cast<int>(open.size()), wanted);
  MemoryGate gate(arguments.memory_MB);
  ThreadPurse purse(threads, parallel, open.size());
  Running running(arguments.tell_running, open.size(), static_cast<size_t>(std::max(parallel, 1)));
  const LeftTold left_told(arguments, &running);
  const auto plan = [&](const BatchJob& job) {
    gate.Enter();
    const int share = purse.Take();
    running.Add(job.name);
    JobOutcome outcome;
    try {
      outcome = RunJob(job, folder / job.name, share, arguments.fresh, &gate, stop);
    } catch (const Interrupted&) {
      throw;
    } catch (const std::exception& error) {  // what cannot be read or started: the other jobs go on
      outcome.status = 2;
      outcome.cause = error.what();
    }
    running.Remove(job.name);
    purse.Return(share);
    return outcome;
  };
  std::atomic<size_t> next = 0;
  const auto work = [&] {
    for (size_t i = next++; i < open.size() && !stop.stop_requested(); i = next++) {
      try {
        outcomes[open[i]] = plan(jobs[open[i]]);
      } catch (const Interrupted&) {
        return;
      }
      progress.Advance(1);
    }
  };
  {
    std::vector<std::jthread> others;
    try {
      for (int i = 1; i < parallel; ++i) others.emplace_back(work);
    } catch (const std::system_error&) {  // no more threads to be had: those that there are do it
    }
    work();
  }
  if (stop.stop_requested()) throw Interrupted();
  progress.End(fmt::format("{} jobs", jobs.size()));
  return outcomes;
}

}  // namespace millpose
