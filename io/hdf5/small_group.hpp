#pragma once

#include <map>
#include <optional>
#include <string>

#include "io/hdf5/object_header.hpp"

namespace modebank::hdf5 {

/// Numbers or texts that lie in an object's header.
struct SmallArray {
  H5T_class_t type_class = H5T_NO_CLASS;  ///< H5T_FLOAT, H5T_INTEGER or H5T_STRING
  hid_t type = H5I_INVALID_HID;           ///< of numbers, one of HDF5's own, which nobody closes
  std::size_t element_bytes = 0;
  std::vector<hsize_t> shape;  ///< empty: a scalar
  std::string bytes;

  hsize_t elements() const { return element_bytes > 0 ? bytes.size() / element_bytes : 0; }
};

/// A group of small arrays alone, as the groups of runs are of which an archive may have a hundred thousand. HDF5 takes
/// twenty microseconds for an array, this one or two.
struct SmallGroup {
  std::map<std::string, SmallArray> arrays, attributes;
};

/// The group at an address. Nothing where anything in it is not of the kind that a small group of ours has, or is not
/// as it should be: HDF5 then reads it, and says what is wrong.
std::optional<SmallGroup> read_small_group(FileBytes& file, haddr_t address);

}  // namespace modebank::hdf5
