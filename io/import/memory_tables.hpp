#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "io/table/table_reader.hpp"

namespace modebank {

/// Runs in memory, by name, which import_data reads in place of files. Each has a table of inputs and, where states
/// have their own times, one of states.
using MemoryTables = std::map<std::string, std::vector<std::shared_ptr<const TableReader>>>;

/// Value of data.inputs and data.states for such runs, which cannot be read a second time.
inline constexpr const char* frames_in_memory = "<frames>";

}  // namespace modebank
