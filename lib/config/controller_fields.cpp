// SPDX-License-Identifier: GPL-3.0-or-later
// The keys of a cell's `controllers:` section, and which controller knows which of them.
#include "config/fields.hpp"
#include "program/post.hpp"

namespace millpose::config {
namespace {

const Unit kMillisecond{"ms", 1, 1000};
const Unit kMetrePerS2{"m/s²", 1000, 1};

Codec<PathOutputSettings> OutputFields() {
  using S = PathOutputSettings;
  return Section<S>({
      Key<S>("number", MILLPOSE_AT(number), Integer(0, 8192), "Number of the digital output.").Required(),
      Key<S>("at", MILLPOSE_AT(at), Choice({"cut_begin", "cut_end"}),
             "First or last point of every cut (lead-in and lead-out belong to it).")
          .Required(),
      Key<S>("set", MILLPOSE_AT(on), Flag(), "What it is switched to.").Required(),
      Key<S>("delay_ms", MILLPOSE_AT(delay), Real(kMillisecond, Between(-1000, 1000)),
             "KRL: later than at that place; negative: before.")
          .WhenSet([](const S& s) { return s.delay != 0; }),
  });
}

/// A name that programs can hold as a word.
bool IsWord(const std::string& name) {
  const auto letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; };
  return !name.empty() && name.size() <= 31 && letter(name[0]) &&
         std::ranges::all_of(name, [&](char c) { return letter(c) || (c >= '0' && c <= '9'); });
}

Codec<CallSettings> CallFields() {
  using S = CallSettings;
  return Section<S>(
      {
          Key<S>("name", MILLPOSE_AT(name), Text(), "Name of the program (LinuxCNC: or M100 to M199).")
              .Required(),
          Key<S>("moves", MILLPOSE_AT(moves), Flag(), "Whether it moves the arm.").Required(),
          Key<S>("from_deg", MILLPOSE_AT(from), Maybe(Numbers6(kDeg, Between(-3600, 3600))),
                 "Axes A1 to A6 (as home_deg) at which a call that moves begins."),
          Key<S>("to_deg", MILLPOSE_AT(to), Maybe(Numbers6(kDeg, Between(-3600, 3600))),
                 "Axes A1 to A6 at which a call that moves ends."),
      },
      [](const Value& value, const Context& context, S& call) {
        if (!IsWord(call.name))
          context.Child("name").Add(value.mark,
                                    fmt::format("given '{}'; allowed: letters, digits and '_', at most 31, "
                                                "beginning with a letter",
                                                call.name));
        if (call.moves != (call.from && call.to) || call.moves != (call.from || call.to))
          context.Add(value.mark, call.moves ? "a call that moves needs from_deg and to_deg"
                                             : "from_deg and to_deg have no effect where moves is false");
      });
}

Codec<RailSettings> RailFields() {
  using S = RailSettings;
  return Section<S>({
      Key<S>("pose", MILLPOSE_AT(pose), PoseFields(), "$ERSYSROOT: the rail's root in $WORLD.").Required(),
      Key<S>("axis", MILLPOSE_AT(axis), Integer(1, 6), "Which of external_axes is the carriage: 1 is E1."),
      Key<S>("direction", MILLPOSE_AT(direction), Choice({"x", "y", "z", "-x", "-y", "-z"}),
             "Direction of $ERSYSROOT in which the carriage moves where its axis grows."),
  });
}

/// A rail must be one of the external axes.
void CheckRail(const Value& value, const Context& context, const ControllerSettings& controller) {
  if (!controller.ersysroot) return;
  const auto axes = static_cast<int>(controller.external_axes.size());
  if (controller.ersysroot->axis > axes)
    context.Child("ersysroot")
        .Add(value.FindKey("ersysroot")->mark,
             fmt::format("its axis E{} is none of the {} external_axes; allowed: one of them",
                         controller.ersysroot->axis, axes));
}

const std::vector<std::string> kTexts = {"cartesian_on", "coolant_off", "coolant_on", "footer",
                                         "header",       "joints_on",   "pass_begin", "pass_end",
                                         "spindle_off",  "spindle_on",  "tool_change"};

Codec<ControllerSettings> ControllerFields() {
  using S = ControllerSettings;
  return Section<S>(
      {
          Key<S>("tool_axis", MILLPOSE_AT(tool_axis), Choice({"x", "y", "z", "-x", "-y", "-z"}),
                 "Axis of the controller's tool frame that lies along the tool, from tip to holder."),
          Key<S>("rotation", MILLPOSE_AT(rotation), Choice({"rpy", "euler"}),
                 "SINUMERIK (machine data ORI), Cartesian LinuxCNC: how A, B, C are counted."),
          Key<S>("axis_signs", MILLPOSE_AT(axis_signs), Signs(),
                 "Controller's angle = sign × arm's angle + offset."),
          Key<S>("axis_offsets_deg", MILLPOSE_AT(axis_offsets), Numbers6(kDeg, Between(-360, 360)),
                 "Controller's angle = sign × arm's angle + offset."),
          Key<S>(
              "axis_names", MILLPOSE_AT(axis_names), ListOf(Text()),
              "SINUMERIK: names of the six robot axes as channel axes, for motions without transformation."),
          Key<S>("settable_frame", MILLPOSE_AT(settable_frame), Maybe(Integer(505, 599)),
                 "SINUMERIK: G505 to G599, the settable frame that programs overwrite with the workpiece's "
                 "place; needed."),
          Key<S>("ori_ipo_with_g_code", MILLPOSE_AT(ori_ipo_with_g_code), Maybe(Flag()),
                 "SINUMERIK: MD21104; where it is not given, blocks are so short that every way to turn the "
                 "tool will do."),
          Key<S>("ori_def_with_g_code", MILLPOSE_AT(ori_def_with_g_code), Maybe(Flag()),
                 "SINUMERIK: MD21102; whether the program's ORIRPY or ORIEULER counts, or MD21100."),
          Key<S>("coordinates", MILLPOSE_AT(coordinates), Choice({"joint", "cartesian"}),
                 "LinuxCNC: X Y Z A B C are joints throughout, or the tool's pose in cuts."),
          Key<S>("base_number", MILLPOSE_AT(base_number), Integer(0, 32),
                 "KRL: $BASE = BASE_DATA[number] instead of values; 0: values."),
          Key<S>("tool_number", MILLPOSE_AT(tool_number), Integer(0, 16),
                 "KRL: $TOOL = TOOL_DATA[number] instead of values; 0: values."),
          Key<S>("external_axes", MILLPOSE_AT(external_axes), ListOf(Real({"mm or deg"}, Between(-1e6, 1e6))),
                 "KRL: constant E1, E2, … written with every target."),
          Key<S>("ptp_speed_percent", MILLPOSE_AT(ptp_speed_percent), Integer(1, 100),
                 "KRL: share of the axes' largest speed in motions between cuts."),
          Key<S>("advance", MILLPOSE_AT(advance), Integer(1, 5), "KRL: $ADVANCE, motions computed ahead."),
          Key<S>("path_acceleration_m_s2", MILLPOSE_AT(path_acceleration),
                 Maybe(Real(kMetrePerS2, Positive(100))),
                 "Largest acceleration of the tip, for the estimate of the speed along the path (2.3 by "
                 "default); "
                 "KRL: also written as $ACC.CP."),
          Key<S>("orientation_speed_deg_s", MILLPOSE_AT(orientation_speed), Real(kDegPerS, Positive(3600)),
                 "KRL: $VEL.ORI1 and $VEL.ORI2."),
          Key<S>("orientation_acceleration_deg_s2", MILLPOSE_AT(orientation_acceleration),
                 Maybe(Real(kDegPerS2, Positive(1e5))),
                 "KRL: $ACC.ORI1 and $ACC.ORI2; the controller's own by default."),
          Key<S>("tool_direction", MILLPOSE_AT(tool_direction), Choice({"x", "y", "z"}),
                 "KRL: $TOOL_DIRECTION, the axis of $TOOL that LIN swivels evenly."),
          Key<S>("robroot", MILLPOSE_AT(robroot), Maybe(PoseFields()),
                 "KRL: $ROBROOT, the robot's base in $WORLD, as the controller has it; with ersysroot: the "
                 "robot's "
                 "base on the carriage at 0. Needed where the robot does not stand upright.")
              .DefaultText("zero, as delivered"),
          Key<S>("ersysroot", MILLPOSE_AT(ersysroot), Maybe(RailFields()),
                 "KRL: a rail that the controller counts in ($WORLD stays where it is when it moves)."),
          Key<S>("write_load", MILLPOSE_AT(write_load), Flag(),
                 "KRL: programs set $LOAD to tool.load; else the controller's own load data hold."),
          Key<S>("interpolation_cycle_ms", MILLPOSE_AT(interpolation_cycle),
                 Maybe(Real(kMillisecond, Between(0.1, 100))),
                 "Interpolation cycle, for the estimate of the speed along the path.")
              .DefaultText("krl: 12, sinumerik: 4, linuxcnc: 1"),
          Key<S>("block_time_ms", MILLPOSE_AT(block_time), Maybe(Real(kMillisecond, Between(0.1, 1000))),
                 "Shortest time per motion, for that estimate.")
              .DefaultText("the interpolation cycle"),
          Key<S>(
              "program_memory_kbytes", MILLPOSE_AT(memory_kbytes), Integer(100, 10000000),
              "KRL: memory for programs, kB; larger programs are warned of. KRC4 with KSS 8.3: about 4 MB."),
          Key<S>("max_motions", MILLPOSE_AT(max_motions), Integer(10, 1000000),
                 "KRL, SINUMERIK: motions in one program file; larger programs call sub-programs."),
          Key<S>("max_kbytes", MILLPOSE_AT(max_kbytes), Integer(4, 1000000),
                 "KRL, SINUMERIK: size of one program file, kB; larger programs call sub-programs."),
          Key<S>("outputs", MILLPOSE_AT(outputs), ListOf(OutputFields()),
                 "Digital outputs that are switched on the path, without a stop."),
          Key<S>("texts", MILLPOSE_AT(texts), MapOf<std::string>(kTexts, Lines()),
                 "Template lines by event, in place of the built-in ones; {rpm}, {tool}, {pass}, {piece} are "
                 "filled in."),
          Key<S>("calls", MILLPOSE_AT(calls), ListOf(CallFields()),
                 "Programs of the plant that texts may call. What they do to settings counts as unknown.")
              .WhenSet([](const S& s) { return !s.calls.empty(); }),
      },
      [](const Value& value, const Context& context, S& controller) {
        CheckRail(value, context, controller);
        if (controller.axis_names.size() != 6)
          context.Child("axis_names")
              .Add(value.mark, fmt::format("given {} names; allowed: 6", controller.axis_names.size()));
        if (controller.external_axes.size() > 6)
          context.Child("external_axes")
              .Add(value.mark,
                   fmt::format("given {} values; allowed: at most 6", controller.external_axes.size()));
        for (const std::string& name : controller.axis_names) {
          if (!IsWord(name))
            context.Child("axis_names")
                .Add(value.mark, fmt::format("given '{}'; allowed: letters, digits and '_'", name));
        }
      });
}

/// The controllers that know a key; all of them where none names it as its own.
std::vector<std::string> ControllersFor(const std::string& key) {
  std::vector<std::string> controllers;
  for (const PostEntry& entry : Posts().entries()) {
    const std::vector<std::string> keys = entry.make()->Keys();
    if (std::ranges::find(keys, key) != keys.end()) controllers.push_back(entry.name);
  }
  return controllers.empty() ? ControllerNames() : controllers;
}

bool Knows(const std::string& controller, const std::string& key) {
  const std::vector<std::string> controllers = ControllersFor(key);
  return std::ranges::find(controllers, controller) != controllers.end();
}

/// Keys anywhere in a controller's section that this controller cannot follow.
void CheckSupport(const Value& value, const Context& context, const std::string& controller) {
  for (size_t i = 0; i < value.items.size(); ++i) {
    if (value.kind == Value::Kind::kList) CheckSupport(value.items[i], context.Child(i), controller);
    if (value.kind != Value::Kind::kMap) continue;
    const Context child = context.Child(value.keys[i].text);
    if (!Knows(controller, value.keys[i].text))
      child.Add(value.keys[i].mark, fmt::format("{} programs do not know this; allowed for: {}", controller,
                                                fmt::join(ControllersFor(value.keys[i].text), ", ")));
    CheckSupport(value.items[i], child, controller);
  }
}

/// What a program may not take for granted.
void CheckNeeded(const Value& value, const Context& context, const std::string& controller) {
  for (const NeededKey& needed : MakePost(controller)->NeededKeys())
    if (!value.Find(needed.key)) context.Add(value.mark, needed.message);
}

/// Programs are ASCII: what a text puts into them must be so too.
void CheckTexts(const Value& controller, const Context& context) {
  const Value* texts = controller.Find("texts");
  if (!texts) return;
  for (size_t i = 0; i < texts->items.size(); ++i) {
    const std::string& text = texts->items[i].text;
    const auto odd = std::ranges::find_if(text, [](char c) { return c != '\n' && (c < ' ' || c > '~'); });
    if (odd == text.end()) continue;
    context.Child("texts")
        .Child(texts->keys[i].text)
        .Add(texts->items[i].mark, "programs are plain ASCII: letters, digits, blanks and !…~ allowed");
  }
}

/// Where the texts stand, for what only a controller's reader sees.
void NoteTextLines(const Value& controller, ControllerSettings& settings) {
  const Value* texts = controller.Find("texts");
  for (size_t i = 0; texts && i < texts->items.size(); ++i)
    settings.text_lines[texts->keys[i].text] = texts->keys[i].mark.line;
}

}  // namespace

