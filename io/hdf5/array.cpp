#include "io/hdf5/array.hpp"

#include <algorithm>
#include <limits>

#include "modebank/base/error.hpp"

namespace modebank::hdf5 {

namespace {

constexpr hsize_t largest = std::numeric_limits<hsize_t>::max();

std::string quoted(Place place, const std::string& name) {
  return (place == Place::dataset ? "the dataset '" : "the attribute '") + name + "'";
}

bool is_ascii(const std::vector<std::string>& texts) {
  const auto ascii = [](char c) { return static_cast<unsigned char>(c) < 0x80; };
  return std::all_of(texts.begin(), texts.end(),
                     [&](const std::string& text) { return std::all_of(text.begin(), text.end(), ascii); });
}

Handle make_space(const Shape& shape) {
  const hid_t space =
      shape.empty() ? H5Screate(H5S_SCALAR) : H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr);
  return {space, H5Sclose, "make a dataspace"};
}

}  // namespace

bool lies_outside(hid_t dataset) {
  const Handle creation(H5Dget_create_plist(dataset), H5Pclose, "read a layout");
  return H5Pget_external_count(creation.id()) != 0 || H5Pget_layout(creation.id()) == H5D_VIRTUAL;
}

Handle string_type(std::size_t bytes) {
  Handle type(H5Tcopy(H5T_C_S1), H5Tclose, "make a string type");
  check(H5Tset_size(type.id(), std::max<std::size_t>(bytes, 1)), "size a string type");
  check(H5Tset_cset(type.id(), H5T_CSET_UTF8), "make a UTF-8 type");
  check(H5Tset_strpad(type.id(), H5T_STR_NULLPAD), "make a padded type");
  return type;
}

std::size_t longest(const std::vector<std::string>& texts) {
  std::size_t bytes = 1;
  for (const std::string& text : texts) bytes = std::max(bytes, text.size());
  return bytes;
}

Handle array_text_type(const std::vector<std::string>& texts) {
  Handle type = string_type(longest(texts));
  // ASCII texts are not marked as UTF-8, although they are valid UTF-8. Octave's load drops a whole group if a dataset
  // such as /windows/run is marked as UTF-8.
  if (is_ascii(texts)) check(H5Tset_cset(type.id(), H5T_CSET_ASCII), "make an ASCII type");
  return type;
}

std::string pack_texts(const std::vector<std::string>& texts, std::size_t bytes) {
  std::string cells(texts.size() * bytes, '\0');
  for (std::size_t i = 0; i < texts.size(); ++i) texts[i].copy(cells.data() + i * bytes, bytes);
  return cells;
}

std::vector<std::string> unpack_texts(const std::string& cells, std::size_t bytes) {
  std::vector<std::string> texts;
  for (std::size_t begin = 0; begin < cells.size(); begin += bytes) {
    std::string text = cells.substr(begin, bytes);
    text.resize(text.find_last_not_of('\0') + 1);
    texts.push_back(std::move(text));
  }
  return texts;
}

hsize_t saturating_product(hsize_t a, hsize_t b) { return a != 0 && b > largest / a ? largest : a * b; }

hsize_t element_count(const Shape& shape) {
  hsize_t count = 1;
  for (const hsize_t extent : shape) count = saturating_product(count, extent);
  return count;
}

namespace {

Handle creation_of_arrays() {
  Handle creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, "prepare datasets");
  check(H5Pset_obj_track_times(creation.id(), false), "prepare datasets");
  check(H5Pset_layout(creation.id(), H5D_CONTIGUOUS), "prepare datasets");
  return creation;
}

Handle create_dataset(hid_t parent, const std::string& name, hid_t file_type, const Shape& shape,
                      const Handle& creation) {
  return {H5Dcreate2(parent, name.c_str(), file_type, make_space(shape).id(), H5P_DEFAULT, creation.id(), H5P_DEFAULT),
          H5Dclose, "create " + quoted(Place::dataset, name)};
}

}  // namespace

