#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "io/table/table_reader.hpp"

namespace modebank {

/// Runs in memory, by name. import_data reads these instead of files. Each run has a table of inputs. If its states
/// have their own times, it also has a table of states.
using MemoryTables = std::map<std::string, std::vector<std::shared_ptr<const TableReader>>>;

/// Value of data.inputs and data.states for runs in memory. Such runs cannot be read a second time.
inline constexpr const char* frames_in_memory = "<frames>";

}  // namespace modebank
