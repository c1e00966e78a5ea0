#pragma once

#include <cstddef>
#include <cstdint>

namespace modebank::hdf5 {

/// The checksum of HDF5's metadata: Bob Jenkins' lookup3 (public domain, 2006), bytes taken one by one, with start 0.
std::uint32_t lookup3(const unsigned char* bytes, std::size_t count);

}  // namespace modebank::hdf5