std::vector<std::string> ControllerNames() { return Posts().Names(); }

Codec<std::map<std::string, ControllerSettings>> ControllersFields() {
  auto codec = MapOf<ControllerSettings>(ControllerNames(), ControllerFields());
  codec.read = [read = codec.read](const Value& value, const Context& context,
                                   std::map<std::string, ControllerSettings>& controllers) {
    const size_t problems_before = context.problems.size();
    read(value, context, controllers);
    if (context.problems.size() != problems_before) return;
    for (size_t i = 0; i < value.items.size(); ++i) {
      const Context child = context.Child(value.keys[i].text);
      CheckSupport(value.items[i], child, value.keys[i].text);
      CheckTexts(value.items[i], child);
      NoteTextLines(value.items[i], controllers[value.keys[i].text]);
      CheckNeeded(value.items[i], child, value.keys[i].text);
    }
  };
  // A resolved cell gives no controller a key that it cannot follow.
  codec.write = [write = codec.write](const std::map<std::string, ControllerSettings>& controllers) {
    Value map = write(controllers);
    for (size_t i = 0; i < map.items.size(); ++i) {
      Value kept = Value::Map();
      for (size_t k = 0; k < map.items[i].items.size(); ++k) {
        const std::string& key = map.items[i].keys[k].text;
        if (Knows(map.keys[i].text, key)) kept.Put(key, map.items[i].items[k]);
      }
      map.items[i] = kept;
    }
    return map;
  };
  return codec;
}

}  // namespace millpose::config
