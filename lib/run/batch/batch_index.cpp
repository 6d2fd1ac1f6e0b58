// SPDX-License-Identifier: GPL-3.0-or-later
// The jobs of a batch as a table, for people (index.html) and for spreadsheets (batch.csv). Neither holds
// what may vary between runs: the same inputs give the same bytes.
#include <algorithm>
#include <array>

#include "base/text.hpp"
#include "report/html_columns.hpp"
#include "report/page/escaped.hpp"
#include "report/page/table_page.hpp"
#include "run/batch/batch.hpp"

namespace millpose {
namespace {

constexpr const char* kStyle = R"html(h1 { margin: 0 0 4px; }
p { margin: 0 0 10px; color: var(--muted); }
td { padding: 5px 6px; }
th { padding: 0; vertical-align: bottom; }
th button { font: inherit; font-weight: 600; color: inherit; background: none; border: 0; padding: 6px; width: 100%; text-align: inherit; vertical-align: bottom; white-space: normal; cursor: pointer; }
th[aria-sort=ascending] button::after { content: " \25B2"; }
th[aria-sort=descending] button::after { content: " \25BC"; }
tbody { break-inside: avoid; }
tbody:has(.told) tr:first-child td { border-bottom: 0; }
td.told { white-space: normal; color: var(--muted); padding: 0 6px 8px 24px; }
td.told p { white-space: pre-wrap; overflow-wrap: anywhere; margin: 0; max-width: 110ch; }
td.told p.bad { font-weight: 400; }
summary { cursor: pointer; }
.changes { display: grid; grid-template-columns: max-content 1fr; gap: 1px 14px; padding: 4px 0 4px 18px; max-width: 110ch; overflow-wrap: anywhere; }
/* A job is a block of lines, head and figure, where its row would not fit: small windows, and paper. */
@media (max-width: 900px) {
  thead { display: none; }
  table, tbody, td { display: block; }
  tbody { border-bottom: 1px solid var(--line); padding: 4px 0; }
  tbody:last-child { border-bottom: 0; }
  tr { display: grid; grid-template-columns: repeat(auto-fill, minmax(220px, 1fr)); gap: 0 28px; padding: 0 10px; }
  td { display: flex; justify-content: space-between; gap: 12px; padding: 1px 0; border: 0; white-space: normal; }
  td::before { content: attr(data-head); color: var(--muted); font-weight: 400; }
  td:first-child { display: block; grid-column: 1 / -1; font-weight: 600; overflow-wrap: anywhere; }
  td[data-v=""], td:empty { display: none; }
  td.told { display: block; padding: 0 0 4px; font-weight: 400; }
}
)html";

constexpr const char* kTail = R"html(</table>
</div>
<script>
"use strict";
const head = [...document.querySelectorAll("th")], table = document.querySelector("table");
const value = (body, column) => {
  const cell = body.rows[0].cells[column];
  return "v" in cell.dataset ? (cell.dataset.v === "" ? null : Number(cell.dataset.v)) : cell.textContent;
};
const order = (a, b) => typeof a === "number" ? a - b : a < b ? -1 : a > b ? 1 : 0;
head.forEach((cell, column) => cell.firstElementChild.addEventListener("click", () => {
  const down = cell.getAttribute("aria-sort") === "ascending";
  head.forEach(other => other.removeAttribute("aria-sort"));
  cell.setAttribute("aria-sort", down ? "descending" : "ascending");
  // Jobs without a value stay last either way; what is told of a job goes with it.
  const bodies = [...table.tBodies].sort((one, other) => {
    const a = value(one, column), b = value(other, column);
    if (a === null || b === null) return (a === null) - (b === null);
    return down ? order(b, a) : order(a, b);
  });
  table.append(...bodies);
}));
</script>
</body>
</html>
)html";

// A file name as part of a relative address; bytes, as browsers ask the file system for them.
std::string EscapeUrl(const std::string& name) {
  std::string result;
  for (const char c : name) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                       c == '_' || c == '-' || c == '.';
    result += plain ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
  }
  return result;
}

std::string Quoted(const std::string& text) {
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + '"';
}

/// A column of figures in both tables.
struct Column {
  const char* csv;
  const char* title;
  const char* help;
  double scale;  ///< from the unit of the CSV to that of the page; of the job's own objective by its unit
  int digits;    ///< after the point; -1: four in all, the job's own objective
  std::optional<double> (*value)(const JobOutcome& outcome);
};

template <auto member>
std::optional<double> Figure(const JobOutcome& outcome) {
  if (!outcome.figures) return std::nullopt;
  return (*outcome.figures).*member;
}

