// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/pipeline/operations/whole_report.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <numeric>

#include "base/text.hpp"
#include "planning/result/cycle_time.hpp"
#include "planning/result/stock_figures.hpp"
#include "program/calling_program.hpp"
#include "program/post_entry.hpp"
#include "program/scanner.hpp"
#include "report/budget_json.hpp"
#include "report/html_columns.hpp"
#include "report/page/escaped.hpp"
#include "report/page/table_page.hpp"
#include "report/report.hpp"
#include "report/stock_json.hpp"

namespace millpose {
namespace {

using Json = nlohmann::ordered_json;

/// An operation with its summary.json as a tree.
struct ToldOperation : DoneOperation {
  explicit ToldOperation(const DoneOperation& done) : DoneOperation(done), json(Json::parse(done.summary)) {}
  Json json;
};

std::vector<ToldOperation> Told(const std::vector<DoneOperation>& operations) {
  return {operations.begin(), operations.end()};
}

constexpr const char* kWholeStyle = R"html(body { min-height: 100vh; display: flex; flex-direction: column; }
ul { margin: 0 0 10px; padding-left: 18px; }
[role=tablist] { display: flex; flex-wrap: wrap; gap: 4px; }
[role=tab] { font: inherit; color: var(--ink); background: var(--card); border: 1px solid var(--line); border-bottom: 0; border-radius: 5px 5px 0 0; padding: 6px 12px; cursor: pointer; }
[role=tab][aria-selected=true] { color: var(--accent); font-weight: 600; box-shadow: inset 0 3px var(--accent); }
iframe { flex: 1; width: 100%; min-height: 720px; border: 1px solid var(--line); background: var(--card); }
@media print { iframe, [role=tablist] { display: none; } th, td { white-space: normal; padding: 3px 5px; font-size: 11px; } }
)html";

constexpr const char* kTail = R"html(<script>
"use strict";
const tabs = [...document.querySelectorAll("[role=tab]")], view = document.querySelector("iframe");
const show = tab => {
  for (const other of tabs) {
    other.setAttribute("aria-selected", String(other === tab));
    other.tabIndex = other === tab ? 0 : -1;
  }
  view.src = tab.dataset.report;
  view.title = tab.textContent;
};
tabs.forEach((tab, i) => {
  tab.addEventListener("click", () => show(tab));
  tab.addEventListener("keydown", event => {
    const step = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
    if (!step) return;
    const next = tabs[(i + step + tabs.length) % tabs.length];
    show(next);
    next.focus();
  });
});
show(tabs[0]);
</script>
</body>
</html>
)html";

size_t Sum(const std::vector<ToldOperation>& operations, const char* section, const char* key) {
  return std::accumulate(operations.begin(), operations.end(), size_t{0},
                         [&](size_t sum, const ToldOperation& done) {
                           return sum + done.json.at(section).at(key).get<size_t>();
                         });
}

/// Of the values that operations have at a place the one that `better` says; null where none has one.
template <class Better>
Json Pick(const std::vector<ToldOperation>& operations, const char* place, Better better) {
  Json picked = nullptr;
  const Json::json_pointer pointer(place);
  for (const ToldOperation& done : operations) {
    if (!done.json.contains(pointer) || !done.json.at(pointer).is_number()) continue;
    const double value = done.json.at(pointer).get<double>();
    if (picked.is_null() || better(value, picked.get<double>())) picked = value;
  }
  return picked;
}

Json SpreadOf(const std::vector<ToldOperation>& operations, const std::string& index) {
  const std::string place = "/stiffness/" + index;
  return {{"best", Pick(operations, (place + "/best").c_str(), std::less())},
          {"median", nullptr},
          {"worst", Pick(operations, (place + "/worst").c_str(), std::greater())}};
}

