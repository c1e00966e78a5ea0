#pragma once

#include <string>
#include <vector>

#include "io/hdf5/array.hpp"

/// What logs in HDF5 are made of: types, attributes and lines of datasets that others wrote.
namespace modebank {

haddr_t hdf5_address(hid_t object);
std::string hdf5_path(hid_t object);
/// A text of fixed length; empty when there is no such attribute, or it is something else.
std::string hdf5_text_attribute(hid_t object, const std::string& name);
/// Of the attributes units, unit or Units.
std::string hdf5_unit(hid_t object);
hdf5::Shape hdf5_shape(hid_t dataset);

/// Whether values convert to numbers: integers, floats, enumerations (h5py's booleans) and bits.
bool hdf5_is_number(hid_t type);
/// Bits, 64 at most: PyTables and pandas store truth values so.
bool hdf5_is_bits(hid_t type);
bool hdf5_is_whole(hid_t type);
bool hdf5_is_text(hid_t type);
/// double, float32, int16, uint8, bits8, text, ...
std::string hdf5_type_name(hid_t type);
std::string hdf5_member_name(hid_t compound, unsigned member);
hsize_t hdf5_array_elements(hid_t array_type);

/// Throws DataError for a dataset whose values lie outside the file, that declares more than its stored bytes can
/// unpack to, or that needs a filter that HDF5 does not bring. Unpacks what is compressed: once for a dataset is
/// enough.
void hdf5_check_readable(hid_t dataset);

/// Texts of a list that Python pickled in its oldest, plain form (protocol 0), as PyTables does; empty for any other
/// content: nothing is executed.
std::vector<std::string> pickled_names(const std::string& pickle);

/// One line of a dataset of one or two dimensions.
template <class T>
std::vector<T> hdf5_read_line(hid_t dataset, hsize_t along, hsize_t line, hid_t memory, std::size_t rows) {
  std::vector<T> values(rows);
  const hdf5::Handle space(H5Dget_space(dataset), H5Sclose, "read a shape");
  const hdf5::Shape shape = hdf5_shape(dataset);
  hdf5::Shape start(shape.size(), 0), count = shape;
  if (shape.size() == 2) {
    start[1 - along] = line;
    count[1 - along] = 1;
  }
  hdf5::check(H5Sselect_hyperslab(space.id(), H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr),
              "select a column");
  const hsize_t total = rows;
  const hdf5::Handle flat(H5Screate_simple(1, &total, nullptr), H5Sclose, "make a shape");
  hdf5::check(H5Dread(dataset, memory, flat.id(), space.id(), H5P_DEFAULT, values.data()), "read its values");
  return values;
}

/// One element of a member of every row of a table.
template <class T>
std::vector<T> hdf5_read_member(hid_t dataset, const std::string& member, hsize_t element, hid_t memory,
                                std::size_t rows) {
  const hdf5::Handle type(H5Dget_type(dataset), H5Tclose, "read a table's type");
  const int position = H5Tget_member_index(type.id(), member.c_str());
  hdf5::check(position, "find the member");
  const hdf5::Handle stored(H5Tget_member_type(type.id(), static_cast<unsigned>(position)), H5Tclose,
                            "read a member's type");
  const bool array = H5Tget_class(stored.id()) == H5T_ARRAY;
  const hsize_t elements = array ? hdf5_array_elements(stored.id()) : 1;
  const hdf5::Handle cell(array ? H5Tarray_create2(memory, 1, &elements) : H5Tcopy(memory), H5Tclose, "make a type");
  const hdf5::Handle row(H5Tcreate(H5T_COMPOUND, static_cast<std::size_t>(elements) * sizeof(T)), H5Tclose,
                         "make a type");
  hdf5::check(H5Tinsert(row.id(), member.c_str(), 0, cell.id()), "make a type");
  std::vector<T> all(rows * static_cast<std::size_t>(elements)), values(rows);
  hdf5::check(H5Dread(dataset, row.id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, all.data()), "read its values");
  for (std::size_t k = 0; k < rows; ++k) values[k] = all[k * static_cast<std::size_t>(elements) + element];
  return values;
}

/// All texts of a dataset, or of a member of a table, without blanks and zeros at their ends.
std::vector<std::string> hdf5_read_texts(hid_t dataset, const std::string& member);

}  // namespace modebank
