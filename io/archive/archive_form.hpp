#pragma once

#include <filesystem>

#include "io/files/output_file.hpp"

namespace modebank {

/// An archive as check_output recognises one, whole or damaged: by the hash or HDF5's signature behind it. A study's
/// table is none.
FileForm archive_form();

/// Whether a file is a study's table or plan. One that cannot be read is neither.
bool is_table_of_runs(const std::filesystem::path& path);

}  // namespace modebank
