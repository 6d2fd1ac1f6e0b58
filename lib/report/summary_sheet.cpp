// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/summary_sheet.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "report/page/escaped.hpp"
#include "report/page/table_page.hpp"
#include "report/words/word_table.hpp"

namespace millpose {
namespace {

constexpr size_t kLineColumns = 100;   // of a sentence across the page; a sign of Chinese takes two
constexpr size_t kSentenceLines = 4;   // of one sentence at most
constexpr double kCourseHeight = 180;  // px, where all lists of page 1 are full
constexpr double kRowHeight = 21;      // px, of a row or a line that page 1 does not need
constexpr double kMostCourse = 300;    // px
constexpr const char* kSourceColour = "#2d7bd3";

constexpr const char* kSummaryStyle = R"html(body { padding: 0; }
.page { position: relative; width: 210mm; height: 296mm; margin: 8px auto; padding: 11mm 12mm 15mm; background: var(--card); overflow: hidden; font-size: 11px; line-height: 1.4; }
.page > footer { position: absolute; left: 12mm; right: 12mm; bottom: 7mm; border-top: 1px solid; border-color: var(--line); padding-top: 3px; color: var(--muted); font-size: 9px; }
footer b { float: right; color: var(--ink); }
h1 { margin: 0; }
h2 { margin: 9px 0 3px; font-size: 12px; }
p { margin: 0 0 3px; }
p.of, small { color: var(--muted); }
th, td { padding: 2px 5px; }
.operations th { white-space: normal; }
.verdict { border: 1.5px solid #009e73; border-left-width: 6px; border-radius: 4px; padding: 5px 9px; margin: 6px 0; }
.verdict.open { border-color: #b3261e; }
.verdict b { font-size: 15px; }
.verdict p, li { overflow-wrap: anywhere; }
ul { margin: 0; padding-left: 16px; }
.tiles td { border: 1px solid; border-color: var(--line); width: 25%; white-space: normal; }
.tiles b { display: block; font-size: 15px; }
.bars td { border: 0; padding: 1px 5px; }
.bars td:nth-child(2) { width: 70%; }
.bars i, figcaption i { display: inline-block; height: 10px; vertical-align: -1px; print-color-adjust: exact; -webkit-print-color-adjust: exact; }
figcaption i { width: 14px; height: 4px; margin: 0 3px 2px 12px; vertical-align: middle; }
figure { margin: 7px 0 0; }
svg { display: block; width: 100%; height: auto; }
code { font: 9.5px ui-monospace, "DejaVu Sans Mono", monospace; }
.sign td { height: 9.5mm; }
.sign td, .sign th { border: 1px solid; border-color: var(--line); }
.bottom { position: absolute; left: 12mm; right: 12mm; bottom: 14mm; }
@page { size: A4; margin: 0; @bottom-right { content: none; } }
@media screen and (max-width: 820px) { .page { width: auto; height: auto; margin: 0 0 8px; padding: 12px; } .page > footer, .bottom { position: static; margin-top: 12px; } .wide { overflow-x: auto; } }
@media print { body { background: none; } .page { margin: 0; } .page + .page { break-before: page; } }
)html";

bool BeginsSign(char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; }

/// As much of `text` as fits into so many columns, with … where some is left out.
std::string Cut(const std::string& text, size_t columns) {
  if (ColumnsOf(text) <= columns) return text;
  size_t taken = 0;
  for (size_t at = 0; at < text.size();) {
    size_t end = at + 1;
    while (end < text.size() && !BeginsSign(text[end])) ++end;
    const size_t wide = ColumnsOf(std::string_view(text).substr(at, end - at));
    if (taken + wide + 1 > columns) return text.substr(0, at) + "…";
    taken += wide;
    at = end;
  }
  return text;
}

/// The same from the other end: of a path the name of the file is what tells it.
std::string CutFront(const std::string& text, size_t columns) {
  if (ColumnsOf(text) <= columns) return text;
  size_t begin = text.size(), taken = 0;
  while (begin > 0) {
    size_t at = begin - 1;
    while (at > 0 && !BeginsSign(text[at])) --at;
    const size_t wide = ColumnsOf(std::string_view(text).substr(at, begin - at));
    if (taken + wide + 1 > columns) break;
    taken += wide;
    begin = at;
  }
  return "…" + text.substr(begin);
}

size_t LinesIn(const std::string& text) { return (ColumnsOf(text) + kLineColumns - 1) / kLineColumns; }

class SummaryWriter {
 public:
  SummaryWriter(const SummarySheet& sheet, Language language) : sheet_(sheet), language_(language) {}

  std::string Html() const {
    const std::string title = Said(sheet_.job + ": summary");
    return TablePageHead(title, kSummaryStyle, language_) + "<section class=\"page\">\n<h1>" +
           Escaped(Cut(title, 70)) + "</h1>\n<p class=\"of\">" + Escaped(Cut(Said(sheet_.subtitle), 180)) +
           "</p>\n" + FirstPage() + Foot(1) + "</section>\n<section class=\"page\">\n" + SecondPage() +
           Foot(2) + "</section>\n</body>\n</html>\n";
  }

 private:
  std::string Said(const std::string& english) const { return Say(language_, english); }
  /// A sentence; behind the operations that it is of, it is looked up by itself.
  std::string SaidOf(const std::string& english) const {
    const size_t colon = english.starts_with("operation") ? english.find(": ") : std::string::npos;
    if (colon == std::string::npos) return Said(english);
    return Said(english.substr(0, colon)) + (language_ == Language::kChinese ? "：" : ": ") +
           Said(english.substr(colon + 2));
  }
  std::string Text(const std::string& english) const { return Escaped(Said(english)); }
  std::string Head(const std::string& english) const { return "<h2>" + Text(english) + "</h2>\n"; }

  std::string Foot(int page) const {
    return fmt::format("<footer><b>{} / 2</b>{}</footer>\n", page, Escaped(Cut(sheet_.job, 90)));
  }

  /// Sentences in the language, each cut to a few lines, as many as `room` lines hold; then how many follow.
  std::vector<std::string> Fitted(const std::vector<std::string>& sentences, size_t room) const {
    std::vector<std::string> fitted;
    size_t used = 0;
    for (size_t i = 0; i < sentences.size(); ++i) {
      const std::string said = Cut(SaidOf(sentences[i]), kSentenceLines * kLineColumns);
      const size_t lines = LinesIn(said), kept = i + 1 < sentences.size() ? 1 : 0;
      if (used + lines + kept > room) {
        fitted.push_back(Said(fmt::format("{} more: report.html", sentences.size() - i)));
        break;
      }
      used += lines;
      fitted.push_back(said);
    }
    return fitted;
  }
  static size_t LinesOfAll(const std::vector<std::string>& said) {
    size_t lines = 0;
    for (const std::string& one : said) lines += LinesIn(one);
    return lines;
  }

  std::string FirstPage() const {
    const std::vector<std::string> why = Fitted(sheet_.why, SummaryRoom::kWhyLines);
    std::string html = fmt::format("<div class=\"verdict{}\"><b>{}</b>\n",
                                   sheet_.verdict == "done" ? "" : " open", Text(sheet_.verdict));
    for (const std::string& sentence : why) html += "<p>" + Escaped(sentence) + "</p>\n";
    html += "</div>\n<table class=\"tiles\"><tr>";
    for (const auto& [what, figure] : sheet_.tiles)
      html += "<td><small>" + Text(what) + "</small><b>" + Escaped(Cut(figure, 24)) + "</b></td>";
    html += "</tr></table>\n";
    const size_t rows = std::min(sheet_.operations.rows.size(), SummaryRoom::kOperations);
    const size_t spare = SummaryRoom::kOperations - rows + SummaryRoom::kWhyLines -
                         std::min(LinesOfAll(why), SummaryRoom::kWhyLines);
    html += Operations() + Sources();
    const double height = std::min(
        kMostCourse, kCourseHeight + kRowHeight * static_cast<double>(spare) /
                                         static_cast<double>(std::max<size_t>(1, sheet_.courses.size())));
    for (const PathCurves& course : sheet_.courses) html += Course(course, height);
    return html;
  }

  std::string Operations() const {
    const SheetTable& table = sheet_.operations;
    const bool all = table.rows.size() <= SummaryRoom::kOperations;
    const size_t shown = all ? table.rows.size() : SummaryRoom::kOperations - 1;
    std::string html = "<div class=\"wide\"><table class=\"operations\">\n<thead><tr>";
    for (size_t i = 0; i < table.columns.size(); ++i)
      html += (i < table.names ? "<th>" : "<th class=\"n\">") + Text(table.columns[i]) + "</th>";
    html += "</tr></thead>\n<tbody>\n";
    for (size_t row = 0; row < shown; ++row) {
      html += "<tr>";
      for (size_t i = 0; i < table.rows[row].size(); ++i)
        html += (i < table.names ? "<td>" : "<td class=\"n\">") +
                Escaped(Cut(table.rows[row][i], i < table.names ? 17 : 20)) + "</td>";
      html += "</tr>\n";
    }
    html += "</tbody>\n</table></div>\n";
    return all ? html : html + "<p>" + More(table.rows.size() - shown) + "</p>\n";
  }

  std::string More(size_t count) const { return Text(fmt::format("{} more: report.html", count)); }

  std::string Sources() const {
    std::string html = Head("What the face may be off by");
    double sum = 0;
    std::vector<const SummarySource*> stated;
    std::vector<std::string> missing;
    for (const SummarySource& source : sheet_.sources) {
      if (!source.um) {
        missing.push_back(source.name);
        continue;
      }
      stated.push_back(&source);
      sum += *source.um;
    }
    if (sheet_.sources.empty()) return html + "<p>" + Text("No face is cut.") + "</p>\n";
    if (stated.empty())
      return html + "<p>" + Text("of its error nothing is stated (docs/budget.md)") + "</p>\n";
    std::ranges::stable_sort(stated, std::greater(), [](const SummarySource* one) { return *one->um; });
    if (!sheet_.error_of.empty())
      html += "<p>" + Text("operation") + ": " + Escaped(sheet_.error_of) + "</p>\n";
    html += "<table class=\"bars\">\n";
    const auto bar = [&](const std::string& name, double um, const char* colour) {
      html += fmt::format(
          "<tr><td>{}</td><td><i style=\"width:{:.1f}%;background:{}\"></i></td><td class=\"n\">{:.3g} "
          "µm</td></tr>\n",
          Text(name), std::max(0.3, 100 * um / sum), colour, um);
    };
    for (size_t i = 0; i < std::min(stated.size(), SummaryRoom::kSources); ++i)
      bar(stated[i]->name, *stated[i]->um, kSourceColour);
    bar("sum of what is stated", sum, "#5b6773");
    html += "</table>\n";
    if (missing.empty()) return html;
    return html + "<p class=\"of\">" + Text("not stated") + ": " +
           Escaped(Cut(Said(fmt::format("{}", fmt::join(missing, ", "))), 180)) + "</p>\n";
  }

  std::string Course(const PathCurves& course, double height) const {
    std::string html = "<figure><figcaption><b>" + Text(course.title) + "</b>, " + Escaped(course.unit);
    for (const PathSeries& series : course.series)
      if (course.series.size() > 1)
        html += fmt::format("<i style=\"background:{}\"></i>{}", series.colour, Text(series.name));
    if (!course.note.empty()) html += "<br><small>" + Escaped(Cut(Said(course.note), 110)) + "</small>";
    return html + "</figcaption>" + CurvesSvg(course, height, Said(course.title)) + "</figure>\n";
  }

  std::string SecondPage() const {
    constexpr size_t kTexts = SummaryRoom::kSecondPage - SummaryRoom::kLeastPrograms;
    const std::vector<std::string> findings = Fitted(sheet_.findings, kTexts * 2 / 3);
    const size_t used = std::max<size_t>(1, LinesOfAll(findings));
    const std::vector<std::string> warnings = Fitted(sheet_.warnings, kTexts - used);
    std::string html = Head("Findings");
    html += findings.empty() ? "<p>" + Text("none") + "</p>\n" : List(findings);
    html += Head("Warnings");
    html += warnings.empty() ? "<p>" + Text("none") + "</p>\n" : List(warnings);
    const size_t left = SummaryRoom::kSecondPage - used - std::max<size_t>(1, LinesOfAll(warnings));
    return html + Programs(left) + Signatures();
  }

  static std::string List(const std::vector<std::string>& said) {
    std::string html = "<ul>\n";
    for (const std::string& one : said) html += "<li>" + Escaped(one) + "</li>\n";
    return html + "</ul>\n";
  }

  std::string Programs(size_t room) const {
    const std::vector<SummaryProgram>& all = sheet_.programs;
    std::string html = Head("Programs, in the order of the work");
    if (all.empty()) html += "<p>" + Text("none") + "</p>\n";
    const size_t shown = all.size() <= room ? all.size() : room - 1;
    if (!all.empty()) {
      html += "<div class=\"wide\"><table class=\"programs\">\n<thead><tr>";
      for (const char* column : {"controller", "file", "read back", "hash"})
        html += "<th>" + Text(column) + "</th>";
      html += "</tr></thead>\n<tbody>\n";
      for (size_t i = 0; i < shown; ++i)
        html += fmt::format("<tr><td>{}</td><td>{}</td><td>{}</td><td><code>{}</code></td></tr>\n",
                            Escaped(all[i].controller), Escaped(CutFront(all[i].file, 46)),
                            Text(all[i].read_back), Escaped(all[i].hash.empty() ? "-" : all[i].hash));
      html += "</tbody>\n</table></div>\n";
    }
    if (shown < all.size())
      html += "<p>" + Text(fmt::format("{} more: manifest.json", all.size() - shown)) + "</p>\n";
    return html + "<p class=\"of\">" + Text(sheet_.seal) + "</p>\n";
  }

  std::string Signatures() const {
    std::string html = "<div class=\"bottom\"><table class=\"sign\">\n<tr><th></th>";
    for (const char* column : {"full name", "date", "signature"}) html += "<th>" + Text(column) + "</th>";
    html += "</tr>\n";
    for (const char* who : {"planned by", "checked by", "released by"})
      html += "<tr><td>" + Text(who) + "</td><td></td><td></td><td></td></tr>\n";
    return html + "</table></div>\n";
  }

  const SummarySheet& sheet_;
  Language language_;
};

}  // namespace

std::string SummarySheetHtml(const SummarySheet& sheet, Language language) {
  return SummaryWriter(sheet, language).Html();
}

}  // namespace millpose
