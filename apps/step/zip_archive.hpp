// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <zip.h>

#include <string>
#include <string_view>

namespace millpose {

/// A zip archive in memory.
class ZipArchive {
 public:
  /// `bytes` outlive the archive. Throws std::runtime_error with one sentence.
  explicit ZipArchive(std::string_view bytes);
  ZipArchive(const ZipArchive&) = delete;
  ZipArchive& operator=(const ZipArchive&) = delete;
  ~ZipArchive();

  /// The file of that name. Throws std::runtime_error where there is none and where it is damaged.
  std::string Read(const std::string& name) const;

 private:
  zip_t* archive_;
};

}  // namespace millpose
