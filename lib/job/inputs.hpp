// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "base/file_root.hpp"
#include "job/config/config.hpp"
#include "toolpath/stock/swept_cutter.hpp"

namespace millpose {

/// Everything that a job names, read into memory: from here on nothing else is opened for reading.
struct JobInputs {
  std::filesystem::path job_file;
  std::filesystem::path folder;          ///< what the paths inside the job are relative to
  std::string job_text;                  ///< of the job file, for the places of later errors
  std::optional<size_t> operation = {};  ///< which one of the file's, where it has several
  JobSettings job;
  CellSettings cell;
  std::string workpiece_bytes;  ///< of the workpiece's mesh file
  std::string stock_bytes;      ///< of the stock's, where there is one
  std::string force_bytes;      ///< of the measured forces, where there are some
  std::string map_bytes;        ///< of the map of a measured part's error, where there is one
  std::string path_bytes;       ///< of the file that the strategy takes its path from
  std::map<std::string, std::string>
      body_bytes;  ///< of the mesh files that the cell's bodies name, by that name
  std::map<std::string, std::string> fixture_bytes{};  ///< likewise of workpiece.fixtures
  std::map<std::string, std::string>
      keep_out_bytes{};  ///< likewise of placement.keep_out; no plan needs them
  std::map<std::string, std::string>
      step_meshes{};  ///< STEP files that became triangles: hash of these by their key (step_meshes.hpp)
  std::string hash;   ///< of all of it, resolved
  double max_points = 2e6;                  ///< that the tool path may have
  std::vector<CutsOfTool> cut_before = {};  ///< of the raw part, by the operations before this one
  std::optional<double> trajectory = {};    ///< s between rows of where the arm is; none by default
};

/// Reads a job, its cell and their meshes; paths inside a file are relative to that file. Throws InputError
/// with the problems of job and cell together. `overrides` replace settings of the job file.
/// The resolved job.yaml of an output folder keeps the paths of the job that was planned; they count from
/// that job's folder, or from `folder` when it is given. Nothing outside of `root` is opened.
/// `operation`: which one, of a job with several.
JobInputs LoadJobInputs(const std::filesystem::path& job_file, const std::vector<Override>& overrides = {},
                        const std::optional<std::filesystem::path>& folder = {}, const FileRoot& root = {},
                        std::optional<size_t> operation = {});

/// The resolved job as a plan depends on it: without what only `millpose place` reads.
std::string PlannedJobText(JobSettings job);

/// The hash of all inputs as they stand.
std::string HashOf(const JobInputs& inputs);

/// What every output has to say of a cell: links that nothing sees touch.
std::vector<std::string> CellWarnings(const CellSettings& cell);

/// Reads a cell, with what a URDF that it names says in its place, and the meshes of its bodies. Throws
/// InputError, also for a link without a body that the cell does not name in `interference.unchecked_links`.
/// The first of several tools counts as the cell's.
/// `base`: where the robot's base stands in place of what the file says.
CellSettings LoadCell(const std::filesystem::path& cell_file, std::map<std::string, std::string>* body_bytes,
                      const FileRoot& root = {}, const std::optional<PoseSettings>& base = {});

}  // namespace millpose
