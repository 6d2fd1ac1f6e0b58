// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/ranges.h>

#include <algorithm>
#include <map>

#include "job/config/config.hpp"
#include "job/config/fields.hpp"

namespace millpose {
namespace {

/// In a table's cell a bar would begin the next one.
std::string Cell(std::string_view text) {
  std::string cell;
  for (const char c : text) {
    if (c == '|') cell += '\\';
    cell += c;
  }
  return cell;
}

/// "urdf, dh" as "urdf` or `dh".
std::string Either(std::string keys) {
  if (const size_t at = keys.find(", "); at != std::string::npos) keys.replace(at, 2, "` or `");
  return keys;
}

std::string Row(const config::FieldInfo& info, const std::string& path) {
  const std::string otherwise = info.required ? "**required**"
                                : !info.required_unless.empty()
                                    ? "required without `" + Either(info.required_unless) + '`'
                                : info.default_text.empty() ? "–"
                                                            : '`' + info.default_text + '`';
  return fmt::format("| `{}` | {} | {} | {} |\n", path, Cell(info.type), Cell(otherwise), Cell(info.doc));
}

/// All that is said of a key and of those below it.
std::string Said(const config::FieldInfo& info) {
  std::string said = Row(info, info.key);
  for (const config::FieldInfo& key : info.keys) said += Said(key);
  return said + ".";
}

/// One table, in which nothing is said twice: a key that says the same elsewhere is named with that place.
class Table {
 public:
  explicit Table(std::string* out) : out_(*out) {}

  void AddRows(const std::vector<config::FieldInfo>& keys, const std::string& prefix) {
    std::map<std::string, std::vector<std::string>> elsewhere;  // keys by the prefix where they stand already
    for (const config::FieldInfo& info : keys)
      if (const auto at = said_.find(Said(info)); at != said_.end() && at->second != prefix)
        elsewhere[at->second].push_back('`' + info.key + '`');
    // One key alone is reported as soon as its place.
    std::erase_if(elsewhere, [](const auto& place) { return place.second.size() < 2; });
    for (const config::FieldInfo& info : keys) {
      const auto [at, is_new] = said_.try_emplace(Said(info), prefix);
      if (!is_new && elsewhere.contains(at->second)) continue;
      const bool list = info.type.starts_with("list of: ");
      out_ += Row(info, prefix + info.key);
      AddRows(info.keys, prefix + info.key + (list ? "[]." : "."));
    }
    for (const auto& [place, names] : elsewhere)
      out_ += fmt::format("| `{}`: {} | as in `{}` | | |\n", Without(prefix), fmt::join(names, ", "),
                          Without(place));
  }

 private:
  static std::string Without(const std::string& prefix) {  // the last dot
    return prefix.substr(0, prefix.empty() ? 0 : prefix.size() - 1);
  }

  std::string& out_;
  std::map<std::string, std::string> said_;  // by what is said, the prefix under which it stands
};

void AddTable(const std::string& title, const std::vector<config::FieldInfo>& keys, std::string& out) {
  out += fmt::format("\n## {}\n\n| key | allowed | default | meaning |\n|---|---|---|---|\n", title);
  Table(&out).AddRows(keys, "");
}

}  // namespace

std::string YamlReference() {
  std::string out =
      "# YAML reference\n\n"
      "Made from the field tables (CONTRIBUTING.md says where they stand) by `millpose schema "
      "reference`.\nNumbers are "
      "written like 1, 1.5 or 1e-5; file names are relative to the file that names them. Unknown and "
      "duplicate\nkeys, anchors, aliases, tags and quoted text over several lines are errors. What several "
      "places have alike\nstands once; the others name it.\n";
  AddTable("Job", config::JobFields().keys(), out);
  AddTable("Cell", config::CellFields().keys(), out);
  AddTable("Tools file", config::ToolsFileFields().keys(), out);
  AddTable("Batch manifest", config::BatchFields().keys(), out);
  return out;
}

}  // namespace millpose
