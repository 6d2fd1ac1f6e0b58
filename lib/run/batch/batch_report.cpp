// SPDX-License-Identifier: GPL-3.0-or-later
#include <nlohmann/json.hpp>

#include "base/text.hpp"
#include "report/page/escaped.hpp"
#include "run/batch/batch.hpp"

namespace millpose {
namespace {

using Json = nlohmann::ordered_json;

const char* StatusName(const JobOutcome& outcome) {
  if (outcome.up_to_date) return outcome.status == 0 ? "up to date" : "findings";
  switch (outcome.status) {
    case 0:
      return "done";
    case 1:
      return "findings";
    case 2:
      return "bad input";
    default:
      return "failed";
  }
}

size_t CountStatus(const std::vector<JobOutcome>& outcomes, int lower, int upper) {
  return static_cast<size_t>(std::ranges::count_if(outcomes, [&](const JobOutcome& outcome) {
    return outcome.status >= lower && outcome.status <= upper;
  }));
}

std::string FirstLine(const std::string& text) {
  const auto more = std::ranges::count(text, '\n');
  std::string line = text.substr(0, text.find('\n'));
  if (more > 0) line += fmt::format(" (and {} more line{})", more, more > 1 ? "s" : "");
  return line;
}

constexpr int kWorst = 255;

Json FiguresJson(const std::optional<JobFigures>& figures) {
  if (!figures) return {};
  const auto number = [](const std::optional<double>& value) { return value ? Json(*value) : Json(); };
  return {{"objective", figures->objective},
          {"objective_unit", figures->objective_unit},
          {"objective_median", number(figures->objective_median)},
          {"objective_worst", number(figures->objective_worst)},
          {"lambda_t1_worst_mm_N", number(figures->lambda_t1_worst)},
          {"lambda_t2_worst_mm_N", number(figures->lambda_t2_worst)},
          {"lambda_n_worst_mm_N", number(figures->lambda_n_worst)},
          {"clearance_min_mm", number(figures->clearance_min)},
          {"deflection_level_mm", number(figures->deflection_level)},
          {"deflection_variation_mm", number(figures->deflection_variation)},
          {"cycle_s", number(figures->cycle_s)}};
}

// How the element of a job that is done ends.
std::string RemarksXml(const JobOutcome& outcome) {
  if (outcome.remarks.empty()) return "/>\n";
  return fmt::format("><system-out>{}</system-out></testcase>\n",
                     Escaped(fmt::format("{}", fmt::join(outcome.remarks, "\n"))));
}

// What a line of the table says behind its figures.
std::string Told(const JobOutcome& outcome) {
  if (!outcome.cause.empty() || outcome.remarks.empty()) return FirstLine(outcome.cause);
  if (outcome.remarks.size() > 2)
    return fmt::format("{}; {} more remarks", outcome.remarks.front(), outcome.remarks.size() - 1);
  return fmt::format("{}", fmt::join(outcome.remarks, "; "));
}

std::string Count(const std::optional<size_t>& count) { return count ? std::to_string(*count) : "–"; }

}  // namespace

std::string BatchJson(const std::vector<BatchJob>& jobs, const std::vector<JobOutcome>& outcomes) {
  Json json;
  json["schema_version"] = 1;
  json["total"] = jobs.size();
  json["done"] = CountStatus(outcomes, 0, 0);
  json["findings"] = CountStatus(outcomes, 1, 1);
  json["failed"] = CountStatus(outcomes, 2, kWorst);
  json["jobs"] = Json::array();
  for (size_t i = 0; i < jobs.size(); ++i) {
    const JobOutcome& outcome = outcomes[i];
    const auto count = [](const std::optional<size_t>& value) { return value ? Json(*value) : Json(); };
    json["jobs"].push_back({{"name", jobs[i].name},
                            {"job", jobs[i].file.string()},
                            {"folder", jobs[i].name},
                            {"status", outcome.status},
                            {"outcome", StatusName(outcome)},
                            {"up_to_date", outcome.up_to_date},
                            {"cause", outcome.cause.empty() ? Json() : Json(outcome.cause)},
                            {"findings", outcome.findings},
                            {"remarks", outcome.remarks},
                            {"points", count(outcome.points)},
                            {"planned", count(outcome.planned)},
                            {"figures", FiguresJson(outcome.figures)},
                            {"wall_s", outcome.wall_s},
                            {"peak_memory_MB", outcome.peak_memory_MB}});
  }
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string JUnitXml(const std::vector<BatchJob>& jobs, const std::vector<JobOutcome>& outcomes) {
  double time = 0;
  for (const JobOutcome& outcome : outcomes) time += outcome.wall_s;
  std::string xml = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n";
  xml += fmt::format(
      "<testsuite name=\"millpose batch\" tests=\"{}\" failures=\"{}\" errors=\"{}\" time=\"{:.3f}\">\n",
      jobs.size(), CountStatus(outcomes, 1, 1), CountStatus(outcomes, 2, kWorst), time);
  for (size_t i = 0; i < jobs.size(); ++i) {
    const JobOutcome& outcome = outcomes[i];
    xml += fmt::format("  <testcase classname=\"millpose.plan\" name=\"{}\" time=\"{:.3f}\"",
                       Escaped(jobs[i].name), outcome.wall_s);
    if (outcome.status == 0) {
      xml += RemarksXml(outcome);
      continue;
    }
    std::string message = FirstLine(outcome.cause), text = outcome.cause;
    if (!outcome.findings.empty()) message += ": " + outcome.findings.front();
    for (const std::string& finding : outcome.findings) text += '\n' + finding;
    xml += fmt::format("><{0} message=\"{1}\">{2}</{0}></testcase>\n",
                       outcome.status == 1 ? "failure" : "error", Escaped(message), Escaped(text));
  }
  return xml + "</testsuite>\n";
}

std::string BatchText(const std::vector<BatchJob>& jobs, const std::vector<JobOutcome>& outcomes) {
  size_t width = 4;
  for (const BatchJob& job : jobs) width = std::max(width, job.name.size());
  std::string text = fmt::format("{:<{}}  {:<10} {:>8} {:>8} {:>9} {:>9}  {}\n", "job", width, "outcome",
                                 "points", "planned", "wall_s", "peak_MB", "cause");
  for (size_t i = 0; i < jobs.size(); ++i) {
    const JobOutcome& outcome = outcomes[i];
    text += fmt::format("{:<{}}  {:<10} {:>8} {:>8} {:>9.1f} {:>9.0f}  {}\n", jobs[i].name, width,
                        StatusName(outcome), Count(outcome.points), Count(outcome.planned), outcome.wall_s,
                        outcome.peak_memory_MB, Told(outcome));
  }
  text +=
      fmt::format("{} jobs: {} done, {} with findings, {} failed\n", jobs.size(), CountStatus(outcomes, 0, 0),
                  CountStatus(outcomes, 1, 1), CountStatus(outcomes, 2, kWorst));
  return text;
}

}  // namespace millpose
