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

/// Of the JSON page; its minor part grows with members, its major part with changes of what there is.
inline constexpr const char* export_schema_version = "2.1";

std::string to_json(const ExportedBank& bank);

/// Version of the regimes' page, counted like export_schema_version.
inline constexpr const char* regimes_schema_version = "1.1";

/// Q and R of the measured states, transitions and gates, for a filter with its own motion model.
std::string to_regimes(const ExportedBank& bank);

/// MATLAB's MAT-file of version 5, written under this name as replace_file does.
void write_mat(const ExportedBank& bank, const std::filesystem::path& file);

/// C99 header and source. `stem`: stem of the file names, with which identifiers begin.
struct CFiles {
  std::string header, source;
};
/// Throws DataError, naming the part, for a filter that the C code lacks a part of.
CFiles to_c(const ExportedBank& bank, const std::string& stem);

/// A Python module that imports casadi alone.
std::string to_casadi(const ExportedBank& bank);

/// Parameter files of ROS 2, one per family of modes: name and text.
std::vector<std::pair<std::string, std::string>> to_ros2(const ExportedBank& bank, const RobotSizes& sizes);

/// A table or array of an archive, from the JSON of inspect. Throws ConfigurationError for other objects. `path`: for
/// messages.
std::string to_csv(const nlohmann::json& object, const std::string& path);

}  // namespace modebank::app
