// SPDX-License-Identifier: GPL-3.0-or-later
// `man` and `completion`: the option table that parses is the one that is documented.
#include <fmt/format.h>

#include <algorithm>

#include "commands.hpp"

namespace millpose {
namespace {

/// Text as roff shows it: backslashes, hyphens that are meant, and no line that begins as a request.
std::string Roff(const std::string& text) {
  std::string escaped;
  for (char c : text) {
    if ((c == '.' || c == '\'') && (escaped.empty() || escaped.back() == '\n')) escaped += "\\&";
    if (c == '\\')
      escaped += "\\e";
    else if (c == '-')
      escaped += "\\-";
    else
      escaped += c;
  }
  return escaped;
}

/// The options that people give; of one command or of all.
std::vector<const CLI::Option*> Options(const CLI::App& command) {
  return command.get_options([](const CLI::Option* option) { return !option->get_group().empty(); });
}

std::string OptionsOf(const CLI::App& command) {
  std::string text;
  for (const CLI::Option* option : Options(command)) {
    const bool positional = !option->nonpositional();
    const std::string type = option->get_type_name();
    const std::string value = positional || type.empty() ? "" : " " + type;
    std::string rest = option->get_description();
    if (!option->get_default_str().empty()) rest += fmt::format(" (default {})", option->get_default_str());
    text += fmt::format(".TP\n\\fB{}\\fR{}\n{}\n", Roff(option->get_name(positional, true)), Roff(value),
                        Roff(rest));
  }
  return text;
}

/// The command line of a subcommand: options in brackets, then what is required.
std::string Synopsis(const CLI::App& command) {
  std::string text = fmt::format("\\fBmillpose {}\\fR [\\fIoptions\\fR]", Roff(command.get_name()));
  for (const CLI::Option* option : Options(command)) {
    if (!option->get_positional()) continue;
    const std::string name = fmt::format("\\fI{}\\fR", Roff(option->get_name(true, false)));
    text += option->get_required() ? " " + name : " [" + name + "]";
  }
  return text + "\n";
}

std::vector<const CLI::App*> Commands(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App* command) { return !command->get_name().empty(); });
}

std::string Examples() {
  constexpr std::pair<const char*, const char*> kExamples[] = {
      {"millpose init part.step --arm kr500_r2830", "A first cell and job for a part, in the folder part."},
      {"millpose check part/job.yaml", "What of the job's tool path the arm reaches."},
      {"millpose plan part/job.yaml", "Programs and reports, in part/part.out."},
      {"millpose plan part/job.yaml --set toolpath.stepover_mm=4 -o finer",
       "The same with one setting changed."},
      {"millpose inspect part/part.out --worst 5", "The five softest points."},
      {"millpose verify part/part.out --job part/job.yaml", "Reads the programs back and replays them."},
      {"millpose place part/job.yaml --set 'placement={x_mm: {from: 1500, to: 2100}}'",
       "The best place of the part between two places."},
      {"millpose batch parts/*/job.yaml -o night", "Many jobs, with an index page."},
  };
  std::string text = ".SH EXAMPLES\n";
  for (const auto& [command, meaning] : kExamples)
    text += fmt::format(".TP\n\\fB{}\\fR\n{}\n", Roff(command), Roff(meaning));
  return text;
}

std::string ManPage(const CLI::App& app) {
  std::string page =
      ".TH MILLPOSE 1\n.SH NAME\nmillpose \\- robotic milling in the best poses, without a GUI\n"
      ".SH SYNOPSIS\n";
  for (const CLI::App* command : Commands(app)) page += Synopsis(*command) + ".br\n";
  page +=
      ".SH DESCRIPTION\nReads a job (YAML, with a mesh and a robot cell) and writes robot programs in which "
      "each "
      "milling point is cut in a pose in which the cutting force bends the six\\-axis arm least, with "
      "points.csv, summary.json, path.vtp and report.html next to them. Results go to standard output, "
      "progress "
      "and messages to standard error.\n.SH OPTIONS\n" +
      OptionsOf(app) + ".SH COMMANDS\n";
  for (const CLI::App* command : Commands(app))
    page += fmt::format(".SS {}\n{}\n{}", Roff(command->get_name()), Roff(command->get_description()),
                        OptionsOf(*command));
  return page + Examples() +
         ".SH EXIT STATUS\n.TP\n0\ndone\n.TP\n1\ndone, with findings: points or gaps that could not be "
         "planned, a "
         "program that deviates\n.TP\n2\nbad input or usage\n.TP\n3\ninternal error\n.TP\n130\ninterrupted\n";
}

