#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "app/export/exported_bank.hpp"
#include "app/text/robot_numbers.hpp"
#include "io/archive/inspect.hpp"

/// One function per form of `modebank export`; docs/reference/export.md has their schemas.
namespace modebank::app {

/// Version of the JSON page. New members increase the minor part; other changes increase the major part.
inline constexpr const char* export_schema_version = "2.1";

std::string to_json(const ExportedBank& bank);

/// Version of the regimes page, with the same rule as export_schema_version.
inline constexpr const char* regimes_schema_version = "1.1";

/// Q and R of the measured states, transitions and gates, for a filter with a motion model of its own.
std::string to_regimes(const ExportedBank& bank);

/// Writes a MATLAB MAT-file of version 5 to `file`. Replaces an existing file in the way of replace_file.
void write_mat(const ExportedBank& bank, const std::filesystem::path& file);

/// C99 header and source. `stem`: stem of the file names and first part of the identifiers.
struct CFiles {
  std::string header, source;
};
/// Throws DataError with the name of the part if the C code does not support a part of the filter.
CFiles to_c(const ExportedBank& bank, const std::string& stem);

/// A Python module that needs only casadi.
std::string to_casadi(const ExportedBank& bank);

/// Parameter files of ROS 2, one per family of modes: name and text.
std::vector<std::pair<std::string, std::string>> to_ros2(const ExportedBank& bank, const RobotSizes& sizes);

/// A table or array of an archive as CSV, from the JSON of inspect. Throws ConfigurationError for other objects.
/// `path`: for error messages.
std::string to_csv(const nlohmann::json& object, const std::string& path);

}  // namespace modebank::app
