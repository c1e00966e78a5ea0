#pragma once

#include <string>
#include <vector>

#include "io/archive.hpp"
#include "io/hdf5_handle.hpp"

namespace modebank {

/// Reads every stage of an open archive. Without a list the first problem is thrown as DataError; with one all problems
/// are listed, each with its place, and what is returned is incomplete.
Archive read_stages(const hdf5::Handle& file, std::vector<std::string>* problems);

}  // namespace modebank
