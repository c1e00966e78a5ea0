#pragma once

#include <hdf5.h>

#include <cstddef>
#include <optional>

namespace modebank::hdf5 {

/// Reads bytes of an open file into `to`. Returns how many there were, fewer at the file's end; none where the system
/// refuses (errno says why).
std::optional<std::size_t> read_at(int descriptor, haddr_t at, std::size_t count, char* to);

}  // namespace modebank::hdf5