/// All names of a command's options, "-q --quiet …".
std::string Flags(const CLI::App& command) {
  std::vector<std::string> flags;
  for (const CLI::Option* option : Options(command)) {
    for (const std::string& name : option->get_snames()) flags.push_back("-" + name);
    for (const std::string& name : option->get_lnames()) flags.push_back("--" + name);
  }
  return fmt::format("{}", fmt::join(flags, " "));
}

/// The words that an option or argument takes, where it takes but a few: CLI11 has them in the type's name,
/// "TEXT:{job,cell}".
std::string WordsOf(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  const size_t open = type.find(":{");
  if (open == std::string::npos || type.back() != '}') return "";
  std::string words = type.substr(open + 2, type.size() - open - 3);
  std::ranges::replace(words, ',', ' ');
  return words;
}

/// Lines of a `case` over command and word before: what may follow an option.
std::string ValueCases(const CLI::App& command, const std::string& name) {
  std::string cases;
  for (const CLI::Option* option : Options(command)) {
    const std::string words = WordsOf(*option);
    if (words.empty() || option->get_positional()) continue;
    for (const std::string& flag : option->get_lnames())
      cases += fmt::format("    \"{} --{}\") values=\"{}\" ;;\n", name, flag, words);
  }
  return cases;
}

/// Words of the first argument that has some.
std::string ArgumentWords(const CLI::App& command) {
  for (const CLI::Option* option : Options(command))
    if (option->get_positional())
      if (std::string words = WordsOf(*option); !words.empty()) return words;
  return "";
}

std::string BashCompletion(const CLI::App& app) {
  std::vector<std::string> names;
  std::string cases, values;
  for (const CLI::App* command : Commands(app)) {
    const std::string name = command->get_name();
    names.push_back(name);
    cases +=
        fmt::format("    {}) flags=\"{}\" words=\"{}\" ;;\n", name, Flags(*command), ArgumentWords(*command));
    values += ValueCases(*command, name);
  }
  return fmt::format(R"(# bash completion for millpose; made by `millpose completion`
_millpose() {{
  local word=${{COMP_WORDS[COMP_CWORD]}} before=${{COMP_WORDS[COMP_CWORD-1]}} command= flags= words= values= i
  for ((i = 1; i < COMP_CWORD; ++i)); do
    [[ ${{COMP_WORDS[i]}} == -* ]] || {{ command=${{COMP_WORDS[i]}}; break; }}
  done
  case $command in
    "") flags="{}" words="{} help" ;;
    help) words="{}" ;;
{}  esac
  case "$command $before" in
    "") ;;
{}  esac
  if [[ -n $values ]]; then
    COMPREPLY=($(compgen -W "$values" -- "$word"))
  elif [[ $word == -* ]]; then
    COMPREPLY=($(compgen -W "$flags {}" -- "$word"))
  elif [[ -n $words ]]; then
    COMPREPLY=($(compgen -W "$words" -- "$word"))
  else
    COMPREPLY=($(compgen -f -- "$word"))
  fi
}}
complete -o filenames -F _millpose millpose
)",
                     Flags(app), fmt::join(names, " "), fmt::join(names, " "), cases, values, Flags(app));
}

}  // namespace

void AddManCommand(CLI::App& app, Run& run) {
  app.add_subcommand("man", "Print the manual page (roff)")->callback([&app, &run] {
    run = [&app](Session&) {
      fmt::print("{}", ManPage(app));
      return kDone;
    };
  });
}

void AddCompletionCommand(CLI::App& app, Run& run) {
  app.add_subcommand("completion", "Print the completion script for bash")->callback([&app, &run] {
    run = [&app](Session&) {
      fmt::print("{}", BashCompletion(app));
      return kDone;
    };
  });
}

}  // namespace millpose
