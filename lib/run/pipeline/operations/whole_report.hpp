// SPDX-License-Identifier: GPL-3.0-or-later
// What the output folder of a job with several operations says of all of them.
#pragma once

#include "report/words/words.hpp"
#include "run/pipeline/operations/whole_program.hpp"

namespace millpose {

/// summary.json: the figures that batches compare, over all operations, and each operation's own summary.
std::string WholeSummary(const std::string& job, const std::vector<DoneOperation>& operations,
                         const std::vector<WholeProgram>& programs);

/// points.csv: the rows of all operations with a last column `operation`; columns that one has not are empty.
std::string WholePoints(const std::vector<DoneOperation>& operations);

/// report.html: a table of the operations, and the report of each behind a tab. Loads the operations'
/// reports.
std::string WholeReport(const std::string& job, const std::vector<DoneOperation>& operations,
                        const std::vector<WholeProgram>& programs, Language language);

/// What `plan` prints: twelve lines at most, each of which Say() can say.
std::string WholeBrief(const std::string& job, const std::vector<DoneOperation>& operations,
                       const std::vector<WholeProgram>& programs, const std::filesystem::path& out);

/// The same with all operations and findings, for `plan -v`.
std::string WholeText(const std::vector<DoneOperation>& operations, const std::vector<WholeProgram>& programs,
                      const std::filesystem::path& out);

}  // namespace millpose
