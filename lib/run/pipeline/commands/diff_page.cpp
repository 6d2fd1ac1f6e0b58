// SPDX-License-Identifier: GPL-3.0-or-later
#include "run/pipeline/commands/diff_page.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "report/page/escaped.hpp"
#include "report/page/table_page.hpp"

namespace millpose {
namespace {

namespace fs = std::filesystem;

constexpr const char* kDiffStyle = R"html(td { white-space: normal; overflow-wrap: anywhere; }
td.of { white-space: nowrap; color: var(--muted); }
th.n, td.n { white-space: nowrap; }
p { margin: 0 0 10px; color: var(--muted); }
tr.bad td { font-weight: 600; }
section { break-inside: avoid; }
table { table-layout: fixed; min-width: 580px; }
th:first-child { width: 40%; }
@media (max-width: 640px) {
  table { min-width: 0; font-size: 12px; }
  th, td { padding-left: 5px; padding-right: 5px; }
  th.n, td.n { white-space: normal; }
}
)html";

/// The folder's name, a link to its report where it has one.
std::string LinkTo(const fs::path& folder, const fs::path& page) {
  const fs::path report = folder / "report.html";
  std::string name = Escaped(folder.string());
  std::error_code none;
  if (!fs::exists(report, none)) return name;
  const fs::path beside = fs::absolute(page, none).parent_path();
  return fmt::format("<a href=\"{}\">{}</a>",
                     Escaped(fs::absolute(report, none).lexically_proximate(beside).generic_string()), name);
}

std::string Row(const Change& change, bool fails, bool operations, Language language) {
  std::string row = fails ? "<tr class=\"bad\">" : "<tr>";
  if (operations) row += "<td class=\"of\">" + Escaped(change.operation) + "</td>";
  const bool sentence = change.before.empty() && change.after.empty();
  row += fmt::format("<td{}>{}</td>", sentence ? " colspan=\"4\"" : "", Escaped(Say(language, change.what)));
  if (!sentence)
    row += fmt::format("<td>{}</td><td>{}</td><td class=\"n\">{}</td>", Escaped(change.before),
                       Escaped(change.after), change.by ? fmt::format("{:+.3g} %", 100 * *change.by) : "");
  return row + "</tr>\n";
}

}  // namespace

std::string DiffPage(const DiffArguments& arguments, const std::vector<Change>& changes,
                     const std::vector<bool>& fails, const fs::path& page, Language language) {
  const auto say = [&](const std::string& english) { return Escaped(Say(language, english)); };
  std::string html = TablePageHead("millpose diff", kDiffStyle, language);
  html +=
      fmt::format("<h1>{} &rarr; {}</h1>\n", LinkTo(arguments.before, page), LinkTo(arguments.after, page));
  const auto broken = std::ranges::count(fails, true);
  if (changes.empty())
    html += "<p>" + say("No difference.") + "</p>\n";
  else
    html += "<p>" +
            say(fmt::format("{} difference{}{}.", changes.size(), changes.size() == 1 ? "" : "s",
                            broken > 0 ? fmt::format(", {} of them against a rule", broken) : "")) +
            "</p>\n";
  const bool operations =
      std::ranges::any_of(changes, [](const Change& change) { return !change.operation.empty(); });
  for (const std::string& section : kDiffSections) {
    std::string rows;
    for (size_t i = 0; i < changes.size(); ++i)
      if (changes[i].section == section) rows += Row(changes[i], fails[i], operations, language);
    if (rows.empty()) continue;
    html += fmt::format(
        "<section><h2>{}</h2><div "
        "class=\"scroll\"><table>\n<thead><tr>{}<th></th><th>{}</th><th>{}</th>"
        "<th class=\"n\">{}</th></tr></thead>\n<tbody>\n{}</tbody>\n</table></div></section>\n",
        say(section), operations ? "<th>" + say("operation") + "</th>" : "", say("before"), say("after"),
        say("change"), rows);
  }
  return html + "</body>\n</html>\n";
}

}  // namespace millpose
