// SPDX-License-Identifier: GPL-3.0-or-later
// A cell file: its sections, each with a table of its own, and its bodies.
#include "job/config/fields.hpp"

namespace millpose::config {
Codec<ShapeSettings> ShapeFields() {
  using S = ShapeSettings;
  const auto size = [](const char* key, auto access, const char* doc) {
    return Key<S>(key, access, Real(kMm, Positive(1e5)), doc).Required();
  };
  const auto diameter = size("diameter_mm", MILLPOSE_AT(diameter), "Diameter.");
  const auto length = size("length_mm", MILLPOSE_AT(length), "Length along z.");
  return OneOf<S, ShapeKind>(
      &S::kind,
      {
          {"box", ShapeKind::kBox,
           Section<S>({Key<S>("size_mm", MILLPOSE_AT(size), Numbers3(kMm, Positive(1e5)),
                              "Edges along x, y, z; centred.")
                           .Required()})},
          {"sphere", ShapeKind::kSphere, Section<S>({diameter})},
          {"cylinder", ShapeKind::kCylinder, Section<S>({diameter, length})},
          {"capsule", ShapeKind::kCapsule, Section<S>({diameter, length})},
          {"cone", ShapeKind::kCone,
           Section<S>(
               {diameter, size("top_diameter_mm", MILLPOSE_AT(top_diameter), "Diameter on top."), length})},
          {"convex", ShapeKind::kConvex,
           Section<S>(
               {Key<S>("points_mm", MILLPOSE_AT(points), ListOf(Numbers3(kMm, Between(-100000, 100000))),
                       "Points whose convex hull is the body; at least 4.")
                    .Required()},
               [](const Value& value, const Context& context, S& shape) {
                 if (shape.points.size() < 4)
                   context.Child("points_mm")
                       .Add(value.mark,
                            fmt::format("given {} points; allowed: at least 4", shape.points.size()));
               })},
          {"mesh", ShapeKind::kMesh,
           Section<S>(
               {Key<S>("file", MILLPOSE_AT(mesh_file), Text(),
                       "Mesh file, relative to the file that names it.")
                    .Required(),
                Key<S>("unit", MILLPOSE_AT(unit), LengthUnit(), "Unit of the mesh file.").Required()})},
      });
}

namespace {

std::vector<std::pair<std::string, MountSettings>> MountNames() {
  std::vector<std::pair<std::string, MountSettings>> names{{"world", {Mount::kWorld}}};
  for (const auto& [word, link] : kLinkWords) names.emplace_back(word, MountSettings{Mount::kLink, link});
  names.emplace_back("tool", MountSettings{Mount::kTool});
  names.emplace_back("workpiece", MountSettings{Mount::kWorkpiece});
  names.emplace_back("carriage", MountSettings{Mount::kCarriage});
  return names;
}

}  // namespace

Codec<BodySettings> BodyFields() {
  using S = BodySettings;
  return Section<S>({
      Key<S>("name", MILLPOSE_AT(name), Text(), "Name, as in findings and `excluded_pairs`.").Required(),
      Key<S>("class", MILLPOSE_AT(body_class),
             ChoiceOf<BodyClass>({{"link", BodyClass::kLink},
                                  {"spindle", BodyClass::kSpindle},
                                  {"holder", BodyClass::kHolder},
                                  {"cutter", BodyClass::kCutter},
                                  {"fixture", BodyClass::kFixture},
                                  {"platform", BodyClass::kPlatform}}),
             "What the body is; decides which pairs are checked and with which clearance.")
          .Required(),
      Key<S>("mount", MILLPOSE_AT(mount), ChoiceOf<MountSettings>(MountNames()),
             "Frame that the body hangs on; carriage: what an external axis carries, given in the world with "
             "all "
             "external axes at 0.")
          .Required(),
      Key<S>("axis", MILLPOSE_AT(axis), Text(), "With mount carriage: the name of the external axis.")
          .WhenSet([](const S& s) { return !s.axis.empty(); }),
      Key<S>("shape", MILLPOSE_AT(shape), ShapeFields(), "One shape.").Required(),
      Key<S>("pose", MILLPOSE_AT(pose), PoseFields(), "Place of the shape in the frame that it hangs on."),
  });
}

namespace {

// The number of a cell's only tool tells a program something where the tool is changed or a text asks for it.
void CheckNumber(const Value& value, const Context& context, const CellSettings& cell) {
  if (!cell.tool.number || cell.change_at) return;
  for (const auto& [name, controller] : cell.controllers)
    for (const auto& [text, lines] : controller.shared.texts)
      if (lines.find("{number}") != std::string::npos) return;
  context.Child("tool").Child("number").Add(
      value.Find("tool")->FindKey("number")->mark,
      "has no effect here: no text of controllers has {number}, and a cell with one tool and without "
      "tool_change_deg never changes it");
}

// What tells tools apart must differ.
void CheckToolsDiffer(const Value& list, const Context& context, const std::vector<ToolSettings>& tools) {
  for (size_t i = 0; i < tools.size(); ++i)
    for (size_t j = 0; j < i; ++j) {
      const Context at = context.Child(i);
      if (tools[i].name == tools[j].name)
        at.Child("name").Add(list.items[i].mark, fmt::format("given {} twice", tools[i].name));
      if (tools[i].number && tools[i].number == tools[j].number)
        at.Child("number").Add(list.items[i].mark, fmt::format("given {} twice", *tools[i].number));
    }
}

// A cell has one tool, a list of them, or the list of a tools file; the first one counts until a job names
// another.
void CheckTools(const Value& value, const Context& context, CellSettings& cell) {
  if (const Value::Key* file = value.FindKey("tools_file")) {
    cell.tools_line = file->mark.line;
    for (const char* other : {"tool", "tools"})
      if (const Value::Key* given = value.FindKey(other))
        context.Child(other).Add(given->mark, "given together with tools_file; allowed: one of the two");
    return;
  }
  if (cell.tools.empty()) {
    if (const Value* given = value.Find("tools"))
      context.Child("tools").Add(given->mark, "given no tool; allowed: at least one");
    else
      CheckNumber(value, context, cell);
    return;
  }
  if (const Value::Key* one = value.FindKey("tool"))
    context.Child("tool").Add(one->mark, "given together with tools; allowed: one of the two");
  CheckToolsDiffer(*value.Find("tools"), context.Child("tools"), cell.tools);
  cell.tool = cell.tools.front();
}

Codec<CellSettings> CheckedFields() {
  using S = CellSettings;
  return Section<S>({
      Key<S>(
          "unchecked_links", MILLPOSE_AT(unchecked_links),
          ListOf(ChoiceOf<int>({kLinkWords.begin(), kLinkWords.end() - 1})),
          "Links that have no body on purpose, so that nothing sees them touch: a warning in every output.")
          .RequiredUnless("far_bodies")
          .WhenSet([](const S& s) { return !s.unchecked_links.empty(); }),
      Key<S>("far_bodies", MILLPOSE_AT(far_bodies), ListOf(Text()),
             "Bodies that lie farther from the link that they hang on than the arm is long, on purpose: else "
             "an error, since it is mostly a slip in a unit.")
          .WhenSet([](const S& s) { return !s.far_bodies.empty(); }),
  });
}

Codec<AirFeedSettings> AirFeedFields() {
  using S = AirFeedSettings;
  return Section<S>({
      Key<S>("feed_mm_min", MILLPOSE_AT(feed), Real(kMmPerMin, Between(0.1, 2e5)),
             "Feed there, as far as the axes can follow; cuts that are faster anyway stay as they are.")
          .Required(),
      Key<S>("margin_mm", MILLPOSE_AT(margin), Real(kMm, Between(1, 1000)),
             "No material is nearer to the cutter; at least the way in which the arm slows down to the feed "
             "of a cut."),
      Key<S>("longer_than_mm", MILLPOSE_AT(longer_than), Real(kMm, UpTo(1e5)),
             "Way in the air in one go; on shorter ones the feed stays."),
  });
}

}  // namespace

const Codec<CellSettings>& CellFields() {
  using S = CellSettings;
  static const Codec<S> fields = Section<S>(
      {
          VersionKey<S>("millpose_cell", 1),
          Key<S>("name", MILLPOSE_AT(name), Text(), "Name of the cell.").Required(),
          Key<S>("arm", MILLPOSE_AT(arm), ArmFields(), "The robot arm.").Required(),
          Key<S>("base_in_world", MILLPOSE_AT(base_in_world), PoseFields(), "Robot base in the world."),
          Key<S>("external_axes", MILLPOSE_AT(external_axes), ListOf(ExternalAxisFields()),
                 "Rails, lifts and tables (docs/external-axes.md), up to three.")
              .WhenSet([](const S& s) { return !s.external_axes.empty(); }),
          Key<S>("home_deg", MILLPOSE_AT(home), Numbers6(kDeg, Between(-3600, 3600)),
                 "Where programs start and end.")
              .Required(),
          Key<S>("tool", MILLPOSE_AT(tool), ToolFields(), "Tool tip, cutter, holder and spindle.")
              .RequiredUnless("tools, tools_file")
              .WhenSet([](const S& s) { return s.tools.empty(); }),
          Key<S>(
              "tools", MILLPOSE_AT(tools), ListOf(ToolFields()),
              "In place of `tool`: all tools that the spindle can hold, each as `tool`; a job names its own.")
              .WhenSet([](const S& s) { return !s.tools.empty(); }),
          Key<S>("tools_file", MILLPOSE_AT(tools_file), Text(),
                 "In place of `tools`: a tools file that holds them, relative to this file (docs/tools.md).")
              .WhenSet([](const S& s) { return !s.tools_file.empty(); }),
          Key<S>("tool_change_deg", MILLPOSE_AT(change_at), Maybe(Numbers6(kDeg, Between(-3600, 3600))),
                 "Axes A1 to A6 at which the tool is changed, by the text tool_change; else at home."),
          Key<S>("bodies", MILLPOSE_AT(bodies), ListOf(BodyFields()), "What must not be touched."),
          Key<S>("excluded_pairs", MILLPOSE_AT(excluded_pairs), ListOf(NamePair()),
                 "Pairs of bodies that touch by design and are not checked."),
          Key<S>(
              "auto_excluded_pairs", MILLPOSE_AT(auto_excluded_pairs), Flag(),
              "Adds to them the bodies on links at most two joints apart that touch in each of 200 poses."),
          Key<S>("interference", kSelf, CheckedFields(), "What interference is not checked for.")
              .WhenSet([](const S& s) { return !s.unchecked_links.empty() || !s.far_bodies.empty(); }),
          Key<S>("clearance_mm", kSelf,
                 Section<S>({
                     Key<S>("free", MILLPOSE_AT(clearance_free), Real(kMm, UpTo(1000)),
                            "Least distance of all bodies while the tool is out of the material."),
                     Key<S>("cutting", MILLPOSE_AT(clearance_cutting), Real(kMm, UpTo(1000)),
                            "Least distance of spindle and holder from the workpiece while cutting."),
                 }),
                 "Distances to keep."),
          Key<S>("air_feed", MILLPOSE_AT(air_feed), Maybe(AirFeedFields()),
                 "Faster along cuts where nothing of `workpiece.stock` is near (docs/stock.md); jobs without "
                 "it run as ever."),
          Key<S>("stiffness", kSelf, StiffnessFields(), "How stiffness is evaluated."),
          KeyBy<S, bool>(
              "reproduction_only", [](const S& s) { return !s.programs_allowed; },
              [](S& s, const bool& only) { s.programs_allowed = !only; }, Flag(),
              "The arm's convention is no real controller's: programs are refused."),
          Key<S>("controllers", MILLPOSE_AT(controllers), ControllersFields(),
                 "What each controller's programs need to know."),
      },
      [](const Value& value, const Context& context, S& cell) {
        CheckTools(value, context, cell);
        CheckExternalAxes(value, context, cell);
        CheckGearFriction(value, context, cell);
        const auto line = [&](const char* key) {
          const Value::Key* given = value.FindKey(key);
          return (given ? given->mark : value.mark).line;
        };
        cell.bodies_line = line("bodies");
        cell.controllers_line = line("controllers");
      });
  return fields;
}

const Codec<ToolsFile>& ToolsFileFields() {
  using S = ToolsFile;
  static const Codec<S> fields = Section<S>(
      {
          VersionKey<S>("millpose_tools", 1),
          Key<S>("tools", MILLPOSE_AT(tools), ListOf(ToolFields()), "The tools, each as a cell's `tool`.")
              .Required(),
      },
      [](const Value& value, const Context& context, S& file) {
        const Context at = context.Child("tools");
        const Value& list = *value.Find("tools");
        if (file.tools.empty()) at.Add(list.mark, "given no tool; allowed: at least one");
        CheckToolsDiffer(list, at, file.tools);
      });
  return fields;
}

}  // namespace millpose::config
