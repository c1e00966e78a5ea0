#pragma once

#include <filesystem>

#include "io/files/output_file.hpp"

namespace modebank {

/// Tells check_output how to recognise a complete or damaged archive: by its hash, or by HDF5's signature after the
/// hash. A study's table is not an archive.
FileForm archive_form();

/// Whether a file is a study's table or plan. False for an unreadable file.
bool is_table_of_runs(const std::filesystem::path& path);

}  // namespace modebank
