#pragma once

#include <hdf5.h>

namespace modebank::hdf5 {

/// How files that others wrote are read: HDF5's own ways to a file gather metadata in a buffer, and HDF5 1.10 copies
/// from far outside of that where a damaged file has an address near the largest number. This one reads what is asked
/// for, if it lies in the file. A driver for H5Pset_driver; negative where HDF5 takes none.
hid_t read_driver();

}  // namespace modebank::hdf5
