// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>
#include <pthread.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <memory>
#include <thread>

#include "base/error.hpp"
#include "commands.hpp"
#include "terminal_progress.hpp"

namespace millpose {
namespace {

// Turns SIGINT and SIGTERM into a request to stop. The signals are blocked in every thread and taken by one
// that waits for them, so that no code runs inside a signal handler. A second signal ends the process at
// once.
class SignalWatch {
 public:
  SignalWatch() {
    sigemptyset(&signals_);
    sigaddset(&signals_, SIGINT);
    sigaddset(&signals_, SIGTERM);
    pthread_sigmask(SIG_BLOCK, &signals_, nullptr);
    std::thread([this] {
      int signal = 0;
      sigwait(&signals_, &signal);
      source_.request_stop();
      sigwait(&signals_, &signal);
      _exit(kInterrupted);
    }).detach();  // lives as long as the process
  }

  std::stop_token token() const { return source_.get_token(); }

 private:
  sigset_t signals_{};
  std::stop_source source_;
};

void Report(const std::string& text) { fmt::print(stderr, "millpose: {}\n", text); }

int RunGuarded(const Run& run, bool quiet) {
  static SignalWatch watch;
  std::unique_ptr<Progress> shown;
  if (!quiet) shown = std::make_unique<TerminalProgress>(isatty(STDERR_FILENO) != 0);
  Session session{shown ? *shown : Silent(), watch.token()};
  try {
    const int status = run(session);
    if (std::fflush(stdout) == 0) return status;
    Report("cannot write to standard output");
    return kBadInput;
  } catch (const InputError& error) {
    Report(error.what());
    return kBadInput;
  } catch (const Interrupted&) {
    Report("interrupted; the same command goes on where it stopped");
    return kInterrupted;
  } catch (const std::exception& error) {
    Report(fmt::format("internal error: {}", error.what()));
    return kInternalError;
  }
}

std::vector<std::string> CommandNames(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands({})) names.push_back(command->get_name());
  return names;
}

void ReportUnknownCommand(const std::string& given, const std::vector<std::string>& names) {
  const std::string near = NearestName(given, names);
  Report(fmt::format("unknown command {}; {}", given,
                     near.empty() ? fmt::format("allowed: {}", fmt::join(names, ", ")) : "nearest: " + near));
}

int Main(int argc, char** argv) {
  CLI::App app{
      "millpose: robotic milling in the stiffest pose, without a GUI\n"
      "Exit status: 0 done; 1 done, with findings; 2 bad input or usage; 3 internal error; 130 interrupted."};
  app.name("millpose");
  app.set_version_flag("--version", "millpose " MILLPOSE_VERSION);
  app.require_subcommand(1);
  app.option_defaults()->always_capture_default();
  bool quiet = false;
  app.add_flag("-q,--quiet", quiet, "No progress on stderr");
  app.fallthrough();
  Run run;
  for (const auto& add : kCommands) add(app, run);
  try {
    app.parse(argc, argv);
  } catch (const CLI::RequiredError& error) {
    const std::vector<std::string> names = CommandNames(app);
    if (argc < 2 || argv[1][0] == '-' || std::ranges::find(names, argv[1]) != names.end())
      return app.exit(error), kBadInput;
    ReportUnknownCommand(argv[1], names);
    return kBadInput;
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? kDone : kBadInput;
  }
  return RunGuarded(run, quiet);
}

}  // namespace
}  // namespace millpose

int main(int argc, char** argv) { return millpose::Main(argc, argv); }
