// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>
#include <pthread.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <new>
#include <nlohmann/json.hpp>
#include <sstream>
#include <system_error>
#include <thread>

#include "base/error.hpp"
#include "base/free_memory.hpp"
#include "clean_output.hpp"
#include "commands.hpp"
#include "help_format.hpp"
#include "piped_objective.hpp"
#include "terminal_progress.hpp"

namespace millpose {
namespace {

constexpr const char* kNoMemory =
    "out of memory: the job needs more than this machine, or a limit set on it, gives";
constexpr const char* kNoThread =
    "no thread to be had: the system, or a limit set on it (ulimit -u, pids.max), gives none";
constexpr const char* kNoOutput = "cannot write to standard output";

// As fmt::print, for stderr: where nobody can read it, the work goes on.
template <class... T>
void ToStderr(fmt::format_string<T...> format, T&&... values) {
  const std::string text = fmt::format(format, std::forward<T>(values)...);
  std::fwrite(text.data(), 1, text.size(), stderr);
  std::fflush(stderr);
}

// What goes to stderr besides progress; JSON when progress is.
void Report(const std::string& text, int status, bool json) {
  if (json) {
    const nlohmann::ordered_json line{{"event", "error"}, {"status", status}, {"message", text}};
    ToStderr("{}\n", line.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
  } else {
    ClearLine();  // a bar may stand there
    ToStderr("millpose: {}\n", text);
  }
}

void ReportInterrupted(bool json) {
  Report("interrupted; what is finished is kept: the same command goes on from there", kInterrupted, json);
}

// Turns SIGINT and SIGTERM into a request to stop. The signals are blocked in every thread and taken by one
// that waits for them, so that no code runs inside a signal handler. What cannot look at the request in time
// is ended with the process: files are renamed into place when they are whole, so nothing is lost but what
// was not finished. A second signal ends the process at once.
class SignalWatch {
 public:
  explicit SignalWatch(bool json) {
    sigemptyset(&signals_);
    sigaddset(&signals_, SIGINT);
    sigaddset(&signals_, SIGTERM);
    pthread_sigmask(SIG_BLOCK, &signals_, nullptr);
    std::thread([this, json] { Watch(json); }).detach();  // lives as long as the process
  }

  std::stop_token token() const { return source_.get_token(); }
  /// The first caller reports the end; a second one must not.
  bool MayReport() { return !reported_.exchange(true); }

 private:
  void Watch(bool json) {
    int signal = 0;
    sigwait(&signals_, &signal);
    source_.request_stop();
    // A batch stops its jobs by SIGTERM and waits for them: theirs is the shorter time.
    const timespec grace{0, signal == SIGINT ? 800'000'000 : 500'000'000};
    sigtimedwait(&signals_, nullptr, &grace);
    if (MayReport()) ReportInterrupted(json);
    _exit(kInterrupted);
  }

  sigset_t signals_{};
  std::stop_source source_;
  std::atomic<bool> reported_ = false;
};

// How progress goes to stderr.
struct Output {
  bool quiet = false, json = false;
};

std::unique_ptr<TerminalProgress> MakeProgress(const Output& output) {
  if (output.json) return std::make_unique<TerminalProgress>(ProgressForm::kJson);
  if (output.quiet) return nullptr;
  return std::make_unique<TerminalProgress>(isatty(STDERR_FILENO) != 0 ? ProgressForm::kBar
                                                                       : ProgressForm::kLines);
}

int RunGuarded(const Run& run, const Output& output) {
  static SignalWatch watch(output.json);
  std::unique_ptr<TerminalProgress> shown = MakeProgress(output);
  Session session{shown ? *shown : Silent(), watch.token(),
                  [&shown](const std::string& what) {
                    if (shown) shown->Doing(what);
                  },
                  [&shown](std::function<std::optional<double>()> left) {
                    if (shown) shown->LeftBy(std::move(left));
                  }};
  const auto fail = [&](const std::string& text, int status) {
    shown.reset();
    Report(text, status, output.json);
    return status;
  };
  try {
    const int status = run(session);
    if (std::fflush(stdout) == 0) return status;
    return fail(kNoOutput, kBadInput);
  } catch (const InputError& error) {
    return fail(error.what(), kBadInput);
  } catch (const std::filesystem::filesystem_error& error) {
    return fail(fmt::format("{}: {}", error.path1().string(), error.code().message()), kBadInput);
  } catch (const Interrupted&) {
    shown.reset();
    if (watch.MayReport()) ReportInterrupted(output.json);
    return kInterrupted;
  } catch (const std::bad_alloc&) {
    return fail(kNoMemory, kInternalError);
  } catch (const std::exception& error) {
    const auto* system = dynamic_cast<const std::system_error*>(&error);
    if (system && system->code() == std::errc::resource_unavailable_try_again)
      return fail(kNoThread, kBadInput);
    // fmt tells of a stream that cannot be written by an exception.
    if (std::ferror(stdout) != 0) return fail(kNoOutput, kBadInput);
    return fail(fmt::format("internal error: {}", error.what()), kInternalError);
  }
}

std::vector<std::string> CommandNames(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands({})) names.push_back(command->get_name());
  return names;
}

void ReportUnknownCommand(const std::string& given, const std::vector<std::string>& names) {
  const std::string near = NearestName(given, names);
  ToStderr("millpose: unknown command {}; {}\n", given,
           near.empty() ? fmt::format("allowed: {}", fmt::join(names, ", ")) : "nearest: " + near);
}

// "millpose plan": the program and the chosen subcommand.
std::string CommandOf(const CLI::App& app) {
  std::string command = "millpose";
  for (const CLI::App* chosen : app.get_subcommands()) command += ' ' + chosen->get_name();
  return command;
}

// What the chosen subcommand does not know: a mistyped option with the nearest one, or a word too many, which
// is mostly meant for what is written.
void ReportUnknownArgument(const CLI::App& app) {
  std::vector<std::string> words = app.remaining(true), known;
  const auto option =
      std::ranges::find_if(words, [](const std::string& word) { return word.starts_with('-'); });
  const std::string given = option != words.end() ? *option : words.front();
  for (const CLI::App* chosen : app.get_subcommands())
    for (const CLI::Option* knows : chosen->get_options())
      for (const std::string& name : knows->get_lnames()) known.push_back("--" + name);
  const std::string command = CommandOf(app);
  const bool maybe_out = std::ranges::find(known, "--out") != known.end() && !given.ends_with(".yaml");
  std::string hint = fmt::format("{} --help lists what is", command);
  if (option == words.end() && maybe_out) hint = fmt::format("is it meant as --out {}?", given);
  if (option != words.end())
    if (const std::string near = NearestName(given.substr(0, given.find('=')), known); !near.empty())
      hint = "nearest: " + near;
  ToStderr("millpose: {} {} is not known to {}; {}\n", option != words.end() ? "option" : "argument", given,
           command, hint);
}

// Help, version, or what is wrong with the arguments; CLI11's own status.
int TellParsing(const CLI::App& app, const CLI::Error& error) {
  std::ostringstream out, wrong;
  const int status = app.exit(error, out, wrong);
  fmt::print("{}", out.str());
  if (status != 0) ToStderr("millpose: {}; {} --help tells more\n", error.what(), CommandOf(app));
  return status;
}

int Main(int argc, char** argv) {
  // A reader of stdout or stderr who goes away must not end a plan: writing then fails, and says so.
  std::signal(SIGPIPE, SIG_IGN);
  CleanOutput();
  KeepFreeMemoryAtHand();
  CLI::App app{
      "millpose: robotic milling in the best poses, without a GUI\n"
      "`millpose help COMMAND` explains one command.\n"
      "Exit status: 0 done; 1 done, with findings; 2 bad input or usage; 3 internal error; 130 interrupted."};
  app.name("millpose");
  app.formatter(std::make_shared<HelpFormat>());
  app.set_version_flag("-V,--version", "millpose " MILLPOSE_VERSION);
  app.require_subcommand(1);
  app.option_defaults()->always_capture_default();
  Output output;
  app.add_flag("-q,--quiet", output.quiet, "No progress on stderr");
  app.add_flag("--json-progress", output.json, "Progress and errors on stderr as JSON, one object per line");
  std::string objective_pipe;
  app.add_option("--objective-pipe", objective_pipe,
                 "IN,OUT: descriptors of pipes to the program that gives the values of objective piped "
                 "(docs/python.md)");
  app.fallthrough();
  AddPipedObjective();
  Run run;
  for (const auto& add : kCommands) add(app, run);
  try {
    std::vector<std::string> words(argv + std::min(argc, 1), argv + argc);
    if (!words.empty() && words[0] == "help") {  // as `--help` behind the command that it names
      words.erase(words.begin());
      const std::vector<std::string> names = CommandNames(app);
      if (!words.empty() && std::ranges::find(names, words[0]) == names.end()) {
        ReportUnknownCommand(words[0], names);
        return kBadInput;
      }
      words.emplace_back("--help");
    }
    std::ranges::reverse(words);  // as CLI11 takes them
    app.parse(std::move(words));
  } catch (const CLI::RequiredError& error) {
    const std::vector<std::string> names = CommandNames(app);
    if (argc < 2 || argv[1][0] == '-' || std::ranges::find(names, argv[1]) != names.end())
      return TellParsing(app, error), kBadInput;
    ReportUnknownCommand(argv[1], names);
    return kBadInput;
  } catch (const CLI::ExtrasError&) {
    ReportUnknownArgument(app);
    return kBadInput;
  } catch (const CLI::ParseError& error) {
    return TellParsing(app, error) == 0 ? kDone : kBadInput;
  }
  try {
    return RunGuarded(
        [&](Session& session) {
          if (!objective_pipe.empty()) ConnectPipedObjective(objective_pipe);
          return run(session);
        },
        output);
  } catch (const std::system_error&) {  // not even for the signals
    Report(kNoThread, kBadInput, output.json);
    return kBadInput;
  }
}

}  // namespace
}  // namespace millpose

int main(int argc, char** argv) { return millpose::Main(argc, argv); }
