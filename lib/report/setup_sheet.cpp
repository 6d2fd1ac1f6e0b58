// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/setup_sheet.hpp"

#include <fmt/format.h>

#include "report/page/escaped.hpp"
#include "report/page/table_page.hpp"

namespace millpose {
namespace {

constexpr const char* kSheetStyle = R"html(body { max-width: 190mm; margin: 0 auto; }
td { white-space: normal; overflow-wrap: anywhere; }
td:first-child { white-space: nowrap; }
h1 { margin-bottom: 0; }
h2 { margin: 14px 0 6px; }
p { margin: 0 0 8px; }
p.of { color: var(--muted); }
ul, ol { margin: 0 0 10px; padding-left: 20px; }
ol.steps { list-style: none; padding-left: 0; }
ol.steps li::before { content: "\2610\00a0\00a0"; }
svg { display: block; width: 100%; height: auto; background: var(--card); border: 1px solid var(--line); border-radius: 5px; }
pre { white-space: pre-wrap; overflow-wrap: anywhere; font: 10px/1.3 ui-monospace, "DejaVu Sans Mono", monospace; }
tr, li, svg { break-inside: avoid; }
h2 { break-after: avoid; }
@page { size: A4; margin: 14mm 12mm 16mm; @bottom-right { content: counter(page) " / " counter(pages); font: 9px sans-serif; } }
@media print { body { padding: 0; font-size: 11px; max-width: none; } .page { break-before: page; } .scroll { overflow: visible; border: 0; } th, td { padding: 3px 5px; } }
)html";

std::string TableHtml(const SheetTable& table) {
  std::string html = "<div class=\"scroll\"><table>\n<thead><tr>";
  for (const std::string& column : table.columns) html += "<th>" + Escaped(column) + "</th>";
  html += "</tr></thead>\n<tbody>\n";
  for (const std::vector<std::string>& row : table.rows) {
    html += "<tr>";
    for (const std::string& cell : row) html += "<td>" + Escaped(cell) + "</td>";
    html += "</tr>\n";
  }
  return html + "</tbody>\n</table></div>\n";
}

std::string ListHtml(const std::vector<std::string>& entries, const char* open, const char* close) {
  std::string html = open;
  for (const std::string& entry : entries) html += "<li>" + Escaped(entry) + "</li>\n";
  return html + close;
}

}  // namespace

std::string SetupSheetHtml(const SetupSheet& sheet) {
  std::string html = TablePageHead(sheet.title, kSheetStyle) + "<h1>" + Escaped(sheet.title) +
                     "</h1>\n<p class=\"of\">" + Escaped(sheet.subtitle) + "</p>\n";
  for (const SheetSection& section : sheet.sections) {
    html += section.new_page ? "<section class=\"page\">" : "<section>";
    html += "<h2>" + Escaped(section.title) + "</h2>\n" + section.picture;
    if (!section.note.empty()) html += "<p>" + Escaped(section.note) + "</p>\n";
    if (!section.table.rows.empty()) html += TableHtml(section.table);
    if (!section.list.empty()) html += ListHtml(section.list, "<ul>\n", "</ul>\n");
    if (!section.steps.empty()) html += ListHtml(section.steps, "<ol class=\"steps\">\n", "</ol>\n");
    html += "</section>\n";
  }
  for (const auto& [name, text] : sheet.appendix)
    html += "<section class=\"page\"><h2>" + Escaped(name) + "</h2>\n<pre>" + Escaped(text) +
            "</pre></section>\n";
  return html + "</body>\n</html>\n";
}

}  // namespace millpose
