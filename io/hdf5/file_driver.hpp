#pragma once

#include <hdf5.h>

#include <string_view>

#include "io/hdf5/handle.hpp"

namespace modebank::hdf5 {

/// How archives are read and made, a driver for H5Pset_driver; negative where HDF5 takes none. Files that others wrote:
/// HDF5's own ways to a file gather metadata in a buffer, and HDF5 1.10 copies from far outside of that where a damaged
/// file has an address near the largest number. This one reads what is asked for, if it lies in the file, and
/// judges object headers before HDF5 decodes them (header_guard.hpp). Files in the making: others than HDF5 may append
/// to them, too.
hid_t file_driver(FileOf of = FileOf::anybody);

/// A file that the driver has open; `handle` is what H5Fget_vfd_handle says.
struct OpenedFile {
  void* handle = nullptr;  ///< none where another driver has the file
  haddr_t before = 0;      ///< bytes that precede HDF5's own addresses
};
/// That of an open object.
OpenedFile opened_file(hid_t object);
int descriptor_of(void* handle);
bool is_in_the_making(void* handle);
/// Where the next bytes will be appended, from the file's first byte on.
haddr_t end_of(void* handle);
/// Appends bytes to a file in the making, which HDF5 then leaves alone. Throws DataError.
void append(void* handle, std::string_view bytes);

}  // namespace modebank::hdf5