/// s; of all operations whose programs are there.
double CycleOf(const std::vector<ToldOperation>& operations, const std::string& controller) {
  double cycle = 0;
  for (const ToldOperation& done : operations)
    for (const Json& times : done.json.at("cycle_times"))
      if (times.at("controller") == controller) cycle += times.at("total_s").get<double>();
  return cycle;
}

std::vector<std::string> Findings(const std::vector<ToldOperation>& operations,
                                  const std::vector<WholeProgram>& programs) {
  std::vector<std::string> findings;
  for (const WholeProgram& program : programs) {
    if (!program.withheld.empty()) findings.push_back(program.withheld);
    for (const Finding& finding : program.findings)
      findings.push_back(
          fmt::format("{} {}:{}: {}", program.controller, finding.file, finding.line, finding.message));
  }
  for (const ToldOperation& done : operations)
    for (const Json& finding : done.json.at("findings"))
      findings.push_back(fmt::format("operation {}: {}", done.name, finding.get<std::string>()));
  return findings;
}

/// " 3 unreachable 2 interference": how many points an operation leaves out, and why.
std::string SkippedText(const ToldOperation& done) {
  std::map<std::string, size_t> by_reason;
  for (const Json& skipped : done.json.at("skipped")) ++by_reason[skipped.at("reason").get<std::string>()];
  std::string text;
  for (const auto& [reason, count] : by_reason) text += fmt::format(" {} {}", count, reason);
  return text;
}

/// The operations of a setup; all where its name is empty.
std::vector<ToldOperation> OfSetup(const std::vector<ToldOperation>& operations, const std::string& setup) {
  std::vector<ToldOperation> own;
  std::ranges::copy_if(operations, std::back_inserter(own),
                       [&](const ToldOperation& done) { return setup.empty() || done.setup == setup; });
  return own;
}

/// Controllers in their order, each once.
std::vector<std::string> ControllersOf(const std::vector<WholeProgram>& programs) {
  std::vector<std::string> controllers;
  for (const WholeProgram& program : programs)
    if (std::ranges::find(controllers, program.controller) == controllers.end())
      controllers.push_back(program.controller);
  return controllers;
}

bool IsWhole(const WholeProgram& program) { return program.withheld.empty() && program.findings.empty(); }

/// The widest gap for which the operations' programs are confirmed; null where they are confirmed as a whole.
Json ButForOf(const std::vector<ToldOperation>& operations, const std::string& controller) {
  Json widest = nullptr;
  for (const ToldOperation& done : operations)
    for (const Json& program : done.json.at("programs")) {
      if (program.at("controller") != controller || program.at("but_for").is_null()) continue;
      if (widest.is_null() || program.at("but_for").at("bound_mm") > widest.at("bound_mm"))
        widest = program.at("but_for");
    }
  return widest;
}

std::string MainOf(const WholeProgram& program) {
  const CallingSyntax syntax = MakePost(program.controller)->Calling();
  return fmt::format("programs/{}/{}{}", program.controller, ProgramName(syntax, program.name),
                     syntax.ending);
}

Json NameOrNull(const std::string& name) { return name.empty() ? Json() : Json(name); }

}  // namespace

