#pragma once

#include <string>
#include <vector>

#include "io/hdf5/array.hpp"
#include "io/table/table_reader.hpp"

/// Types, attributes and lines of datasets in HDF5 logs of other programs.
namespace modebank {

haddr_t hdf5_address(hid_t object);
std::string hdf5_path(hid_t object);
/// A text attribute of fixed length. Empty if the attribute does not exist or has another type.
std::string hdf5_text_attribute(hid_t object, const std::string& name);
/// An attribute that is one number. `otherwise` if the attribute does not exist or is anything else.
double hdf5_number_attribute(hid_t object, const std::string& name, double otherwise);
/// Value of the attribute `units`, `unit` or `Units`.
std::string hdf5_unit(hid_t object);
hdf5::Shape hdf5_shape(hid_t dataset);

/// Whether values can be converted to numbers. This holds for integers, floats, enumerations (h5py's booleans) and
/// bits.
bool hdf5_is_number(hid_t type);
/// Whether a type is a bit field of at most 64 bits. PyTables stores truth values as bit fields.
bool hdf5_is_bits(hid_t type);
bool hdf5_is_whole(hid_t type);
bool hdf5_is_text(hid_t type);
/// Name of a type: double, float32, int16, uint8, bits8, text, ...
std::string hdf5_type_name(hid_t type);
std::string hdf5_member_name(hid_t compound, unsigned member);
hsize_t hdf5_array_elements(hid_t array_type);

/// Opens a log for reading, even if a program is still writing the log in SWMR mode.
hdf5::Handle hdf5_open_log(const std::string& path);
/// Whether a dataset's values are in another file or in other datasets.
bool hdf5_lies_outside(hid_t dataset);

/// Calls H5Dread. Throws DataError with HDF5's reason. If an HDF5 filter is not installed, the message contains a line
/// of Python that copies the file without this filter.
void hdf5_read(hid_t dataset, hid_t memory_type, hid_t memory_space, hid_t file_space, void* to);

/// Rows (counted from 1) of one line of a dataset, in chunks that were never written. HDF5 returns the fill value for
/// these rows. The dataset has one or two dimensions.
std::vector<LineRange> hdf5_unwritten_lines(hid_t dataset, hsize_t along, hsize_t across);

/// The type of a member of a compound. `member` lists the names of the nested compounds and the member. If the list is
/// empty, returns the type itself.
hdf5::Handle hdf5_member_type(hid_t compound, const std::vector<std::string>& member);
/// An in-memory type of rows that contain only this member, with the type `cell`.
hdf5::Handle hdf5_only_member(const std::vector<std::string>& member, hdf5::Handle cell);

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
  hdf5_read(dataset, memory, flat.id(), space.id(), values.data());
  return values;
}

/// One element of a table's member, in every row.
template <class T>
std::vector<T> hdf5_read_member(hid_t dataset, const std::vector<std::string>& member, hsize_t element, hid_t memory,
                                std::size_t rows) {
  const hdf5::Handle type(H5Dget_type(dataset), H5Tclose, "read a table's type");
  const hdf5::Handle stored = hdf5_member_type(type.id(), member);
  const bool array = H5Tget_class(stored.id()) == H5T_ARRAY;
  const hsize_t elements = array ? hdf5_array_elements(stored.id()) : 1, total = rows;
  const hdf5::Handle row = hdf5_only_member(
      member, {array ? H5Tarray_create2(memory, 1, &elements) : H5Tcopy(memory), H5Tclose, "make a type"});
  const hdf5::Handle flat(H5Screate_simple(1, &total, nullptr), H5Sclose, "make a shape");
  std::vector<T> all(rows * static_cast<std::size_t>(elements)), values(rows);
  hdf5_read(dataset, row.id(), flat.id(), H5S_ALL, all.data());
  for (std::size_t k = 0; k < rows; ++k) values[k] = all[k * static_cast<std::size_t>(elements) + element];
  return values;
}

/// All texts of a dataset or of a table's member. Blanks and zeros at their ends are removed.
std::vector<std::string> hdf5_read_texts(hid_t dataset, const std::vector<std::string>& member = {});

}  // namespace modebank
