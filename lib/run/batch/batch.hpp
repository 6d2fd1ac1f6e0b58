// SPDX-License-Identifier: GPL-3.0-or-later
// Many jobs: each in a process of its own, so that one that fails, crashes or runs out of memory stops no
// other.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "base/file_root.hpp"
#include "base/progress.hpp"
#include "job/config/batch_settings.hpp"
#include "report/words/words.hpp"

namespace millpose {

/// How a batch uses Slurm.
struct SlurmOptions {
  int shares = 1;                   ///< tasks over which the passes of a job are spread
  bool detach = false;              ///< submit and end; the same command later gathers
  std::vector<std::string> sbatch;  ///< further options of sbatch
};

/// What `millpose batch` was asked for.
struct BatchArguments {
  std::vector<std::string> jobs;  ///< job files, manifests, folders, glob patterns
  std::filesystem::path out = "batch.out";
  int threads = 0;                    ///< of all jobs together, 0: all cores; with Slurm of a task, 0: one
  int parallel = 0;                   ///< jobs at a time; 0: as many as there are threads
  double memory_MB = 0;               ///< of all jobs together; 0: no bound
  bool fresh = false;                 ///< ignore checkpoints and what is done
  std::optional<SlurmOptions> slurm;  ///< plan on a cluster
  double max_points = 2e6;            ///< that the tool path of a job may have
  std::filesystem::path baseline;     ///< folder of an earlier batch whose plans these are compared with
  FileRoot root;                      ///< that all files must lie in which jobs and manifests name
  Language language = Language::kEnglish;  ///< of the index and of each job's pages
  /// Told the jobs that run whenever they change, one call at a time; not with Slurm.
  std::function<void(const std::string& names)> tell_running;
  /// Given what says how long the jobs will still take, s (TimeLeft), and at the end an empty one; not with
  /// Slurm.
  std::function<void(std::function<std::optional<double>()> left)> tell_left;
};

/// One job of a batch.
struct BatchJob {
  std::string name;  ///< unique in the batch; its folder's name
  std::filesystem::path file;
  std::vector<Override> overrides;
  int shares = 0;   ///< tasks over which its passes are spread; 0: SlurmOptions::shares
  FileRoot root{};  ///< that all its files must lie in
  double max_points = 2e6;
  Language language = Language::kEnglish;  ///< of its pages
};

/// What the summary of a finished plan says, for comparing jobs; empty where it has no value.
struct JobFigures {
  std::string objective, objective_unit;
  std::optional<double> objective_median, objective_worst;
  std::optional<double> lambda_t1_worst, lambda_t2_worst, lambda_n_worst;  ///< mm/N
  std::optional<double> clearance_min;                                     ///< mm
  std::optional<double> deflection_level, deflection_variation;            ///< mm
  std::optional<double> cycle_s;                                           ///< the longest of the programs'
  bool report = false;                                                     ///< whether report.html is there
};

/// How one job ended.
struct JobOutcome {
  int status = 0;                     ///< exit status of `millpose plan`
  bool up_to_date = false;            ///< done by an earlier run with the same inputs
  std::string cause;                  ///< lines, empty when all is well
  std::vector<std::string> findings;  ///< of a plan that is not complete: which points, gaps, programs
  /// Of programs: confirmed but for a stated gap. And what differs from the baseline.
  std::vector<std::string> remarks;
  std::optional<size_t> points, planned;
  std::optional<JobFigures> figures;
  double wall_s = 0, peak_memory_MB = 0;
};

struct BatchOutcome {
  int exit_status = 0;  ///< the worst of all jobs
  std::string text;     ///< the table for the user
};

/// The jobs that the arguments name, in their order, those of a folder sorted by path; output folders are
/// left out. Throws InputError for arguments that name no job, manifests that cannot be read, names given
/// twice, files outside of `root`. A manifest with `untrusted: true` bounds its own jobs by its folder; one
/// in a folder that is given, all jobs of that folder.
std::vector<BatchJob> CollectJobs(const std::vector<std::string>& arguments, const FileRoot& root);

/// Plans all jobs, each into `out`/<name>, and writes index.html, batch.csv, batch.json and junit.xml into
/// `out`. Throws InputError when there is nothing to start with, Interrupted when `stop` was requested; jobs
/// keep their checkpoints.
BatchOutcome RunBatch(const BatchArguments& arguments, Progress& progress, std::stop_token stop);

/// The command that plans one job into `folder`.
std::vector<std::string> PlanCommand(const BatchJob& job, const std::filesystem::path& folder, int threads,
                                     bool fresh);

/// How a job stands by its folder's files, given how its process ended.
JobOutcome Judge(const std::filesystem::path& folder, int status, const std::string& errors);

/// The lines of a job's cause; one about a key that its manifest sets names the manifest's place.
std::string AtManifest(const std::string& cause, const BatchJob& job);

/// The outcome that an earlier run left for the same inputs and version, if it did.
std::optional<JobOutcome> UpToDate(const BatchJob& job, const std::filesystem::path& folder);

/// batch.json, batch.csv, index.html (in a language), junit.xml and the table; pure functions.
std::string BatchJson(const std::vector<BatchJob>& jobs, const std::vector<JobOutcome>& outcomes);
std::string BatchCsv(const std::vector<BatchJob>& jobs, const std::vector<JobOutcome>& outcomes);
std::string BatchIndex(const std::vector<BatchJob>& jobs, const std::vector<JobOutcome>& outcomes,
                       Language language = Language::kEnglish);
std::string JUnitXml(const std::vector<BatchJob>& jobs, const std::vector<JobOutcome>& outcomes);
std::string BatchText(const std::vector<BatchJob>& jobs, const std::vector<JobOutcome>& outcomes);

}  // namespace millpose
