// SPDX-License-Identifier: GPL-3.0-or-later
// The text of a first cell, with a comment at everything that nobody but its plant can know.
#pragma once

#include <filesystem>
#include <string>

namespace millpose {

/// A file's name as YAML, relative to `folder` where the two have more in common than the root.
std::string YamlPath(const std::filesystem::path& file, const std::filesystem::path& folder);

/// The sample cell of this name. Throws InputError for a name that none has.
std::string SampleCellText(const std::string& name);

struct UrdfChoice {
  std::filesystem::path file;          ///< absolute
  std::string base_link, flange_link;  ///< empty: what suits
  std::optional<double> tolerance;     ///< mm, between its joints and the closed form
};

/// A cell whose arm is a URDF's, for a file in `folder` (absolute). Throws InputError for a URDF without a
/// closed form, and where several links could be base or flange.
std::string UrdfCellText(const UrdfChoice& urdf, const std::filesystem::path& folder);

}  // namespace millpose
