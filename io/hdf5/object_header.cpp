#include "io/hdf5/object_header.hpp"

#include <algorithm>
#include <utility>

#include "io/hdf5/file_driver.hpp"
#include "io/hdf5/lookup3.hpp"
#include "io/hdf5/read_at.hpp"

namespace modebank::hdf5 {

FileBytes::FileBytes(hid_t object) {
  const OpenedFile file = opened_file(object);
  if (!file.handle) throw NotKnownHere{};
  descriptor_ = descriptor_of(file.handle);
  base_ = file.before;
}

std::string_view FileBytes::at(haddr_t address, std::size_t count) {
  constexpr std::size_t window_bytes = std::size_t{64} << 10, before = std::size_t{4} << 10;
  constexpr haddr_t largest = haddr_t{1} << 62;
  if (address > largest || count > window_bytes - before) throw NotKnownHere{};
  if (address < first_ || address + count > first_ + window_.size()) {
    first_ = address - std::min<haddr_t>(address, before);
    window_.resize(window_bytes);
    window_.resize(read_at(descriptor_, base_ + first_, window_bytes, window_.data()).value_or(0));
    if (address + count > first_ + window_.size()) throw NotKnownHere{};
  }
  return std::string_view(window_).substr(static_cast<std::size_t>(address - first_), count);
}

std::uint64_t ByteReader::number(std::size_t bytes) {
  const std::string_view taken = take(bytes);
  std::uint64_t value = 0;
  for (std::size_t i = bytes; i-- > 0;) value = value << 8 | static_cast<unsigned char>(taken[i]);
  return value;
}

std::string_view ByteReader::take(std::size_t count) {
  if (count > rest_.size()) throw NotKnownHere{};
  const std::string_view taken = rest_.substr(0, count);
  rest_.remove_prefix(count);
  return taken;
}

namespace {

using Kind = HeaderMessage::Kind;

constexpr std::size_t checksum_bytes = 4;

/// What a chunk holds before its checksum, which must fit.
std::string_view checked(std::string_view chunk) {
  const std::string_view content = chunk.substr(0, chunk.size() - checksum_bytes);
  ByteReader stored(chunk.substr(content.size()));
  if (lookup3(reinterpret_cast<const unsigned char*>(content.data()), content.size()) != stored.number(checksum_bytes))
    throw NotKnownHere{};
  return content;
}

Kind known_kind(std::uint64_t type) {
  constexpr Kind all[] = {Kind::nothing,   Kind::dataspace,    Kind::link_info,     Kind::datatype,
                          Kind::link,      Kind::layout,       Kind::fill_value,    Kind::group_info,
                          Kind::attribute, Kind::continuation, Kind::attribute_info};
  const Kind* const found = std::find(std::begin(all), std::end(all), static_cast<Kind>(type));
  if (type > 255 || found == std::end(all)) throw NotKnownHere{};
  return *found;
}

void append_messages(const HeaderStart& header, std::string_view chunk, std::vector<HeaderMessage>& messages) {
  each_message(header, chunk, [&](const RawMessage& message) {
    messages.push_back({known_kind(message.kind), message.shared, std::string(message.content)});
  });
}

}  // namespace

std::optional<HeaderStart> header_start(std::string_view bytes) {
  constexpr std::size_t old_begin = 16, times_bytes = 16, limits_bytes = 4;
  constexpr std::uint64_t most = std::uint64_t{1} << 32;
  constexpr std::string_view letters = "OHDR";
  ByteReader reader(bytes);
  if (bytes.substr(0, letters.size()) != letters) {
    if (bytes.empty() || bytes[0] != 1) return std::nullopt;
    reader.take(8);
    return HeaderStart{true, false, old_begin, reader.number(4)};
  }
  reader.take(letters.size());
  if (reader.number(1) != 2) throw NotKnownHere{};
  const std::uint64_t flags = reader.number(1);
  if ((flags & 0x20) != 0) reader.take(times_bytes);
  if ((flags & 0x10) != 0) reader.take(limits_bytes);
  const std::uint64_t count = reader.number(std::size_t{1} << (flags & 3));
  if (count > most) throw NotKnownHere{};
  return HeaderStart{false, (flags & 4) != 0, bytes.size() - reader.rest().size(), count};
}

void each_message(const HeaderStart& header, std::string_view messages,
                  const std::function<void(const RawMessage&)>& see) {
  constexpr std::uint64_t shared_flag = 2;
  for (ByteReader reader(messages); reader.rest().size() >= header.message_start_bytes();) {
    RawMessage message;
    message.kind = reader.number(header.is_old ? 2 : 1);
    const auto bytes = static_cast<std::size_t>(reader.number(2));
    message.shared = (reader.number(1) & shared_flag) != 0;
    reader.take(header.is_old ? 3 : header.ordered ? 2 : 0);
    message.content = reader.take(bytes);
    see(message);
  }
}

std::vector<HeaderMessage> header_messages(FileBytes& file, haddr_t address) {
  constexpr std::size_t most_messages = 256, address_bytes = 8, signature_bytes = 4;
  const std::optional<HeaderStart> start = header_start(file.at(address, longest_header_start));
  if (!start || start->is_old) throw NotKnownHere{};
  std::vector<HeaderMessage> messages;
  const std::string_view first = checked(file.at(address, static_cast<std::size_t>(start->all())));
  append_messages(*start, first.substr(static_cast<std::size_t>(start->begin)), messages);
  for (std::size_t i = 0; i < messages.size(); ++i) {
    if (messages.size() > most_messages) throw NotKnownHere{};
    if (messages[i].kind != Kind::continuation) continue;
    ByteReader place(messages[i].content);
    const haddr_t where = place.number(address_bytes);
    const std::uint64_t bytes = place.number(address_bytes);
    constexpr std::uint64_t most = std::uint64_t{1} << 16;
    if (bytes > most || bytes < signature_bytes + checksum_bytes) throw NotKnownHere{};
    ByteReader next(checked(file.at(where, static_cast<std::size_t>(bytes))));
    if (next.take(signature_bytes) != "OCHK") throw NotKnownHere{};
    append_messages(*start, next.rest(), messages);
  }
  return messages;
}

}  // namespace modebank::hdf5
