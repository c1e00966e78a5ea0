#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "app/export/exported_bank.hpp"
#include "app/text/robot_numbers.hpp"
#include "io/archive/inspect.hpp"

/// One function per form of `modebank export`. docs/reference/export.md describes each form.
namespace modebank::app {

/// Version of the JSON form. New members increase the minor number; other changes increase the major number.
inline constexpr const char* export_schema_version = "3.0";

std::string to_json(const ExportedBank& bank);

/// Version of the regimes form. It increases by the same rule as export_schema_version.
inline constexpr const char* regimes_schema_version = "1.1";

/// Numbers for a filter with its own motion model: Q and R of the measured states, transitions and gates.
std::string to_regimes(const ExportedBank& bank);

/// Writes a MATLAB MAT-file of version 5 to `file`. If the file exists, it is replaced as in replace_file.
void write_mat(const ExportedBank& bank, const std::filesystem::path& file);

/// C99 header and source. `stem`: file name without extension; the identifiers begin with it.
struct CFiles {
  std::string header, source;
};
/// Throws DataError if the C code does not support a part of the filter. The message names this part.
CFiles to_c(const ExportedBank& bank, const std::string& stem);

/// A Python module that needs only casadi.
std::string to_casadi(const ExportedBank& bank);

/// Parameter files for ROS 2, one per family of modes. Returns their names and texts.
std::vector<std::pair<std::string, std::string>> to_ros2(const ExportedBank& bank, const RobotSizes& sizes);

/// A table or array of an archive as CSV, from the JSON of `inspect`. Throws ConfigurationError for other objects.
/// `path`: the object's path, for error messages.
std::string to_csv(const nlohmann::json& object, const std::string& path);

}  // namespace modebank::app
