#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "io/table/table_reader.hpp"

namespace modebank {

/// Runs that are in memory, by name: of each the table of its inputs and, where states have times of their own, that of
/// its states. What import_data takes in place of files.
using MemoryTables = std::map<std::string, std::vector<std::shared_ptr<const TableReader>>>;

/// What data.inputs and data.states say of them: a recording of such runs cannot be read again.
inline constexpr const char* frames_in_memory = "<frames>";

}  // namespace modebank
