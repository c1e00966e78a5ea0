#include "io/hdf5/small_group_writer.hpp"

#include <algorithm>
#include <cstdint>

#include "io/hdf5/array.hpp"
#include "io/hdf5/file_driver.hpp"
#include "io/hdf5/lookup3.hpp"

namespace modebank::hdf5 {

namespace {

using Kind = HeaderMessage::Kind;

constexpr std::size_t most_compact = 4096;  // bytes of an array in its header, as array.cpp has it
constexpr unsigned most_members = 32;       // links in a group's header
constexpr std::size_t most_attributes = 8;  // in a header, HDF5's own limit
constexpr std::size_t longest_name = 200;   // its length is one byte here
constexpr std::uint64_t constant_flag = 1, unshared_flag = 4;

std::string number(std::uint64_t value, std::size_t bytes) {
  std::string text(bytes, '\0');
  for (std::size_t i = 0; i < bytes; ++i) text[i] = static_cast<char>(value >> 8 * i & 255);
  return text;
}

std::string message(Kind kind, std::uint64_t flags, const std::string& content) {
  return number(static_cast<std::uint64_t>(kind), 1) + number(content.size(), 2) + number(flags, 1) + content;
}

std::string header(const std::string& messages) {
  std::string text = "OHDR" + number(2, 1) + number(1, 1) + number(messages.size(), 2) + messages;
  return text + number(lookup3(reinterpret_cast<const unsigned char*>(text.data()), text.size()), 4);
}

/// Version 1 of a type: its class, its properties, the size of an element, and more properties of numbers.
std::string type_of(const SmallArray& array) {
  constexpr std::uint64_t text_class = 0x13, padded_utf8 = 0x11, integer_class = 0x10, is_signed = 8;
  const std::string size = number(array.element_bytes, 4);
  if (array.type_class == H5T_STRING) return number(text_class, 1) + number(padded_utf8, 3) + size;
  if (array.type_class == H5T_FLOAT)
    return std::string("\x11\x20\x3f\x00\x08\x00\x00\x00\x00\x00\x40\x00\x34\x0b\x00\x34\xff\x03\x00\x00", 20);
  return number(integer_class, 1) + number(array.type == H5T_STD_U64LE ? 0 : is_signed, 3) + size + number(0, 2) +
         number(8 * array.element_bytes, 2);
}

/// Version 2 of a dataspace. `limits`: datasets state the largest extents, too.
std::string shape_of(const std::vector<hsize_t>& shape, bool limits) {
  std::string extents;
  for (const hsize_t extent : shape) extents += number(extent, 8);
  return number(2, 1) + number(shape.size(), 1) + number(limits ? 1 : 0, 1) + number(shape.empty() ? 0 : 1, 1) +
         extents + (limits ? extents : "");
}

std::string attribute(const std::string& name, const SmallArray& value) {
  const std::string type = type_of(value), shape = shape_of(value.shape, !value.shape.empty());
  return message(Kind::attribute, 0,
                 number(3, 1) + number(0, 1) + number(name.size() + 1, 2) + number(type.size(), 2) +
                     number(shape.size(), 2) + number(0, 1) + name + '\0' + type + shape + value.bytes);
}

/// That links or attributes have no heap.
std::string without_heap(Kind kind, std::uint64_t flags) {
  return message(kind, flags, number(0, 2) + std::string(16, '\xff'));
}

std::string dataset(const SmallArray& array, const std::vector<SmallArray>& unit) {
  const std::string fill("\x03\x09", 2);  // laid out at once, written where a value is set, which none is
  std::string messages =
      message(Kind::dataspace, 0, shape_of(array.shape, !array.shape.empty())) +
      message(Kind::datatype, constant_flag, type_of(array)) + message(Kind::fill_value, constant_flag, fill) +
      message(Kind::layout, 0, number(3, 1) + number(0, 1) + number(array.bytes.size(), 2) + array.bytes);
  if (!unit.empty()) messages += without_heap(Kind::attribute_info, unshared_flag) + attribute("units", unit.front());
  return header(messages);
}

SmallArray numbers(hid_t file_type, const std::vector<hsize_t>& shape, const void* values) {
  SmallArray array{H5Tget_class(file_type), file_type, H5Tget_size(file_type), shape, {}};
  array.bytes.assign(static_cast<const char*>(values),
                     static_cast<std::size_t>(element_count(shape)) * array.element_bytes);
  return array;
}

SmallArray words(const std::vector<std::string>& texts, const std::vector<hsize_t>& shape) {
  const std::size_t bytes = longest(texts);
  return {H5T_STRING, H5I_INVALID_HID, bytes, shape, pack_texts(texts, bytes)};
}

void write_attribute(hid_t object, const std::string& name, const SmallArray& value) {
  if (value.type_class == H5T_STRING) {
    write_texts(object, Place::attribute, name, unpack_texts(value.bytes, value.element_bytes), value.shape);
    return;
  }
  write_array(object, Place::attribute, name, value.type, value.type, value.shape, value.bytes.data());
}

/// Without time stamps. Up to `most_members` links lie in the group's own header, where HDF5's default of 8 makes a
/// heap and a tree for every run of a filter, which cost more than its arrays.
Handle group_creation() {
  constexpr unsigned least_dense = 24, links = 14, name_bytes = 16;
  Handle creation(H5Pcreate(H5P_GROUP_CREATE), H5Pclose, "prepare groups");
  check(H5Pset_obj_track_times(creation.id(), false), "prepare groups");
  check(H5Pset_link_phase_change(creation.id(), most_members, least_dense), "prepare groups");
  check(H5Pset_est_link_info(creation.id(), links, name_bytes), "prepare groups");
  return creation;
}

Handle utf8_links() {
  Handle link(H5Pcreate(H5P_LINK_CREATE), H5Pclose, "prepare links");
  check(H5Pset_char_encoding(link.id(), H5T_CSET_UTF8), "prepare links");
  return link;
}

/// Made once, as datasets' (array.cpp).
hid_t link_creation() {
  static const Handle& links = *new Handle(utf8_links());
  return links.id();
}

}  // namespace

OpenedFile appendable_file(hid_t object) {
  const OpenedFile file = opened_file(object);
  return file.handle && is_in_the_making(file.handle) ? file : OpenedFile();
}

void NewSmallGroup::add_attribute(const std::string& name, hid_t file_type, const void* value) {
  attributes_.push_back({name, numbers(file_type, {}, value)});
}

void NewSmallGroup::add_attribute(const std::string& name, const std::string& text) {
  attributes_.push_back({name, words({text}, {})});
}

void NewSmallGroup::add_array(const std::string& name, hid_t file_type, const std::vector<hsize_t>& shape,
                              const void* values) {
  arrays_.push_back({name, numbers(file_type, shape, values)});
}

void NewSmallGroup::add_unit(const std::vector<std::string>& texts, const std::vector<hsize_t>& shape) {
  arrays_.back().unit = {words(texts, shape)};
}

Handle make_group(hid_t parent, const std::string& name) {
  static const Handle& creation = *new Handle(group_creation());
  return {H5Gcreate2(parent, name.c_str(), link_creation(), creation.id(), H5P_DEFAULT), H5Gclose,
          "create the group '" + name + "'"};
}

bool NewSmallGroup::fits() const {
  const auto small = [](const Named& named) {
    const std::size_t unit = named.unit.empty() ? 0 : named.unit.front().bytes.size();
    return !named.array.bytes.empty() && std::max(named.array.bytes.size(), unit) <= most_compact &&
           named.name.size() <= longest_name;
  };
  return arrays_.size() <= most_members && attributes_.size() <= most_attributes &&
         std::all_of(arrays_.begin(), arrays_.end(), small) &&
         std::all_of(attributes_.begin(), attributes_.end(), small);
}

std::string NewSmallGroup::block(haddr_t address, std::size_t& group_begins) const {
  // Of no version, and that no link leads to the group yet: HDF5 makes the one, and takes this out.
  const std::string no_links = number(0, 1) + number(0, 4), limits("\x00\x03\x20\x00\x18\x00\x0e\x00\x10\x00", 10);
  constexpr auto reference_count = static_cast<Kind>(22);
  std::string text, messages = without_heap(Kind::link_info, 0) + message(Kind::group_info, constant_flag, limits) +
                               message(reference_count, unshared_flag, no_links);
  if (!attributes_.empty()) messages += without_heap(Kind::attribute_info, unshared_flag);
  for (const Named& named : attributes_) messages += attribute(named.name, named.array);
  for (const Named& named : arrays_) {
    const std::string link = number(1, 1) + number(0, 1) + number(named.name.size(), 1) + named.name;
    messages += message(Kind::link, 0, link + number(address + text.size(), 8));
    text += dataset(named.array, named.unit);
  }
  group_begins = text.size();
  return text + header(messages);
}

void NewSmallGroup::write(const OpenedFile& file, hid_t parent, const std::string& name) const {
  if (!file.handle || !fits()) return write_by_hdf5(parent, name);
  const haddr_t address = end_of(file.handle) - file.before;
  std::size_t group_begins = 0;
  append(file.handle, block(address, group_begins));
  const Handle group(H5Oopen_by_addr(parent, address + group_begins), H5Oclose, "find the group '" + name + "'");
  check(H5Olink(group.id(), parent, name.c_str(), link_creation(), H5P_DEFAULT), "name the group '" + name + "'");
}

void NewSmallGroup::write_by_hdf5(hid_t parent, const std::string& name) const {
  const Handle group = make_group(parent, name);
  for (const Named& named : attributes_) write_attribute(group.id(), named.name, named.array);
  for (const Named& named : arrays_) {
    const SmallArray& array = named.array;
    const Handle made =
        write_array(group.id(), Place::dataset, named.name, array.type, array.type, array.shape, array.bytes.data());
    if (!named.unit.empty()) write_attribute(made.id(), "units", named.unit.front());
  }
}

}  // namespace modebank::hdf5
