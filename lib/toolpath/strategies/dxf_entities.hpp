// SPDX-License-Identifier: GPL-3.0-or-later
// The text of a DXF as entities: a code and a value, each on a line of its own.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace millpose {

struct DxfPair {
  int code = 0;
  std::string_view value;
  int line = 0;  ///< of the value
};

/// What stands from one code 0 to the next.
struct DxfEntity {
  std::string_view kind;
  int line = 0;
  std::vector<DxfPair> pairs;

  /// The first value of a code; empty where there is none.
  std::string_view Text(int code) const;
};

struct DxfFile {
  std::vector<DxfEntity> entities;  ///< of the section ENTITIES
  std::optional<DxfPair> unit;      ///< $INSUNITS
};

/// Views into `bytes`. Throws InputError, with the line, for what is no whole text DXF.
DxfFile ReadDxfFile(std::string_view bytes, const std::string& name);

}  // namespace millpose
