// SPDX-License-Identifier: GPL-3.0-or-later
#include "machine/robot/xacro.hpp"

#include <tinyxml2.h>

#include <cstring>
#include <filesystem>
#include <list>
#include <map>

#include "base/error.hpp"
#include "base/text.hpp"
#include "base/units.hpp"

namespace millpose {
namespace {

using tinyxml2::XMLDocument;
using tinyxml2::XMLElement;
using tinyxml2::XMLNode;

constexpr int kDeepest = 32;              // of includes and macros in each other
constexpr size_t kMostElements = 100000;  // that come out: macros can multiply
constexpr size_t kLongest = 100000;       // of a value, likewise

bool IsXacroName(const char* name) { return std::strncmp(name, "xacro:", 6) == 0; }

bool HasXacro(const XMLNode& node) {
  for (const XMLElement* e = node.FirstChildElement(); e; e = e->NextSiblingElement())
    if (IsXacroName(e->Name()) || HasXacro(*e)) return true;
  return false;
}

class Expander {
 public:
  Expander(const XacroInclude& include, XMLDocument& to) : include_(include), to_(to) {
    properties_["pi"] = ShortestNumber(kPi);
  }

  /// The children of `from`, a node of `file`, expanded into `into`.
  void Children(const XMLNode& from, XMLNode& into, const std::string& file, int depth) {
    for (const XMLNode* child = from.FirstChild(); child; child = child->NextSibling()) {
      const XMLElement* element = child->ToElement();
      if (!element) continue;  // URDF has no text that matters
      if (depth > kDeepest) Refuse(*element, file, "includes or macros stand in each other too deeply");
      if (IsXacroName(element->Name()))
        Xacro(*element, into, file, depth);
      else
        Copy(*element, into, file, depth);
    }
  }

 private:
  struct Macro {
    const XMLElement* body;
    std::string file;
  };

  [[noreturn]] static void Refuse(const XMLElement& at, const std::string& file, const std::string& why) {
    throw InputError(
        {file, at.GetLineNum()},
        fmt::format(
            "xacro: {}; expand the file with xacro first (`xacro {} > arm.urdf`). Expanded here: properties "
            "that are plain values, macros without parameters, includes by path",
            why, std::filesystem::path(file).filename().string()));
  }

  void Copy(const XMLElement& element, XMLNode& into, const std::string& file, int depth) {
    if (++elements_ > kMostElements) Refuse(element, file, "too many elements come out");
    XMLElement* copy = to_.NewElement(element.Name());
    into.InsertEndChild(copy);
    for (const auto* a = element.FirstAttribute(); a; a = a->Next())
      copy->SetAttribute(a->Name(), Filled(a->Value(), element, file).c_str());
    Children(element, *copy, file, depth);
  }

  void Xacro(const XMLElement& element, XMLNode& into, const std::string& file, int depth) {
    const std::string name = element.Name() + std::strlen("xacro:");
    if (name == "property") return Property(element, file);
    if (name == "include") return Include(element, into, file, depth);
    if (name == "macro") return Define(element, file);
    const auto found = macros_.find(name);
    if (found == macros_.end())
      Refuse(element, file, fmt::format("<xacro:{}> is not a macro that was defined before", name));
    if (element.FirstAttribute() || element.FirstChildElement())
      Refuse(element, file, fmt::format("macro {} is called with parameters", name));
    Children(*found->second.body, into, found->second.file, depth + 1);
  }

  void Property(const XMLElement& element, const std::string& file) {
    const char *name = element.Attribute("name"), *value = element.Attribute("value");
    if (!name || !value || element.FirstAttribute()->Next()->Next() || element.FirstChildElement())
      Refuse(element, file, "a property that is no plain name and value");
    properties_[name] = Filled(value, element, file);
  }

  void Define(const XMLElement& element, const std::string& file) {
    const char *name = element.Attribute("name"), *parameters = element.Attribute("params");
    if (!name || (parameters && *parameters))
      Refuse(element, file, fmt::format("macro {} has parameters", name ? name : "without a name"));
    macros_[name] = {&element, file};
  }

  void Include(const XMLElement& element, XMLNode& into, const std::string& file, int depth) {
    const char* name = element.Attribute("filename");
    if (!name || element.FirstAttribute()->Next())
      Refuse(element, file, "an include that is no plain filename");
    const std::filesystem::path given = Filled(name, element, file);
    if (!include_) Refuse(element, file, fmt::format("{} is not read here", given.string()));
    const std::string path = (std::filesystem::path(file).parent_path() / given).lexically_normal().string();
    XMLDocument& document = documents_.emplace_back();
    const std::string bytes = [&] {
      try {
        return include_(path);
      } catch (const InputError& error) {
        Refuse(element, file, fmt::format("{}: {}", path, error.problems().front().message));
      }
    }();
    if (document.Parse(bytes.data(), bytes.size()) != tinyxml2::XML_SUCCESS)
      throw InputError({path, document.ErrorLineNum()}, fmt::format("not XML: {}", document.ErrorName()));
    const XMLElement* root = document.FirstChildElement();
    if (root) Children(*root, into, path, depth + 1);
  }

  /// `text` with its properties.
  std::string Filled(const std::string& text, const XMLElement& at, const std::string& file) const {
    if (text.find("$(") != std::string::npos) Refuse(at, file, fmt::format("'{}'", text));
    std::string filled;
    for (size_t begin = 0;;) {
      const size_t hole = text.find("${", begin);
      filled += text.substr(begin, hole - begin);
      if (hole == std::string::npos) return filled;
      const size_t end = text.find('}', hole);
      const std::string name = end == std::string::npos ? "" : text.substr(hole + 2, end - hole - 2);
      const auto found = properties_.find(name);
      if (found == properties_.end())
        Refuse(at, file, fmt::format("'{}' is no property that was defined before", text.substr(hole)));
      filled += found->second;
      if (filled.size() > kLongest) Refuse(at, file, "a value grows too long");
      begin = end + 1;
    }
  }

  const XacroInclude& include_;
  XMLDocument& to_;
  std::list<XMLDocument> documents_;  // included; bodies of macros lie in them
  std::map<std::string, std::string> properties_;
  std::map<std::string, Macro> macros_;
  size_t elements_ = 0;
};

}  // namespace

bool IsXacro(const XMLDocument& document) { return HasXacro(document); }

void ExpandXacro(XMLDocument& document, const std::string& file, const XacroInclude& include) {
  XMLDocument expanded;
  Expander(include, expanded).Children(document, expanded, file, 0);
  document.Clear();
  expanded.DeepCopy(&document);
}

}  // namespace millpose