std::string WholeSummary(const std::string& job, const std::vector<DoneOperation>& all,
                         const std::vector<WholeProgram>& programs) {
  const std::vector<ToldOperation> operations = Told(all);
  const Json& first = operations.front().json;
  const bool same_objective = std::ranges::all_of(operations, [&](const ToldOperation& done) {
    return done.json.at("objective") == first.at("objective");
  });
  Json json = {
      {"schema_version", kSummaryVersion},
      {"job", job},
      {"points",
       {{"total", Sum(operations, "points", "total")},
        {"planned", Sum(operations, "points", "planned")},
        {"skipped", Sum(operations, "points", "skipped")}}},
      {"gaps",
       {{"total", Sum(operations, "gaps", "total")}, {"planned", Sum(operations, "gaps", "planned")}}},
      {"objective", same_objective ? first.at("objective") : Json("several")}};
  Json& stiffness = json["stiffness"];
  for (const char* index : {"lambda_t1", "lambda_t2", "lambda_n"})
    stiffness[index] = SpreadOf(operations, index);
  stiffness["objective"] = same_objective ? SpreadOf(operations, "objective") : Json(nullptr);
  stiffness["units"] = first.at("stiffness").at("units");
  if (!same_objective) stiffness["units"]["objective"] = "";
  json["clearance_min_mm"] = Pick(operations, "/clearance_min_mm", std::less());
  json["programs"] = Json::array();
  json["cycle_times"] = Json::array();
  for (const WholeProgram& program : programs) {
    const bool written = IsWhole(program);
    const std::vector<ToldOperation> own = OfSetup(operations, program.setup);
    json["programs"].push_back({{"path", MainOf(program)},
                                {"controller", program.controller},
                                {"setup", NameOrNull(program.setup)},
                                {"verified", written},
                                {"withheld", written ? Json(nullptr) : Json(program.withheld)},
                                {"but_for", written ? ButForOf(own, program.controller) : Json(nullptr)}});
  }
  for (const std::string& controller : ControllersOf(programs))
    if (std::ranges::all_of(programs, [&](const WholeProgram& program) {
          return program.controller != controller || IsWhole(program);
        }))
      json["cycle_times"].push_back(
          {{"controller", controller}, {"total_s", CycleOf(operations, controller)}});
  json["findings"] = Findings(operations, programs);
  json["operations"] = Json::array();
  for (const ToldOperation& done : operations)
    json["operations"].push_back({{"name", done.name},
                                  {"folder", done.folder},
                                  {"tool", done.tool},
                                  {"setup", NameOrNull(done.setup)},
                                  {"summary", done.json}});
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string WholePoints(const std::vector<DoneOperation>& all) {
  const std::vector<ToldOperation> operations = Told(all);
  const auto longest = std::ranges::max_element(operations, {}, [](const ToldOperation& done) {
    return done.points.substr(0, done.points.find('\n')).size();
  });
  const std::string header = longest->points.substr(0, longest->points.find('\n'));
  const auto columns = [](std::string_view line) { return std::ranges::count(line, ','); };
  std::string text = header + ",operation\n";
  for (const ToldOperation& done : operations) {
    const std::vector<std::string_view> lines = SplitLines(done.points);
    // The columns of a compensated plan stand behind those that every plan has.
    const std::string missing(static_cast<size_t>(columns(header) - columns(lines.front())), ',');
    for (size_t i = 1; i < lines.size(); ++i)
      if (!lines[i].empty()) text += std::string(lines[i]) + missing + ',' + done.name + '\n';
  }
  return text;
}

std::string WholeReport(const std::string& job, const std::vector<DoneOperation>& all,
                        const std::vector<WholeProgram>& programs, Language language) {
  const std::vector<ToldOperation> operations = Told(all);
  const auto say = [&](const char* english) { return Escaped(Say(language, english)); };
  std::string html = TablePageHead(job + " — millpose", kWholeStyle, language) + "<h1>" + Escaped(job) +
                     "</h1>\n<div class=\"scroll\"><table>\n<thead><tr>";
  const bool setups = !all.front().setup.empty();
  for (const char* text : {"operation", "setup", "tool"})
    if (setups || text != std::string("setup")) html += "<th>" + say(text) + "</th>";
  for (const char* figure : {"points", "planned"}) html += "<th class=\"n\">" + say(figure) + "</th>";
  html += "<th>" + say("objective") + "</th>";
  for (const char* figure : {"worst", "least distance, mm"})
    html += "<th class=\"n\">" + say(figure) + "</th>";
  const std::vector<std::string> controllers = ControllersOf(programs);
  for (const std::string& controller : controllers)
    html += "<th class=\"n\">" + controller + ", h:min:s</th>";
  html += "</tr></thead>\n<tbody>\n";
  for (const ToldOperation& done : operations) {
    const Json& points = done.json.at("points");
    const Json& worst = done.json.at("stiffness").at("objective").at("worst");
    const Json& clearance = done.json.at("clearance_min_mm");
    const bool whole = points.at("planned") == points.at("total");
    const std::string unit = done.json.at("stiffness").at("units").at("objective").get<std::string>();
    html += fmt::format(
        "<tr><td><a href=\"{0}/report.html\">{1}</a></td>{9}<td>{2}</td><td class=\"n\">{3}</td><td "
        "class=\"n{4}\">{5}</td>"
        "<td>{6}</td><td class=\"n\">{7}</td><td class=\"n\">{8}</td>",
        Escaped(done.folder), Escaped(done.name), Escaped(done.tool), points.at("total").get<size_t>(),
        whole ? "" : " bad", points.at("planned").get<size_t>(),
        Escaped(done.json.at("objective").get<std::string>()),
        worst.is_number()
            ? fmt::format("{:.4g} {}", ShownScale(unit) * worst.get<double>(), Escaped(ShownUnit(unit)))
            : "&ndash;",
        clearance.is_number() ? fmt::format("{:.1f}", clearance.get<double>()) : "&ndash;",
        setups ? "<td>" + Escaped(done.setup) + "</td>" : "");
    for (const std::string& controller : controllers)
      html += done.programs.contains(controller)
                  ? fmt::format("<td class=\"n\">{}</td>", ClockText(CycleOf({done}, controller)))
                  : "<td class=\"n bad\">" + say("withheld") + "</td>";
    html += "</tr>\n";
  }
  html += "</tbody>\n</table></div>\n";
  if (const std::vector<std::string> findings = Findings(operations, programs); !findings.empty()) {
    html += "<ul>\n";
    for (const std::string& finding : findings)
      html += "<li class=\"bad\">" + say(finding.c_str()) + "</li>\n";
    html += "</ul>\n";
  }
  html += "<div role=\"tablist\" aria-label=\"" + say("operations") + "\">\n";
  for (const ToldOperation& done : operations)
    html += fmt::format("<button role=\"tab\" data-report=\"{}/report.html\">{}</button>\n",
                        Escaped(done.folder), Escaped(done.name));
  return html + "</div>\n<iframe title=\"" + say("operation") + "\"></iframe>\n" + kTail;
}

namespace {

constexpr size_t kMostTold = 12;  // lines
constexpr size_t kToldSkipped = 2, kToldPrograms = 3, kToldFindings = 3;

using ToldLines = std::vector<std::string>;

/// Done or not, of all operations together.
std::string StateLine(const std::string& job, const std::vector<ToldOperation>& operations, size_t findings) {
  const size_t planned = Sum(operations, "points", "planned"), total = Sum(operations, "points", "total"),
               ways = Sum(operations, "gaps", "total"), gone = Sum(operations, "gaps", "planned");
  const Json& first = operations.front().json;
  std::string text = fmt::format("{} on {}: {} of {} points in {} operation{}", job,
                                 first.at("cell").at("name").get<std::string>(), planned, total,
                                 operations.size(), operations.size() == 1 ? "" : "s");
  const bool whole = planned == total && ways == gone;
  if (ways > gone) text += fmt::format(", {} of {} ways between them not planned", ways - gone, ways);
  if (whole && findings > 0) text += fmt::format(", {} finding{}", findings, findings == 1 ? "" : "s");
  return fmt::format("{:<10} {}", !whole ? "INCOMPLETE" : findings > 0 ? "FINDINGS" : "done", text);
}

/// What the face of the operation whose is worst may be off by; empty where none cuts one.
std::string FaceLine(const std::vector<ToldOperation>& operations) {
  Budget worst;
  for (const ToldOperation& done : operations) {
    std::optional<Budget> budget = ReadBudget(done.json);
    if (!budget || done.json.at("points").at("planned") == 0) continue;
    if (worst.rows.empty() || budget->Sum() > worst.Sum()) worst = *std::move(budget);
  }
  return worst.rows.empty() ? "" : BudgetBrief(worst);
}

ToldLines ProgramLines(const std::vector<ToldOperation>& operations,
                       const std::vector<WholeProgram>& programs) {
  ToldLines lines;
  for (const WholeProgram& program : programs) {
    if (!IsWhole(program)) continue;
    const std::vector<ToldOperation> own = OfSetup(operations, program.setup);
    const Json bound = ButForOf(own, program.controller);
    lines.push_back(
        fmt::format("programs/{}{}: calls {} programs, read back and confirmed{}; {}", program.controller,
                    program.setup.empty() ? "" : ", setup " + program.setup, program.calls,
                    bound.is_null() ? ""
                                    : fmt::format(" but for the corner's path, bounded by {:.4f} mm",
                                                  bound.at("bound_mm").get<double>()),
                    ClockText(CycleOf(own, program.controller))));
  }
  return lines;
}

}  // namespace

std::string WholeBrief(const std::string& job, const std::vector<DoneOperation>& all,
                       const std::vector<WholeProgram>& programs, const std::filesystem::path& out) {
  const std::vector<ToldOperation> operations = Told(all);
  const ToldLines findings = Findings(operations, programs);
  ToldLines lines{StateLine(job, operations, findings.size())}, skipped, own;
  for (const ToldOperation& done : operations) {
    if (const std::string why = SkippedText(done); !why.empty()) skipped.push_back(done.name + ":" + why);
    own.push_back(fmt::format(
        "{}: {} of {} points with {}, {}", done.name, done.json.at("points").at("planned").get<size_t>(),
        done.json.at("points").at("total").get<size_t>(), done.tool, (out / done.folder).string()));
  }
  TellSome("skipped", skipped, kToldSkipped, lines);
  TellSome("program", ProgramLines(operations, programs), kToldPrograms, lines);
  if (const Json least = Pick(operations, "/clearance_min_mm", std::less()); least.is_number())
    lines.push_back(fmt::format("{:<10} at least {:.1f} mm", "clearance", least.get<double>()));
  if (const std::string face = FaceLine(operations); !face.empty())
    lines.push_back(fmt::format("{:<10} {}", "face", face));
  TellSome("finding", findings, kToldFindings, lines);
  TellSome("operation", own, kMostTold - 1 - lines.size(), lines);
  lines.push_back(fmt::format("{:<10} {}", "report", (out / "report.html").string()));
  return fmt::format("{}\n", fmt::join(lines, "\n"));
}

std::string WholeText(const std::vector<DoneOperation>& all, const std::vector<WholeProgram>& programs,
                      const std::filesystem::path& out) {
  const std::vector<ToldOperation> operations = Told(all);
  std::string text;
  std::string setup;
  for (const ToldOperation& done : operations) {
    const Json& points = done.json.at("points");
    if (done.setup != setup) text += fmt::format("setup      {}\n", setup = done.setup);
    text += fmt::format("operation  {}: {} of {} points with {}, {}\n", done.name,
                        points.at("planned").get<size_t>(), points.at("total").get<size_t>(), done.tool,
                        (out / done.folder).string());
    if (const std::string skipped = SkippedText(done); !skipped.empty())
      text += fmt::format("skipped    {}:{}\n", done.name, skipped);
    if (done.json.contains("stock"))
      text += fmt::format("air        {}: {}\n", done.name, AirText(AirTimeOf(done.json.at("stock"))));
  }
  for (const std::string& line : ProgramLines(operations, programs)) text += "program    " + line + "\n";
  for (const std::string& finding : Findings(operations, programs)) text += "finding    " + finding + "\n";
  return text;
}

}  // namespace millpose