Handle create_rows(hid_t parent, const std::string& name, hid_t file_type, const Shape& shape) {
  return create_dataset(parent, name, file_type, shape, creation_of_arrays());
}

Handle create_rows(hid_t parent, const std::string& name, hid_t file_type, hid_t memory_type, const Shape& shape,
                   const void* missing, bool prefill) {
  const Handle creation = creation_of_arrays();
  check(H5Pset_fill_value(creation.id(), memory_type, missing), "prepare datasets");
  check(H5Pset_fill_time(creation.id(), prefill ? H5D_FILL_TIME_ALLOC : H5D_FILL_TIME_NEVER), "prepare datasets");
  return create_dataset(parent, name, file_type, shape, creation);
}

namespace {

Shape shape_of(const Handle& space) {
  const int rank = H5Sget_simple_extent_ndims(space.id());
  check(rank, "read a rank");
  Shape shape(static_cast<std::size_t>(rank));
  check(H5Sget_simple_extent_dims(space.id(), shape.data(), nullptr), "read a shape");
  return shape;
}

/// Selects rows in a dataset's space. Returns the shape of the selection.
Shape select_rows(const Handle& space, const std::vector<Rows>& rows) {
  Shape extent = shape_of(space), first(extent.size(), 0);
  hsize_t count = 0;
  for (const Rows& part : rows) {
    first.front() = part.first;
    extent.front() = part.count;
    check(H5Sselect_hyperslab(space.id(), count == 0 ? H5S_SELECT_SET : H5S_SELECT_OR, first.data(), nullptr,
                              extent.data(), nullptr),
          "select rows");
    count += part.count;
  }
  extent.front() = count;
  return extent;
}

}  // namespace

void write_rows(const Handle& dataset, hid_t memory_type, const std::vector<Rows>& rows, const void* data) {
  const Handle space(H5Dget_space(dataset.id()), H5Sclose, "read a shape");
  const Shape extent = select_rows(space, rows);
  if (element_count(extent) == 0) return;
  check(H5Dwrite(dataset.id(), memory_type, make_space(extent).id(), space.id(), H5P_DEFAULT, data), "write rows");
}

