#pragma once

#include <cstdint>
#include <string>
#include <type_traits>
#include <vector>

#include "io/hdf5/handle.hpp"

namespace modebank::hdf5 {

using Shape = std::vector<hsize_t>;

/// Datasets and attributes hold arrays alike; only the calls that make and open them differ.
enum class Place { dataset, attribute };

/// Memory and file type of a number; files are little-endian whatever the machine.
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

/// Fixed-length, null-padded UTF-8; HDF5 knows no string type of length 0, so the least is 1.
Handle string_type(std::size_t bytes);
/// That of a dataset whose texts are among these: ASCII where all are.
Handle array_text_type(const std::vector<std::string>& texts);
std::size_t longest(const std::vector<std::string>& texts);
/// Texts laid side by side in cells of `bytes` each, and back.
std::string pack_texts(const std::vector<std::string>& texts, std::size_t bytes);
std::vector<std::string> unpack_texts(const std::string& cells, std::size_t bytes);

/// The largest number where the product is larger.
hsize_t saturating_product(hsize_t a, hsize_t b);
/// Number of elements; the largest hsize_t when the product does not fit.
hsize_t element_count(const Shape& shape);

/// Whether a dataset's values are in another file or in other datasets.
bool lies_outside(hid_t dataset);

/// Creates a dataset (contiguous, without time stamps) or attribute, writes it and hands it over open. An empty shape
/// is a scalar.
Handle write_array(hid_t parent, Place place, const std::string& name, hid_t file_type, hid_t memory_type,
                   const Shape& shape, const void* data);

/// `count` rows of a dataset from `first` on.
struct Rows {
  hsize_t first = 0, count = 0;
  hsize_t end() const { return first + count; }
};
/// Creates a dataset that is written in rows. Rows that are never written hold what HDF5 leaves there.
Handle create_rows(hid_t parent, const std::string& name, hid_t file_type, const Shape& shape);
/// The same for rows of which some may be missing: they hold `missing`, a value of `memory_type`, in every entry.
/// `prefill`: some rows will not be written.
Handle create_rows(hid_t parent, const std::string& name, hid_t file_type, hid_t memory_type, const Shape& shape,
                   const void* missing, bool prefill);
/// Writes several stretches of rows by one call; `data` holds them one after the other.
void write_rows(const Handle& dataset, hid_t memory_type, const std::vector<Rows>& rows, const void* data);

Handle write_texts(hid_t parent, Place place, const std::string& name, const std::vector<std::string>& texts,
                   const Shape& shape);

/// An open dataset or attribute whose declared size has been checked against the file's, so that a corrupt shape cannot
/// ask for memory that no content backs.
class StoredArray {
 public:
  StoredArray(hid_t parent, Place place, const std::string& name);

  hid_t object() const { return object_.id(); }
  hid_t type() const { return type_.id(); }
  H5T_class_t type_class() const { return H5Tget_class(type()); }
  const Shape& shape() const { return shape_; }
  hsize_t elements() const { return elements_; }
  void read(hid_t memory_type, void* data) const;
  /// Some rows of a dataset, which lie within its first extent.
  void read_rows(const Rows& rows, hid_t memory_type, void* data) const;
  /// Rows of a table as the file has them, of `type()`. DataError where any of it is neither a number nor a text of
  /// fixed length.
  std::string row_bytes(const Rows& rows) const;
  /// All texts in order; DataError unless the type is a fixed-length string.
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
