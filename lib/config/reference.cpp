// SPDX-License-Identifier: GPL-3.0-or-later
#include "config/config.hpp"
#include "config/fields.hpp"

namespace millpose {
namespace {

std::string Row(const config::FieldInfo& info, const std::string& path) {
  const std::string otherwise = info.required ? "**required**"
                                : !info.required_unless.empty()
                                    ? fmt::format("required without `{}`", info.required_unless)
                                : info.default_text.empty() ? "–"
                                                            : '`' + info.default_text + '`';
  return fmt::format("| `{}` | {} | {} | {} |\n", path, info.type, otherwise, info.doc);
}

void AddRows(const std::vector<config::FieldInfo>& keys, const std::string& prefix, std::string& out) {
  for (const config::FieldInfo& info : keys) {
    const bool list = info.type.starts_with("list of: ");
    out += Row(info, prefix + info.key);
    AddRows(info.keys, prefix + info.key + (list ? "[]." : "."), out);
  }
}

void AddTable(const std::string& title, const std::vector<config::FieldInfo>& keys, std::string& out) {
  out += fmt::format("\n## {}\n\n| key | allowed | default | meaning |\n|---|---|---|---|\n", title);
  AddRows(keys, "", out);
}

}  // namespace

std::string YamlReference() {
  std::string out =
      "# YAML reference\n\n"
      "Made from the field tables (CONTRIBUTING.md says where they stand) by `millpose schema "
      "reference`.\nNumbers are "
      "written like 1, 1.5 or 1e-5; file names are relative to the file that names them. Unknown and "
      "duplicate\nkeys, anchors, aliases and tags are errors.\n";
  AddTable("Job", config::JobFields().keys, out);
  AddTable("Cell", config::CellFields().keys, out);
  AddTable("Batch manifest", config::BatchFields().keys, out);
  return out;
}

}  // namespace millpose
