// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/setup_sheet.hpp"

#include <fmt/format.h>

#include "report/page/escaped.hpp"
#include "report/page/table_page.hpp"

namespace millpose {
namespace {

constexpr const char* kSheetStyle = R"html(body { max-width: 190mm; margin: 0 auto; }
th, td { white-space: normal; hyphens: auto; }
td:last-child { overflow-wrap: anywhere; }
td:first-child { white-space: nowrap; }
h1 { margin-bottom: 0; }
h2 { margin: 14px 0 6px; }
p { margin: 0 0 8px; }
p.of { color: var(--muted); }
ul, ol { margin: 0 0 10px; padding-left: 20px; }
ol.steps { list-style: none; padding-left: 0; }
ol.steps li::before { content: "\2610\00a0\00a0"; }
svg { display: block; width: 100%; height: auto; background: var(--card); border: 1px solid; border-color: var(--line); border-radius: 5px; }
pre { white-space: pre-wrap; overflow-wrap: anywhere; font: 10px/1.3 ui-monospace, "DejaVu Sans Mono", monospace; }
tr, li, svg { break-inside: avoid; }
h2 { break-after: avoid; }
@page { size: A4; margin: 14mm 12mm 16mm; @bottom-right { content: counter(page) " / " counter(pages); font: 9px sans-serif; } }
@media print { body { padding: 0; font-size: 11px; max-width: none; } .page { break-before: page; } .scroll { overflow: visible; border: 0; } th, td { padding: 3px 5px; } }
)html";

class SheetWriter {
 public:
  explicit SheetWriter(Language language) : language_(language) {}

  std::string Text(const std::string& english) const { return Escaped(Say(language_, english)); }

  std::string Table(const SheetTable& table) const {
    std::string html = "<div class=\"scroll\"><table>\n<thead><tr>";
    for (const std::string& column : table.columns) html += "<th>" + Text(column) + "</th>";
    html += "</tr></thead>\n<tbody>\n";
    for (const std::vector<std::string>& row : table.rows) {
      html += "<tr>";
      for (size_t i = 0; i < row.size(); ++i)
        html += "<td>" + (i < table.names ? Escaped(row[i]) : Text(row[i])) + "</td>";
      html += "</tr>\n";
    }
    return html + "</tbody>\n</table></div>\n";
  }

  std::string List(const std::vector<std::string>& entries, const char* open, const char* close) const {
    std::string html = open;
    for (const std::string& entry : entries) html += "<li>" + Text(entry) + "</li>\n";
    return html + close;
  }

  std::string Section(const SheetSection& section) const {
    std::string html = section.new_page ? "<section class=\"page\">" : "<section>";
    html += "<h2>" + Text(section.title) + "</h2>\n" + section.picture;
    if (!section.note.empty()) html += "<p>" + Text(section.note) + "</p>\n";
    if (!section.table.rows.empty()) html += Table(section.table);
    if (!section.list.empty()) html += List(section.list, "<ul>\n", "</ul>\n");
    if (!section.steps.empty()) html += List(section.steps, "<ol class=\"steps\">\n", "</ol>\n");
    return html + "</section>\n";
  }

 private:
  Language language_;
};

}  // namespace

std::string SetupSheetHtml(const SetupSheet& sheet, Language language) {
  const SheetWriter writer(language);
  std::string html = TablePageHead(Say(language, sheet.title), kSheetStyle, language) + "<h1>" +
                     writer.Text(sheet.title) + "</h1>\n<p class=\"of\">" + writer.Text(sheet.subtitle) +
                     "</p>\n";
  for (const SheetSection& section : sheet.sections) html += writer.Section(section);
  for (const auto& [name, text] : sheet.appendix)
    html += "<section class=\"page\"><h2>" + Escaped(name) + "</h2>\n<pre>" + Escaped(text) +
            "</pre></section>\n";
  return html + "</body>\n</html>\n";
}

}  // namespace millpose
