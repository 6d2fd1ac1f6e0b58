// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/page/table_page.hpp"

#include "report/page/escaped.hpp"

namespace millpose {
namespace {

constexpr const char* kBeforeLanguage = "<!DOCTYPE html>\n<html lang=\"";

constexpr const char* kBeforeTitle = R"html(">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>)html";

constexpr const char* kStyle = R"html(</title>
<style>
:root { color-scheme: light dark; --ink: #27313b; --muted: #5b6773; --line: #dfe4e9; --card: #fff; --ground: #eef1f4; --accent: #2b5fa8; --bad: #b3261e; }
@media (prefers-color-scheme: dark) {
  :root { --ink: #e4e8ec; --muted: #a3adb7; --line: #3a434c; --card: #1f262d; --ground: #161b20; --accent: #8ab4f0; --bad: #ff9d94; }
}
@media print { :root { color-scheme: light; --ink: #000; --muted: #333; --line: #999; --card: #fff; --ground: #fff; --accent: #000; --bad: #000; } }
@page { size: A4; margin: 12mm 12mm 14mm; @bottom-right { content: counter(page) " / " counter(pages); font: 9px sans-serif; } }
* { box-sizing: border-box; }
body { margin: 0; padding: 14px 18px 20px; background: var(--ground); color: var(--ink); font: 13px/1.45 system-ui, -apple-system, "Segoe UI", "DejaVu Sans", sans-serif; }
h1 { font-size: 19px; margin: 0 0 8px; overflow-wrap: anywhere; }
h2 { font-size: 14px; margin: 0 0 6px; }
table { border-collapse: collapse; width: 100%; }
th, td { padding: 5px 9px; border-bottom: 1px solid; border-color: var(--line); text-align: left; white-space: nowrap; vertical-align: top; }
.n { text-align: right; font-variant-numeric: tabular-nums; }
.bad { color: var(--bad); font-weight: 600; }
.scroll { background: var(--card); border: 1px solid; border-color: var(--line); border-radius: 5px; margin-bottom: 10px; }
@media screen { .scroll { overflow-x: auto; } }
a { color: var(--accent); }
)html";

}  // namespace

std::string TablePageHead(std::string_view title, std::string_view style, Language language) {
  std::string head =
      kBeforeLanguage + WordOf(kLanguageWords, language) + kBeforeTitle + Escaped(title) + kStyle;
  head += style;
  return head + "</style>\n</head>\n<body>\n";
}

}  // namespace millpose
