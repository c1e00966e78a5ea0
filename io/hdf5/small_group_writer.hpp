#pragma once

#include <utility>

#include "io/hdf5/file_driver.hpp"
#include "io/hdf5/handle.hpp"
#include "io/hdf5/small_group.hpp"

namespace modebank::hdf5 {

/// The file of an open object if others than HDF5 can append to it; without a handle where they cannot.
OpenedFile appendable_file(hid_t object);

/// A group of small arrays in the making: what read_small_group reads. HDF5 takes sixteen microseconds to make an
/// array; this one lays out the group and its arrays as the file format has them and appends them in one piece.
class NewSmallGroup {
 public:
  /// `file_type`: of numbers, in the file; its bytes are those of memory.
  void add_attribute(const std::string& name, hid_t file_type, const void* value);
  void add_attribute(const std::string& name, const std::string& text);
  void add_array(const std::string& name, hid_t file_type, const std::vector<hsize_t>& shape, const void* values);
  /// Of the last array.
  void add_unit(const std::vector<std::string>& texts, const std::vector<hsize_t>& shape);

  /// Makes the group as a member of `parent`, which is in `file`.
  void write(const OpenedFile& file, hid_t parent, const std::string& name) const;

 private:
  struct Named {
    std::string name;
    SmallArray array;
    std::vector<SmallArray> unit = {};  ///< one or none
  };
  std::vector<Named> attributes_, arrays_;

  bool fits() const;
  std::string block(haddr_t address, std::size_t& group_begins) const;
  void write_by_hdf5(hid_t parent, const std::string& name) const;
};

/// A group without time stamps that has up to 32 members in its own header, with UTF-8 names.
Handle make_group(hid_t parent, const std::string& name);

}  // namespace modebank::hdf5