Handle write_array(hid_t parent, Place place, const std::string& name, hid_t file_type, hid_t memory_type,
                   const Shape& shape, const void* data) {
  const std::string what = quoted(place, name);
  if (place == Place::attribute) {
    const Handle space = make_space(shape);
    Handle attribute(H5Acreate2(parent, name.c_str(), file_type, space.id(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose,
                     "create " + what);
    if (element_count(shape) > 0) check(H5Awrite(attribute.id(), memory_type, data), "write " + what);
    return attribute;
  }
  Handle dataset = create_rows(parent, name, file_type, shape);
  if (element_count(shape) > 0)
    check(H5Dwrite(dataset.id(), memory_type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data), "write " + what);
  return dataset;
}

Handle write_texts(hid_t parent, Place place, const std::string& name, const std::vector<std::string>& texts,
                   const Shape& shape) {
  const std::size_t bytes = longest(texts);
  const bool array = place == Place::dataset && !shape.empty();
  const Handle type = array ? array_text_type(texts) : string_type(bytes);
  return write_array(parent, place, name, type.id(), type.id(), shape, pack_texts(texts, bytes).data());
}

StoredArray::StoredArray(hid_t parent, Place place, const std::string& name) : place_(place), name_(name) {
  const std::string what = quoted(place, name);
  Handle space;
  if (place == Place::dataset) {
    object_ = Handle(H5Dopen2(parent, name.c_str(), H5P_DEFAULT), H5Dclose, "open " + what);
    // Archives of modebank contain all their data. A layout with external data must not make the program read other
    // files.
    if (lies_outside(object())) throw DataError(what + " has its content in another file");
    type_ = Handle(H5Dget_type(object()), H5Tclose, "read the type of " + what);
    space = Handle(H5Dget_space(object()), H5Sclose, "read the shape of " + what);
  } else {
    object_ = Handle(H5Aopen(parent, name.c_str(), H5P_DEFAULT), H5Aclose, "open " + what);
    type_ = Handle(H5Aget_type(object()), H5Tclose, "read the type of " + what);
    space = Handle(H5Aget_space(object()), H5Sclose, "read the shape of " + what);
  }
  shape_ = shape_of(space);
  elements_ = H5Sget_simple_extent_type(space.id()) == H5S_NULL ? 0 : element_count(shape_);
  check_plausible();
}

void StoredArray::check_plausible() const {
  const auto refuse = [&] { throw DataError(quoted(place_, name_) + " declares more content than the file has"); };
  const std::size_t element_bytes = H5Tget_size(type());  // HDF5 divides by this size
  if (element_bytes == 0) throw DataError(quoted(place_, name_) + " has elements of size 0");
  const hsize_t bytes = saturating_product(elements_, element_bytes);
  hsize_t file_bytes = 0;
  const Handle file(H5Iget_file_id(object()), H5Fclose, "find the file");
  check(H5Fget_filesize(file.id(), &file_bytes), "read the size of the file");
  // An array without elements may still declare extents, and readers use extents as numbers of items.
  const hsize_t longest_extent = shape_.empty() ? 0 : *std::max_element(shape_.begin(), shape_.end());
  if (bytes > file_bytes || longest_extent > file_bytes) refuse();
}

void StoredArray::read(hid_t memory_type, void* data) const {
  if (elements_ == 0) return;
  const std::string what = "read " + quoted(place_, name_);
  if (place_ == Place::attribute) return check(H5Aread(object(), memory_type, data), what);
  check(H5Dread(object(), memory_type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data), what);
}

void StoredArray::read_rows(const Rows& rows, hid_t memory_type, void* data) const {
  const Handle space(H5Dget_space(object()), H5Sclose, "read a shape");
  const Shape extent = select_rows(space, {rows});
  if (element_count(extent) == 0) return;
  check(H5Dread(object(), memory_type, make_space(extent).id(), space.id(), H5P_DEFAULT, data),
        "read rows of " + quoted(place_, name_));
}

namespace {

/// Whether values of the type are plain bytes that contain no references.
bool is_plain(hid_t type) {
  const H5T_class_t kind = H5Tget_class(type);
  if (kind == H5T_ARRAY) return is_plain(Handle(H5Tget_super(type), H5Tclose, "read a type").id());
  if (kind != H5T_COMPOUND)
    return kind == H5T_INTEGER || kind == H5T_FLOAT || (kind == H5T_STRING && H5Tis_variable_str(type) == 0);
  for (unsigned i = 0; i < static_cast<unsigned>(H5Tget_nmembers(type)); ++i)
    if (!is_plain(Handle(H5Tget_member_type(type, i), H5Tclose, "read a type").id())) return false;
  return true;
}

}  // namespace

std::string StoredArray::row_bytes(const Rows& rows) const {
  if (!is_plain(type()))
    throw DataError(quoted(place_, name_) + " has values that are neither numbers nor texts of fixed length");
  std::string bytes(static_cast<std::size_t>(rows.count) * H5Tget_size(type()), '\0');
  read_rows(rows, type(), bytes.data());
  return bytes;
}

std::vector<std::string> StoredArray::texts() const {
  if (type_class() != H5T_STRING || H5Tis_variable_str(type()) != 0)
    throw DataError(quoted(place_, name_) + " does not have fixed-length strings");
  const Handle type_in_memory(H5Tcopy(type()), H5Tclose, "copy a string type");
  check(H5Tset_strpad(type_in_memory.id(), H5T_STR_NULLPAD), "pad a string type");
  const std::size_t bytes = H5Tget_size(type());
  std::string cells(static_cast<std::size_t>(elements_) * bytes, '\0');
  read(type_in_memory.id(), cells.data());
  return unpack_texts(cells, bytes);
}

}  // namespace modebank::hdf5
