// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "report/html.hpp"

namespace millpose {

/// The data of report.html as JSON that may stand inside a <script> element: no `<`, valid UTF-8, numbers in
/// bulk as base64 (packed.hpp). The keys are those that web/data.js reads.
std::string ReportJson(const HtmlInput& input, const HtmlLimits& limits);

}  // namespace millpose
