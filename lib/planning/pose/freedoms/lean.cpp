// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/pose/freedoms/lean.hpp"

#include "base/rotation.hpp"
#include "base/units.hpp"
#include "planning/pose/freedom_entry.hpp"
#include "toolpath/lean_law.hpp"

namespace millpose {

ToolStance LeanOfTool::Lean(const CutterContact& contact, const ToolStance& from, double value) const {
  const Eigen::Vector3d axis = RotationAbout(About(contact), value) * from.axis;
  return {TipAtContact(contact.cutter, contact.place, contact.normal, axis), axis};
}

Eigen::Vector3d Lead::About(const CutterContact& contact) const { return contact.normal.cross(contact.feed); }

Eigen::Vector3d Tilt::About(const CutterContact& contact) const { return contact.feed; }

void Lead::Open(LeanRules& rules) const { rules.lead_free = true; }

void Tilt::Open(LeanRules& rules) const { rules.tilt_free = true; }

namespace {

using namespace yaml;  // NOLINT: the tables are written in its words

/// What a job gives of a lean: its value, or the range that the pose search may take it from.
struct LeanSetting {
  double value = 0;
  std::optional<LeanRange> range;
};

Codec<LeanRange> LeanRangeFields() {
  using S = LeanRange;
  const Codec<double> angle = Real(kDeg, Between(-60, 60));
  const auto check = [](const Value& value, const Context& context, S& range) {
    constexpr double kMostValues = 25;
    const auto wrong = [&](const char* key, const std::string& allowed) {
      context.Child(key).AddWrong(*value.Find(key), allowed);
    };
    const auto degrees = [](double rad) { return fmt::format("{:.6g}", RadToDeg(rad)); };
    if (!(range.from < range.to)) return wrong("to", "above from, " + degrees(range.from));
    const double width = range.to - range.from;
    if (range.step > width || range.step * kMostValues < width)
      wrong("step", fmt::format("{:.6g} to {:.6g}: at most {} steps in the range",
                                RadToDeg(width) / kMostValues, RadToDeg(width), kMostValues));
    if (!value.FindKey("nominal")) range.nominal = std::clamp(0.0, range.from, range.to);
    if (range.nominal < range.from || range.nominal > range.to)
      wrong("nominal", degrees(range.from) + " to " + degrees(range.to));
  };
  return Section<S>({Key<S>("from", MILLPOSE_AT(from), angle, "Least value.").Required(),
                     Key<S>("to", MILLPOSE_AT(to), angle, "Largest value.").Required(),
                     Key<S>("step", MILLPOSE_AT(step), Real(kDeg, Between(0.01, 60)),
                            "Grid of the ladder search; between its values the path is refined.")
                         .Required(),
                     Key<S>("nominal", MILLPOSE_AT(nominal), angle, "How the tool path is laid.")
                         .DefaultText("nearest to 0")},
                    check);
}

Codec<LeanSetting> LeanFields() {
  const Codec<double> number = Real(kDeg, Between(-89, 89));
  const Codec<LeanRange> map = LeanRangeFields();
  Codec<LeanSetting> codec;
  codec.type = number.type + ", or a map";
  codec.keys = map.keys;
  codec.schema = [number, map] {
    Value schema = Value::Map();
    schema.Put("anyOf", Value::List({number.schema(), map.schema()}));
    return schema;
  };
  codec.read = [number, map](const Value& value, const Context& context, LeanSetting& lean) {
    if (value.kind != Value::Kind::kMap) {
      lean.range.reset();
      return number.read(value, context, lean.value);
    }
    LeanRange range;
    const size_t before = context.problems.size();
    map.read(value, context, range);
    if (context.problems.size() == before) lean = {range.nominal, range};
  };
  codec.write = [number, map](const LeanSetting& lean) {
    return lean.range ? map.write(*lean.range) : number.write(lean.value);
  };
  return codec;
}

/// A number says how the path is laid; a range opens the freedom, too.
template <class F>
FreedomEntry LeanEntry(const char* key, double ToolpathOptions::*value, const char* doc) {
  const std::string name = F(LeanRange{}).Name();
  return {.name = name,
          .key = KeyBy<OpenToolpath, LeanSetting>(
              key,
              [=](const OpenToolpath& toolpath) {
                LeanSetting lean{toolpath.*value, {}};
                if (const auto* own = dynamic_cast<const F*>(toolpath.Find(name)))
                  lean.range = own->options();
                return lean;
              },
              [=](OpenToolpath& toolpath, const LeanSetting& lean) {
                toolpath.*value = lean.value;
                toolpath.freedoms.erase(name);
                if (lean.range) toolpath.freedoms[name] = std::make_shared<const F>(*lean.range);
              },
              LeanFields(), doc),
          .leans = true};
}

}  // namespace

FreedomEntry LeadEntry() {
  return LeanEntry<Lead>(
      "lead_deg", &ToolpathOptions::lead,
      "Tool axis leans towards the feed direction: by so much, or by what the pose search chooses from "
      "a range (docs/lean.md).");
}

FreedomEntry TiltEntry() {
  return LeanEntry<Tilt>("tilt_deg", &ToolpathOptions::tilt,
                         "Tool axis leans across the feed direction, likewise.");
}

}  // namespace millpose