const std::vector<Column>& Columns() {
  using F = JobFigures;
  static const std::vector<Column> columns{
      {"points", "points", "Points of the tool path", 1, 0,
       [](const JobOutcome& o) {
         return o.points ? std::optional(static_cast<double>(*o.points)) : std::nullopt;
       }},
      {"planned", "planned", "Points with a pose", 1, 0,
       [](const JobOutcome& o) {
         return o.planned ? std::optional(static_cast<double>(*o.planned)) : std::nullopt;
       }},
      {"cycle_s", "cycle, min", "Longest computed time of the programs", 1 / 60.0, 1, Figure<&F::cycle_s>},
      {"objective_median", "objective, median", "Of the job's own objective", 1, -1,
       Figure<&F::objective_median>},
      {"objective_worst", "objective, worst", "Of the job's own objective", 1, -1,
       Figure<&F::objective_worst>},
      {"lambda_t1_worst_mm_N", "λt1 worst, µm/N", "Largest compliance in the milling plane", 1e3, 3,
       Figure<&F::lambda_t1_worst>},
      {"lambda_t2_worst_mm_N", "λt2 worst, µm/N", "Compliance across it in the milling plane", 1e3, 3,
       Figure<&F::lambda_t2_worst>},
      {"lambda_n_worst_mm_N", "λn worst, µm/N", "Compliance along the surface normal", 1e3, 3,
       Figure<&F::lambda_n_worst>},
      {"clearance_min_mm", "least distance, mm", "Of all bodies that must not touch", 1, 2,
       Figure<&F::clearance_min>},
      {"deflection_level_mm", "deflection, µm", "Mean over the face along the normal", 1e3, 1,
       Figure<&F::deflection_level>},
      {"deflection_variation_mm", "its variation, µm", "About the deflections' own plane", 1e3, 1,
       Figure<&F::deflection_variation>},
  };
  return columns;
}

// What up to date is, was done: by which run is no matter here.
const char* OutcomeWord(const JobOutcome& outcome) {
  constexpr std::array<const char*, 3> words = {"done", "findings", "bad input"};
  return outcome.status >= 0 && outcome.status < 3 ? words[static_cast<size_t>(outcome.status)] : "failed";
}

/// Lines of causes and remarks, each as far as the tables have it.
std::string SayLines(Language language, const std::string& lines) {
  std::string said;
  for (size_t at = 0; at < lines.size();) {
    const size_t end = std::min(lines.find('\n', at), lines.size());
    said += (said.empty() ? "" : "\n") + Say(language, lines.substr(at, end - at));
    at = end + 1;
  }
  return said;
}

std::string CellHtml(const Column& column, const JobOutcome& outcome, Language language) {
  const std::string head = Escaped(Say(language, column.title));
  const std::optional<double> value = column.value(outcome);
  if (!value) return fmt::format("<td class=\"n\" data-head=\"{}\" data-v=\"\">–</td>", head);
  const double scale = column.digits < 0 ? ShownScale(outcome.figures->objective_unit) : column.scale;
  const double shown = *value * scale;
  return fmt::format(
      "<td class=\"n\" data-head=\"{}\" data-v=\"{}\">{}</td>", head, ShortestNumber(*value),
      column.digits < 0 ? fmt::format("{:.4g}", shown) : fmt::format("{:.{}f}", shown, column.digits));
}

/// "baseline: settings   process.feed_mm_min: 600 -> 60" as its section and the rest; empty for any other
/// remark.
std::optional<std::pair<std::string, std::string>> ChangeOf(const std::string& remark) {
  constexpr std::string_view kBefore = "baseline: ";
  if (!remark.starts_with(kBefore)) return std::nullopt;
  const std::string text = remark.substr(kBefore.size());
  const size_t gap = text.find(' ');
  if (gap == std::string::npos || text.compare(gap, 2, "  ") != 0) return std::nullopt;
  return std::pair(text.substr(0, gap), text.substr(text.find_first_not_of(' ', gap)));
}

/// "krl: motions: 65 -> 60": figures stay as they stand.
std::string SayChange(Language language, const std::string& text) {
  const size_t arrow = text.find(" -> ");
  const size_t colon = arrow == std::string::npos ? arrow : text.rfind(": ", arrow);
  return colon == std::string::npos ? Say(language, text)
                                    : Say(language, text.substr(0, colon)) + text.substr(colon);
}

