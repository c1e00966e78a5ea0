#pragma once

#include <cstdint>
#include <string>
#include <type_traits>
#include <vector>

#include "io/hdf5/handle.hpp"

namespace modebank::hdf5 {

using Shape = std::vector<hsize_t>;

/// Datasets and attributes both contain arrays. Only the calls that create and open them differ.
enum class Place { dataset, attribute };

/// Types of a number in memory and in the file. Files are little-endian on every machine.
template <class T>
hid_t memory_type() {
  if constexpr (std::is_same_v<T, double>) return H5T_NATIVE_DOUBLE;
  if constexpr (std::is_same_v<T, std::int8_t>) return H5T_NATIVE_INT8;
  if constexpr (std::is_same_v<T, std::int32_t>) return H5T_NATIVE_INT32;
  if constexpr (std::is_same_v<T, std::int64_t>) return H5T_NATIVE_INT64;
  if constexpr (std::is_same_v<T, std::uint64_t>) return H5T_NATIVE_UINT64;
}

template <class T>
hid_t file_type() {
  if constexpr (std::is_same_v<T, double>) return H5T_IEEE_F64LE;
  if constexpr (std::is_same_v<T, std::int8_t>) return H5T_STD_I8LE;
  if constexpr (std::is_same_v<T, std::int32_t>) return H5T_STD_I32LE;
  if constexpr (std::is_same_v<T, std::int64_t>) return H5T_STD_I64LE;
  if constexpr (std::is_same_v<T, std::uint64_t>) return H5T_STD_U64LE;
}

/// A type of UTF-8 texts of fixed length, padded with zero bytes. HDF5 has no strings of length 0, so the smallest
/// length is 1.
Handle string_type(std::size_t bytes);
/// Type of a dataset with these texts. It is ASCII if all texts are ASCII.
Handle array_text_type(const std::vector<std::string>& texts);
std::size_t longest(const std::vector<std::string>& texts);
/// Packs texts into contiguous cells of `bytes` each, and unpacks them.
std::string pack_texts(const std::vector<std::string>& texts, std::size_t bytes);
std::vector<std::string> unpack_texts(const std::string& cells, std::size_t bytes);

/// The product a * b. On overflow, the largest number.
hsize_t saturating_product(hsize_t a, hsize_t b);
/// Number of elements. On overflow, the largest hsize_t.
hsize_t element_count(const Shape& shape);

/// Whether a dataset's values are in another file or in other datasets.
bool lies_outside(hid_t dataset);

/// Creates and writes a dataset (contiguous, without time stamps) or an attribute. Returns it open. An empty shape is a
/// scalar.
Handle write_array(hid_t parent, Place place, const std::string& name, hid_t file_type, hid_t memory_type,
                   const Shape& shape, const void* data);

/// Some rows of a dataset: `count` rows, beginning with row `first`.
struct Rows {
  hsize_t first = 0, count = 0;
  hsize_t end() const { return first + count; }
};
/// Creates a dataset whose rows are written later. Rows that are never written have undefined content.
Handle create_rows(hid_t parent, const std::string& name, hid_t file_type, const Shape& shape);
/// Creates a dataset in which rows may stay unwritten. An unwritten entry is `missing`, a value of `memory_type`.
/// `prefill`: some rows will not be written.
Handle create_rows(hid_t parent, const std::string& name, hid_t file_type, hid_t memory_type, const Shape& shape,
                   const void* missing, bool prefill);
/// Writes several ranges of rows in one call. `data` contains the ranges one after another.
void write_rows(const Handle& dataset, hid_t memory_type, const std::vector<Rows>& rows, const void* data);

Handle write_texts(hid_t parent, Place place, const std::string& name, const std::vector<std::string>& texts,
                   const Shape& shape);

/// An open dataset or attribute. Its declared size is compared with the file's size, so a corrupt shape cannot cause a
/// huge allocation.
class StoredArray {
 public:
  StoredArray(hid_t parent, Place place, const std::string& name);

  hid_t object() const { return object_.id(); }
  hid_t type() const { return type_.id(); }
  H5T_class_t type_class() const { return H5Tget_class(type()); }
  const Shape& shape() const { return shape_; }
  hsize_t elements() const { return elements_; }
  void read(hid_t memory_type, void* data) const;
  /// Reads a range of rows of a dataset. The range must lie within its first extent.
  void read_rows(const Rows& rows, hid_t memory_type, void* data) const;
  /// Rows of a table as they are in the file, of type `type()`. Throws DataError if a member is neither a number nor a
  /// text of fixed length.
  std::string row_bytes(const Rows& rows) const;
  /// All texts in order. Throws DataError if the type is not a string of fixed length.
  std::vector<std::string> texts() const;

 private:
  void check_plausible() const;

  Place place_;
  std::string name_;
  Handle object_;
  Handle type_;
  Shape shape_;
  hsize_t elements_ = 0;
};

}  // namespace modebank::hdf5
