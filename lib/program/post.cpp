// SPDX-License-Identifier: GPL-3.0-or-later
#include "program/post_entry.hpp"

namespace millpose {
/// Defined in the controllers' own files.
PostEntry KrlEntry(), SinumerikEntry(), LinuxCncEntry();
PostEntry UrScriptEntry();
PostEntry FanucEntry();
PostEntry RapidEntry();

Registry<PostEntry>& Posts() {
  static Registry<PostEntry> posts{"controller",
                                   {KrlEntry(), SinumerikEntry(), LinuxCncEntry(),  //
                                    UrScriptEntry(),                                //
                                    FanucEntry(),                                   //
                                    RapidEntry()}};
  return posts;
}

std::unique_ptr<Post> MakePost(const std::string& name) { return Posts().At(name).make(); }

double Post::Blend(const PathTolerance&, double chord) const {
  constexpr double kLargestRounding = 0.01;  // mm, of a control's tolerance
  return std::min(chord, kLargestRounding);
}

PathDynamics Post::Dynamics(const PostOptions& options) const {
  PathDynamics dynamics;
  dynamics.cycle = options.cycle.value_or(UsualCycle());
  dynamics.block_time = options.block_time.value_or(dynamics.cycle);
  if (options.path_acceleration) dynamics.acceleration = *options.path_acceleration;
  return dynamics;
}

std::vector<std::pair<std::string, std::string>> Post::BeforeFirstRun(const PostSettings& settings) const {
  return {{"texts", TextsToTry(settings)}};
}

std::string TextsToTry(const PostSettings& settings) {
  if (settings.texts.empty())
    return "the cell gives none: the programs' own switch the spindle and ask for tools";
  std::vector<std::string> names;
  for (const auto& [name, text] : settings.texts) names.push_back(name);
  return fmt::format("try by hand what the cell's texts switch, call and wait for: {}",
                     fmt::join(names, ", "));
}

FrameTexts Post::Frames(const PostSettings& settings) const {
  return {settings.tool_name + " in the flange", "workpiece in the robot base", {}};
}

}  // namespace millpose