/// What is told of a job below its figures: causes, remarks, and folded what differs from the baseline.
std::string ToldHtml(const JobOutcome& outcome, size_t columns, Language language) {
  std::string told, changes;
  size_t count = 0;
  if (!outcome.cause.empty())
    told += "<p class=\"bad\">" + Escaped(SayLines(language, outcome.cause)) + "</p>";
  for (const std::string& remark : outcome.remarks) {
    if (const auto change = ChangeOf(remark)) {
      ++count;
      changes += fmt::format("<span>{}</span><span>{}</span>\n", Escaped(Say(language, change->first)),
                             Escaped(SayChange(language, change->second)));
    } else {
      told += "<p>" + Escaped(SayLines(language, remark)) + "</p>";
    }
  }
  if (count > 0)
    told += fmt::format(
        "<details><summary>{}</summary><div class=\"changes\">\n{}</div></details>",
        Escaped(Say(language, fmt::format("baseline: {} difference{}.", count, count == 1 ? "" : "s"))),
        changes);
  return told.empty() ? ""
                      : fmt::format("<tr><td class=\"told\" colspan=\"{}\">{}</td></tr>\n", columns, told);
}

}  // namespace

std::string BatchCsv(const std::vector<BatchJob>& jobs, const std::vector<JobOutcome>& outcomes) {
  std::string csv = "name,outcome,status,objective,objective_unit";
  for (const Column& column : Columns()) csv += fmt::format(",{}", column.csv);
  csv += ",cause\n";
  for (size_t i = 0; i < jobs.size(); ++i) {
    const JobOutcome& outcome = outcomes[i];
    const JobFigures figures = outcome.figures.value_or(JobFigures{});
    csv += fmt::format("{},{},{},{},{}", Quoted(ValidUtf8(jobs[i].name)), OutcomeWord(outcome),
                       outcome.status, Quoted(figures.objective), Quoted(figures.objective_unit));
    for (const Column& column : Columns()) {
      const std::optional<double> value = column.value(outcome);
      csv += value ? ',' + ShortestNumber(*value) : ",";
    }
    csv += ',' + Quoted(ValidUtf8(outcome.cause)) + '\n';
  }
  return csv;
}

std::string BatchIndex(const std::vector<BatchJob>& jobs, const std::vector<JobOutcome>& outcomes,
                       Language language) {
  const auto say = [&](const std::string& english) { return Escaped(Say(language, english)); };
  const auto count = [&](int lower, int upper) {
    return std::ranges::count_if(outcomes,
                                 [&](const JobOutcome& o) { return o.status >= lower && o.status <= upper; });
  };
  std::string html = TablePageHead("millpose batch", kStyle, language) + "<h1>millpose batch</h1>\n";
  html += fmt::format(
      "<p>{} {}: <a href=\"batch.csv\">batch.csv</a>, {} <a href=\"batch.json\">batch.json</a>.</p>\n",
      say(fmt::format("{} jobs: {} done, {} with findings, {} failed. A column's head sorts by it.",
                      jobs.size(), count(0, 0), count(1, 1), count(2, 255))),
      say("The same figures"), say("with the run's times"));
  html += "<div class=\"scroll\">\n<table>\n<thead><tr>";
  const auto head = [&](const char* kind, const char* title, const char* help) {
    html +=
        fmt::format("<th scope=\"col\" class=\"{}\"><button type=\"button\" title=\"{}\">{}</button></th>",
                    kind, say(help), say(title));
  };
  head("t", "job", "Name; leads to its report");
  head("t", "outcome", "done, findings, bad input, failed");
  head("t", "objective", "What the job's poses are best for, with its unit");
  for (const Column& column : Columns()) head("n", column.title, column.help);
  html += "</tr></thead>\n";
  for (size_t i = 0; i < jobs.size(); ++i) {
    const JobOutcome& outcome = outcomes[i];
    const std::string name = Escaped(jobs[i].name);
    std::string objective;
    if (outcome.figures) {
      objective = outcome.figures->objective;
      if (!outcome.figures->objective_unit.empty())
        objective += ", " + ShownUnit(outcome.figures->objective_unit);
    }
    html += "<tbody><tr><td>";
    html += outcome.figures && outcome.figures->report
                ? fmt::format("<a href=\"{}/report.html\">{}</a>", EscapeUrl(jobs[i].name), name)
                : name;
    html += fmt::format("</td><td{} data-head=\"{}\">{}</td><td data-head=\"{}\">{}</td>",
                        outcome.status > 0 ? " class=\"bad\"" : "", say("outcome"), say(OutcomeWord(outcome)),
                        say("objective"), Escaped(objective));
    for (const Column& column : Columns()) html += CellHtml(column, outcome, language);
    html += "</tr>\n" + ToldHtml(outcome, 3 + Columns().size(), language) + "</tbody>\n";
  }
  return html + kTail;
}

}  // namespace millpose
