// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/campaign/krl_files.hpp"

namespace millpose::campaign {

std::string KrlMain(const std::map<std::string, std::string>& files) {
  for (const auto& [name, text] : files) {
    bool called = false;
    for (const auto& [other, body] : files)
      called = called || (other != name && Upper(body).find("\n" + name + " (") != std::string::npos);
    if (!called) return name;
  }
  throw Refusal{"no main program"};
}

void CheckKrlLabels(const std::vector<std::string>& lines) {
  std::set<std::string> labels;
  for (const std::string& text : lines) {
    Cursor at(Upper(text.substr(0, text.find(';'))));
    const std::string name = at.Name();
    if (!name.empty() && at.TakeChar(':') && at.Done() && !labels.insert(name).second)
      throw Refusal{"label " + name + " is defined twice"};
  }
}

}  // namespace millpose::campaign
