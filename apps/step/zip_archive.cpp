// SPDX-License-Identifier: GPL-3.0-or-later
#include "zip_archive.hpp"

#include <fmt/format.h>

#include <array>
#include <stdexcept>

namespace millpose {

ZipArchive::ZipArchive(std::string_view bytes) {
  zip_error_t error;
  zip_error_init(&error);
  zip_source_t* source = zip_source_buffer_create(bytes.data(), bytes.size(), 0, &error);
  archive_ = source ? zip_open_from_source(source, ZIP_RDONLY | ZIP_CHECKCONS, &error) : nullptr;
  const std::string what = archive_ ? "" : zip_error_strerror(&error);
  zip_error_fini(&error);
  if (archive_) return;
  zip_source_free(source);
  throw std::runtime_error("the 3MF file is no sound zip archive: " + what);
}

ZipArchive::~ZipArchive() { zip_discard(archive_); }

std::string ZipArchive::Read(const std::string& name) const {
  zip_file_t* file = zip_fopen(archive_, name.c_str(), ZIP_FL_NOCASE);
  if (!file)
    throw std::runtime_error(fmt::format("the 3MF file holds no {}: {}", name, zip_strerror(archive_)));
  // Piece by piece: what the archive says of the size may be wrong.
  std::string bytes;
  std::array<char, 65536> piece;
  zip_int64_t count;
  while ((count = zip_fread(file, piece.data(), piece.size())) > 0)
    bytes.append(piece.data(), static_cast<size_t>(count));
  const std::string what = count < 0 ? zip_file_strerror(file) : "";
  zip_fclose(file);
  if (count < 0) throw std::runtime_error(fmt::format("{} of the 3MF file is damaged: {}", name, what));
  return bytes;
}

}  // namespace millpose
