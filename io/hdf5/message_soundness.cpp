#include "io/hdf5/message_soundness.hpp"

#include <algorithm>
#include <optional>
#include <set>

#include "io/hdf5/array.hpp"

namespace modebank::hdf5 {

namespace {

/// Where the header with the message lies; none where it lies in a table of shared messages.
std::optional<haddr_t> shared_address(ByteReader reader, const Widths& widths) {
  constexpr std::uint64_t in_a_table = 1;
  const std::uint64_t version = reader.number(1), kind = reader.number(1);
  require_sound(version >= 1 && version <= 3, "a shared message is of an unknown version");
  if (version > 1 && kind == in_a_table) return std::nullopt;
  if (version == 1) reader.take(6 + widths.size);
  return reader.number(widths.address);
}

/// A name that may be shown; others than plain letters are not.
std::string quoted(std::string_view name) {
  constexpr std::size_t longest = 64;
  const bool plain = std::all_of(name.begin(), name.end(), [](char c) { return c >= ' ' && c <= '~' && c != '\''; });
  return plain && name.size() <= longest ? "the attribute '" + std::string(name) + "'" : "an attribute";
}

/// Before version 2, an attribute's parts are padded to eights.
std::string_view take_part(ByteReader& reader, std::uint64_t bytes, bool padded) {
  const auto count = static_cast<std::size_t>(bytes);
  return reader.take(padded ? (count + 7) / 8 * 8 : count).substr(0, count);
}

struct AttributeStart {
  std::uint64_t version, flags, name_bytes, type_bytes, space_bytes;
};

AttributeStart take_attribute_start(ByteReader& reader) {
  AttributeStart start{};
  start.version = reader.number(1);
  require_sound(start.version >= 1 && start.version <= 3, "an attribute is of an unknown version");
  start.flags = reader.number(1);
  if (start.version == 1) start.flags = 0;
  for (std::uint64_t* part : {&start.name_bytes, &start.type_bytes, &start.space_bytes}) *part = reader.number(2);
  if (start.version == 3) reader.take(1);  // the name's letters
  return start;
}

std::uint64_t attribute_element(std::string_view type, bool shared, const Widths& widths, const TypeAt& type_at) {
  ByteReader reader(type);
  if (!shared) return take_sound_type(reader, widths);
  const std::optional<haddr_t> address = shared_address(reader, widths);
  require_sound(address.has_value(), "an attribute's datatype is in a table of shared messages, which is not read");
  return type_at(*address);
}

void require_sound_attribute(std::string_view content, const Widths& widths, const TypeAt& type_at) {
  constexpr std::uint64_t shared_type = 1, shared_space = 2;
  std::string name = "an attribute";
  try {
    ByteReader reader(content);
    const AttributeStart start = take_attribute_start(reader);
    const bool padded = start.version == 1;
    const std::string_view text = take_part(reader, start.name_bytes, padded);
    require_sound(!text.empty() && text.find('\0') == text.size() - 1,
                  "an attribute's name does not end where it says");
    name = quoted(text.substr(0, text.size() - 1));
    const std::string_view type = take_part(reader, start.type_bytes, padded);
    const std::uint64_t bytes = attribute_element(type, (start.flags & shared_type) != 0, widths, type_at);
    require_sound((start.flags & shared_space) == 0,
                  "an attribute's extents are in a table of shared messages, which is not read");
    ByteReader space(take_part(reader, start.space_bytes, padded));
    if (saturating_product(take_sound_space(space, widths), bytes) > reader.rest().size()) throw NotKnownHere{};
  } catch (const NotKnownHere&) {
    throw Unsound{name + " in an object header is larger than its message"};
  }
}

void require_sound_fill_value(std::string_view content) {
  constexpr std::uint64_t has_value_flag = 0x20;
  ByteReader reader(content);
  const std::uint64_t version = reader.number(1);
  require_sound(version >= 1 && version <= 3, "a fill value is of an unknown version");
  bool has_size = true;
  if (version == 3) {
    has_size = (reader.number(1) & has_value_flag) != 0;
  } else {
    reader.take(2);
    const bool defined = reader.number(1) != 0;
    has_size = version == 1 || defined;
  }
  if (!has_size) return;
  const std::uint64_t bytes = reader.number(4);
  constexpr std::uint64_t none = 0x80000000;  // as a signed number, which is how HDF5 takes it
  if (bytes < none) reader.take(static_cast<std::size_t>(bytes));
}

void require_sound_filters(std::string_view content) {
  constexpr std::uint64_t most_filters = 32, first_named = 256;
  ByteReader reader(content);
  const std::uint64_t version = reader.number(1), filters = reader.number(1);
  require_sound((version == 1 || version == 2) && filters <= most_filters, "a list of filters is of an unknown kind");
  if (version == 1) reader.take(6);
  for (std::uint64_t i = 0; i < filters; ++i) {
    const std::uint64_t id = reader.number(2);
    const std::uint64_t name_bytes = version == 1 || id >= first_named ? reader.number(2) : 0;
    reader.take(2);
    const std::uint64_t values = reader.number(2);
    const std::string_view name = take_part(reader, name_bytes, version == 1);
    require_sound(name.empty() || name.find('\0') != std::string_view::npos, "a filter's name does not end");
    reader.take(static_cast<std::size_t>(4 * values));
    if (version == 1 && values % 2 != 0) reader.take(4);
  }
}

/// Values in the header itself.
void require_sound_layout(std::string_view content, const Widths& widths) {
  constexpr std::uint64_t compact = 0;
  ByteReader reader(content);
  const std::uint64_t version = reader.number(1);
  if (version >= 3) {
    if (reader.number(1) == compact) reader.take(static_cast<std::size_t>(reader.number(2)));
    return;
  }
  const std::uint64_t dimensions = reader.number(1), kind = reader.number(1);
  reader.take(5);
  if (kind != compact) reader.take(widths.address);
  reader.take(static_cast<std::size_t>(4 * dimensions));
  if (kind == compact) reader.take(static_cast<std::size_t>(reader.number(4)));
}

void require_sound_link(std::string_view content, const Widths& widths) {
  constexpr std::uint64_t length_flags = 3, ordered_flag = 4, kind_flag = 8, letters_flag = 16;
  constexpr std::uint64_t hard = 0, soft = 1, first_named = 64;
  ByteReader reader(content);
  require_sound(reader.number(1) == 1, "a link is of an unknown version");
  const std::uint64_t flags = reader.number(1);
  const std::uint64_t kind = (flags & kind_flag) != 0 ? reader.number(1) : hard;
  require_sound(kind == hard || kind == soft || kind >= first_named, "a link is of an unknown kind");
  reader.take(((flags & ordered_flag) != 0 ? 8 : 0) + ((flags & letters_flag) != 0 ? 1 : 0));
  reader.take(static_cast<std::size_t>(reader.number(std::size_t{1} << (flags & length_flags))));
  reader.take(kind == hard ? widths.address : static_cast<std::size_t>(reader.number(2)));
}

void require_sound_datatype(const RawMessage& message, const Widths& widths, const TypeAt& type_at) {
  ByteReader reader(message.content);
  if (!message.shared) {
    take_sound_type(reader, widths);
  } else if (const std::optional<haddr_t> address = shared_address(reader, widths)) {
    type_at(*address);
  }
}

/// Kinds of messages, as the format numbers them.
enum MessageKind : std::uint64_t {
  nothing = 0,
  dataspace = 1,
  datatype = 3,
  old_fill = 4,
  fill = 5,
  outside = 7,
  layout = 8,
  group_info = 10,
  filters = 11,
  comment = 13,
  continuation = 16,
  symbols = 17,
  reference_count = 22,
  cache_image = 24
};

}  // namespace

DensePlaces dense_places(const RawMessage& message, const Widths& widths) {
  constexpr std::uint64_t ordered_flag = 1, indexed_flag = 2;
  ByteReader reader(message.content);
  reader.take(1);
  const std::uint64_t flags = reader.number(1);
  if ((flags & ordered_flag) != 0) reader.take(message.kind == link_info_kind ? 8 : 2);
  const haddr_t heap = reader.number(widths.address), by_name = reader.number(widths.address);
  return {heap, by_name, (flags & indexed_flag) != 0 ? reader.number(widths.address) : HADDR_UNDEF};
}

void require_of_an_archive(const RawMessage& message) {
  constexpr std::uint64_t layout_version = 3, contiguous = 1;
  static const std::set<std::uint64_t> known{
      nothing,        dataspace,    link_info_kind,      datatype,       fill, link_kind, layout, group_info,
      attribute_kind, continuation, attribute_info_kind, reference_count};
  require_sound(message.kind != outside, "an array keeps its content in another file");
  require_sound(!message.shared && known.contains(message.kind), "it holds what no archive does");
  if (message.kind != layout) return;
  const bool in_one_piece = message.content.size() > 1 && message.content[0] == layout_version &&
                            static_cast<unsigned char>(message.content[1]) <= contiguous;
  require_sound(in_one_piece, "an array lies in pieces, as none of an archive does");
}

void require_sound_message(const RawMessage& message, const Widths& widths, const TypeAt& type_at) {
  const std::string_view content = message.content;
  ByteReader reader(content);
  // From there, HDF5 would take whole headers that nobody judges.
  require_sound(message.kind != cache_image, "the file holds an image of HDF5's memory, which is not read");
  try {
    if (message.kind == attribute_kind) {
      require_sound(!message.shared, "an attribute is in a table of shared messages, which is not read");
      return require_sound_attribute(content, widths, type_at);
    }
    if (message.kind == datatype) return require_sound_datatype(message, widths, type_at);
    if (message.shared) return;
    if (message.kind == dataspace) take_sound_space(reader, widths);
    if (message.kind == link_kind) require_sound_link(content, widths);
    if (message.kind == old_fill) reader.take(static_cast<std::size_t>(reader.number(4)));
    if (message.kind == fill) require_sound_fill_value(content);
    if (message.kind == layout) require_sound_layout(content, widths);
    if (message.kind == filters) require_sound_filters(content);
    if (message.kind == comment && content.find('\0') == std::string_view::npos) throw NotKnownHere{};
    if (message.kind == symbols) reader.take(2 * widths.address);
    if (message.kind == link_info_kind || message.kind == attribute_info_kind) dense_places(message, widths);
  } catch (const NotKnownHere&) {
    throw Unsound{"a message in an object header is longer than it is"};
  }
}

}  // namespace modebank::hdf5
