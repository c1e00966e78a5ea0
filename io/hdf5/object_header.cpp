#include "io/hdf5/object_header.hpp"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <utility>

#include "io/hdf5/file_driver.hpp"
#include "io/hdf5/lookup3.hpp"

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
    ssize_t got = -1;
    do got = ::pread(descriptor_, window_.data(), window_bytes, static_cast<off_t>(base_ + first_));
    while (got < 0 && errno == EINTR);
    window_.resize(got < 0 ? 0 : static_cast<std::size_t>(got));
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

/// A chunk's messages; what is left at its end is less than a message's own header.
void append_messages(ByteReader chunk, bool ordered, std::vector<HeaderMessage>& messages) {
  constexpr std::uint64_t shared_flag = 2;
  const std::size_t header = ordered ? 6 : 4;
  while (chunk.rest().size() >= header) {
    const Kind kind = known_kind(chunk.number(1));
    const std::size_t bytes = static_cast<std::size_t>(chunk.number(2));
    const std::uint64_t flags = chunk.number(1);
    if (ordered) chunk.take(2);
    messages.push_back({kind, (flags & shared_flag) != 0, std::string(chunk.take(bytes))});
  }
}

/// The first chunk with its checksum, and where in it messages begin.
std::pair<std::string_view, std::size_t> first_chunk(FileBytes& file, haddr_t address, std::uint64_t& flags) {
  constexpr std::size_t signature_bytes = 4, times_bytes = 16, limits_bytes = 4;
  ByteReader start(file.at(address, signature_bytes + 2));
  if (start.take(signature_bytes) != "OHDR" || start.number(1) != 2) throw NotKnownHere{};
  flags = start.number(1);
  const std::size_t width = std::size_t{1} << (flags & 3), before = signature_bytes + 2 +
                                                                    ((flags & 0x20) != 0 ? times_bytes : 0) +
                                                                    ((flags & 0x10) != 0 ? limits_bytes : 0);
  const std::uint64_t bytes = ByteReader(file.at(address + before, width)).number(width);
  constexpr std::uint64_t most = std::uint64_t{1} << 16;
  if (bytes > most) throw NotKnownHere{};
  const std::size_t begin = before + width;
  return {file.at(address, begin + static_cast<std::size_t>(bytes) + checksum_bytes), begin};
}

}  // namespace

std::vector<HeaderMessage> header_messages(FileBytes& file, haddr_t address) {
  constexpr std::size_t most_messages = 256, address_bytes = 8, signature_bytes = 4;
  std::uint64_t flags = 0;
  const auto [chunk, begin] = first_chunk(file, address, flags);
  const bool ordered = (flags & 4) != 0;
  std::vector<HeaderMessage> messages;
  append_messages(ByteReader(checked(chunk).substr(begin)), ordered, messages);
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
    append_messages(next, ordered, messages);
  }
  return messages;
}

}  // namespace modebank::hdf5
