#include "io/hdf5/small_group.hpp"

#include <algorithm>
#include <array>
#include <limits>

namespace modebank::hdf5 {

namespace {

using Kind = HeaderMessage::Kind;

constexpr std::size_t address_bytes = 8;
constexpr haddr_t nowhere = std::numeric_limits<haddr_t>::max();

void require(bool known) {
  if (!known) throw NotKnownHere{};
}

/// Type of the elements: class and version, twelve bits of properties and the size first.
void read_type(std::string_view message, SmallArray& array) {
  constexpr std::string_view real("\x20\x3f\x00\x08\x00\x00\x00\x00\x00\x40\x00\x34\x0b\x00\x34\xff\x03\x00\x00", 19);
  constexpr std::uint64_t integer_class = 0, real_class = 1, text_class = 3, signed_flag = 8;
  ByteReader reader(message);
  const std::uint64_t kind = reader.number(1);
  require(kind >> 4 >= 1 && kind >> 4 <= 3);
  const std::string_view rest = reader.rest();
  const std::uint64_t flags = reader.number(3);
  array.element_bytes = static_cast<std::size_t>(reader.number(4));
  require(array.element_bytes > 0);
  switch (kind & 15) {
    case integer_class: {
      require((flags & ~signed_flag) == 0);
      require(reader.number(2) == 0 && reader.number(2) == 8 * array.element_bytes);
      array.type_class = H5T_INTEGER;
      const bool is_signed = flags != 0;
      if (is_signed && array.element_bytes == 1) return void(array.type = H5T_STD_I8LE);
      if (is_signed && array.element_bytes == 4) return void(array.type = H5T_STD_I32LE);
      if (is_signed && array.element_bytes == 8) return void(array.type = H5T_STD_I64LE);
      if (!is_signed && array.element_bytes == 8) return void(array.type = H5T_STD_U64LE);
      throw NotKnownHere{};
    }
    case real_class:
      require(rest.substr(0, real.size()) == real);
      array.type_class = H5T_FLOAT;
      array.type = H5T_IEEE_F64LE;
      return;
    case text_class:
      require((flags & 15) == 1);  // padded by zeros
      array.type_class = H5T_STRING;
      return;
    default:
      throw NotKnownHere{};
  }
}

/// Extents; how many elements that are.
hsize_t read_shape(std::string_view message, std::vector<hsize_t>& shape) {
  constexpr std::uint64_t most_elements = std::uint64_t{1} << 16, most_dimensions = 4;
  ByteReader reader(message);
  require(reader.number(1) == 2);
  const std::uint64_t dimensions = reader.number(1);
  reader.take(1);  // whether the largest extents follow, which are no matter here
  const std::uint64_t kind = reader.number(1);
  require(kind <= 1 && (kind == 1) == (dimensions > 0) && dimensions <= most_dimensions);
  hsize_t elements = 1;
  for (std::uint64_t i = 0; i < dimensions; ++i) {
    shape.push_back(reader.number(address_bytes));
    require(shape.back() > 0 && shape.back() <= most_elements);
    elements *= shape.back();
    require(elements <= most_elements);
  }
  return elements;
}

void read_values(std::string_view bytes, hsize_t elements, SmallArray& array) {
  require(array.element_bytes <= bytes.size() && elements <= bytes.size() / array.element_bytes);
  array.bytes = bytes.substr(0, static_cast<std::size_t>(elements) * array.element_bytes);
}

std::pair<std::string, SmallArray> read_attribute(std::string_view message) {
  ByteReader reader(message);
  require(reader.number(1) == 3 && reader.number(1) == 0);
  const auto name_bytes = static_cast<std::size_t>(reader.number(2)),
             type_bytes = static_cast<std::size_t>(reader.number(2)),
             shape_bytes = static_cast<std::size_t>(reader.number(2));
  reader.take(1);  // the name's letters
  const std::string_view name = reader.take(name_bytes);
  require(!name.empty() && name.find('\0') == name.size() - 1);
  std::pair<std::string, SmallArray> attribute(std::string(name.substr(0, name.size() - 1)), SmallArray());
  read_type(reader.take(type_bytes), attribute.second);
  const hsize_t elements = read_shape(reader.take(shape_bytes), attribute.second.shape);
  read_values(reader.rest(), elements, attribute.second);
  return attribute;
}

/// A dataset whose values are in its header, each of its parts there once.
SmallArray read_dataset(FileBytes& file, haddr_t address) {
  constexpr std::uint64_t layout_version = 3, compact = 0;
  const std::vector<HeaderMessage> messages = header_messages(file, address);
  const auto only = [&](Kind kind) {
    const auto is = [kind](const HeaderMessage& message) { return message.kind == kind; };
    const auto found = std::find_if(messages.begin(), messages.end(), is);
    require(found != messages.end() && !found->shared && std::none_of(found + 1, messages.end(), is));
    return std::string_view(found->content);
  };
  for (const HeaderMessage& message : messages)
    require(message.kind != Kind::link && message.kind != Kind::link_info && message.kind != Kind::group_info);
  SmallArray array;
  read_type(only(Kind::datatype), array);
  const hsize_t elements = read_shape(only(Kind::dataspace), array.shape);
  ByteReader layout(only(Kind::layout));
  require(layout.number(1) == layout_version && layout.number(1) == compact);
  const std::size_t bytes = static_cast<std::size_t>(layout.number(2));
  read_values(layout.take(bytes), elements, array);
  return array;
}

struct HardLink {
  std::string name;
  haddr_t address;
};

HardLink read_link(std::string_view message) {
  ByteReader reader(message);
  require(reader.number(1) == 1);
  const std::uint64_t flags = reader.number(1);
  if ((flags & 8) != 0) require(reader.number(1) == 0);
  if ((flags & 4) != 0) reader.take(8);   // the order of creation
  if ((flags & 16) != 0) reader.take(1);  // the name's letters
  const auto bytes = static_cast<std::size_t>(reader.number(std::size_t{1} << (flags & 3)));
  const std::string_view name = reader.take(bytes);
  require(!name.empty() && name.find('\0') == std::string_view::npos);
  return {std::string(name), reader.number(address_bytes)};
}

/// Links and attributes may lie in heaps of their own, where there are many.
void require_in_header(const HeaderMessage& message) {
  ByteReader reader(message.content);
  require(reader.number(1) == 0);
  const std::uint64_t flags = reader.number(1);
  if ((flags & 1) != 0) reader.take(message.kind == Kind::link_info ? 8 : 2);  // the last order of creation
  require(reader.number(address_bytes) == nowhere);
}

SmallGroup read_group(FileBytes& file, haddr_t address) {
  SmallGroup group;
  std::vector<HardLink> links;
  bool is_group = false;
  for (const HeaderMessage& message : header_messages(file, address)) {
    require(!message.shared);
    switch (message.kind) {
      case Kind::link_info:
        is_group = true;
        [[fallthrough]];
      case Kind::attribute_info:
        require_in_header(message);
        break;
      case Kind::link:
        links.push_back(read_link(message.content));
        break;
      case Kind::attribute:
        require(group.attributes.insert(read_attribute(message.content)).second);
        break;
      default:
        require(message.kind == Kind::nothing || message.kind == Kind::group_info ||
                message.kind == Kind::continuation);
    }
  }
  require(is_group && !links.empty());
  for (const HardLink& link : links) require(group.arrays.emplace(link.name, read_dataset(file, link.address)).second);
  return group;
}

}  // namespace

std::optional<SmallGroup> read_small_group(FileBytes& file, haddr_t address) {
  try {
    return read_group(file, address);
  } catch (const NotKnownHere&) {
    return std::nullopt;
  }
}

}  // namespace modebank::hdf5
