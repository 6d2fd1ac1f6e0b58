// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "tests/audit/folder.hpp"

namespace millpose::audit {

struct Options {
  double travel_mm = 0.2;  ///< of any point of arm and tool between poses that are looked at for interference
  int threads = 1;
};

/// One law: its worst value and what it may be at most.
struct Figure {
  std::string name;
  double value;
  double bound;
  std::string where;  ///< of the worst value
};

struct Verdict {
  std::vector<Figure> figures;
  long long poses_checked = 0;          ///< for interference
  long long objectives_recomputed = 0;  ///< other than chen2021's, which counts as an index
  long long bends_excused = 0;  ///< steps beyond the bound half-way whose points lie too far apart for it

  bool Holds() const;
  /// The figure of that name; throws std::out_of_range when there is none.
  const Figure& operator[](const std::string& name) const;
};

/// Every law, recomputed from what the folder says.
Verdict Audit(const Folder& folder, const Options& options);

/// One figure a key, `poses_checked`, `bounds`, and `broken` (names out of bound, with the place); ends with
/// a line feed.
std::string ToJson(const Verdict& verdict);

}  // namespace millpose::audit
