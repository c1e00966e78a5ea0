#include "io/hdf5/header_guard.hpp"

#include <algorithm>
#include <optional>

#include "io/hdf5/read_at.hpp"

namespace modebank::hdf5 {

namespace {

constexpr std::uint64_t continuation_kind = 16, datatype_kind = 3;
/// What one header may take; attributes of 64 kB, a thousand of them, are less.
constexpr std::uint64_t most_header_bytes = std::uint64_t{1} << 26;
constexpr char damaged[] = "an object header is damaged";

/// HDF5's first read of a header takes as much, or all there is.
constexpr std::size_t first_read_bytes = 512;

}  // namespace

void HeaderGuard::see_superblock(haddr_t at, std::string_view bytes) {
  constexpr std::string_view signature("\x89HDF\r\n\x1a\n", 8);
  constexpr std::size_t enough = 16, version_at = 8, old_widths_at = 13, widths_at = 9;
  if (bytes.substr(0, signature.size()) != signature) return;
  base_ = at;
  if (bytes.size() < enough) return;
  const std::size_t place = bytes[version_at] < 2 ? old_widths_at : widths_at;
  widths_ = {static_cast<unsigned char>(bytes[place]), static_cast<unsigned char>(bytes[place + 1])};
}

std::string HeaderGuard::bytes_at(haddr_t at, std::uint64_t count) const {
  require_sound(at <= size_ && count <= size_ - at && count <= most_header_bytes, damaged);
  std::string bytes(static_cast<std::size_t>(count), '\0');
  require_sound(read_at(descriptor_, at, bytes.size(), bytes.data()) == bytes.size(), damaged);
  return bytes;
}

void HeaderGuard::see_messages(const HeaderStart& header, std::string_view messages, std::vector<Chunk>& chunks,
                               const See& see) const {
  // HDF5 looks for a message's header in any chunk that is not empty.
  require_sound(messages.empty() || messages.size() >= header.message_start_bytes(), damaged);
  each_message(header, messages, [&](const RawMessage& message) {
    if (message.kind == continuation_kind) {
      ByteReader place(message.content);
      const haddr_t address = place.number(widths_.address);
      const std::uint64_t count = place.number(widths_.size);
      require_sound(address <= size_ && count <= most_header_bytes, damaged);
      chunks.push_back({base_ + address, count});
    }
    see(message);
  });
}

/// The chunks after the first `begin` bytes of it, in HDF5's order; `see` gets all messages.
std::vector<HeaderGuard::Chunk> HeaderGuard::walk(haddr_t at, std::string_view begin, const See& see) const {
  constexpr std::size_t letters_bytes = 4, checksum_bytes = 4;
  const std::optional<HeaderStart> header = header_start(begin);
  if (!header) return {};
  std::vector<Chunk> chunks;
  const std::uint64_t all = header->all();
  const std::string read = begin.size() < all ? bytes_at(at, all) : std::string();
  const std::string_view first = read.empty() ? begin : std::string_view(read);
  see_messages(*header, first.substr(static_cast<std::size_t>(header->begin), static_cast<std::size_t>(header->bytes)),
               chunks, see);
  std::set<haddr_t> known{at};
  std::uint64_t taken = all;
  for (std::size_t i = 0; i < chunks.size(); ++i) {
    require_sound(known.insert(chunks[i].address).second && (taken += chunks[i].bytes) <= most_header_bytes, damaged);
    const std::string bytes = bytes_at(chunks[i].address, chunks[i].bytes);
    std::string_view messages = bytes;
    if (!header->is_old) {
      require_sound(messages.size() >= letters_bytes + checksum_bytes, damaged);
      messages = messages.substr(letters_bytes, messages.size() - letters_bytes - checksum_bytes);
    }
    see_messages(*header, messages, chunks, see);
  }
  if (begin.size() < all) chunks.insert(chunks.begin(), {at + begin.size(), all - begin.size()});
  return chunks;
}

std::uint64_t HeaderGuard::type_at(haddr_t address) {
  if (const auto found = type_bytes_.find(address); found != type_bytes_.end()) return found->second;
  require_sound(address <= size_ && base_ + address <= size_, damaged);
  const haddr_t at = base_ + address;
  std::optional<std::uint64_t> bytes;
  walk(at, bytes_at(at, std::min<haddr_t>(first_read_bytes, size_ - at)), [&](const RawMessage& message) {
    if (message.kind != datatype_kind) return;
    require_sound(!message.shared, "a committed datatype refers to another one");
    ByteReader reader(message.content);
    const std::uint64_t taken = take_sound_type(reader, widths_);
    if (!bytes) bytes = taken;
  });
  require_sound(bytes.has_value(), "a reference to a datatype leads to none");
  return type_bytes_[address] = *bytes;
}

std::string HeaderGuard::content_at(haddr_t address, std::uint64_t count) const {
  require_sound(address <= size_, damaged);
  return bytes_at(base_ + address, count);
}

/// What a record says: where its identifier of a message begins, behind which an attribute's flags follow.
struct HeaderGuard::DenseTree {
  RecordKind records;
  std::size_t id_at;
};

void HeaderGuard::judge_tree(haddr_t address, const DenseTree& tree, std::uint64_t kind, MessageHeap& heap) {
  constexpr std::uint64_t shared_flag = 2;
  const std::size_t id_bytes = (kind == link_kind ? link_heap : attribute_heap).id_bytes;
  const BytesAt bytes = [this](haddr_t at, std::uint64_t count) { return content_at(at, count); };
  each_record(bytes, widths_, address, tree.records, [&](std::string_view record) {
    const bool shared = kind == attribute_kind && (static_cast<unsigned char>(record[id_bytes]) & shared_flag) != 0;
    const std::string content = heap.at(record.substr(tree.id_at, id_bytes));
    require_sound((dense_bytes_ += content.size()) <= 4 * size_,
                  damaged);  // in the file each is once, and in two trees
    judge_message({kind, shared, content});
  });
}

void HeaderGuard::judge_dense(const RawMessage& message) {
  const bool links = message.kind == link_info_kind;
  const haddr_t none = HADDR_UNDEF >> 8 * (sizeof(haddr_t) - widths_.address);
  const DensePlaces places = dense_places(message, widths_);
  const std::array key{places.heap, places.by_name, places.by_order};
  if (places.heap == none || dense_.contains(key)) return;
  const BytesAt bytes = [this](haddr_t at, std::uint64_t count) { return content_at(at, count); };
  MessageHeap heap(bytes, widths_, places.heap, links ? link_heap : attribute_heap);
  const DenseTree by_name = links ? DenseTree{{5, 11}, 4} : DenseTree{{8, 17}, 0},
                  by_order = links ? DenseTree{{6, 15}, 8} : DenseTree{{9, 13}, 0};
  const std::uint64_t kind = links ? link_kind : attribute_kind;
  judge_tree(places.by_name, by_name, kind, heap);
  if (places.by_order != none && places.by_order != HADDR_UNDEF) judge_tree(places.by_order, by_order, kind, heap);
  dense_.insert(key);
}

void HeaderGuard::judge_message(const RawMessage& message) {
  if (of_ == FileOf::archive) require_of_an_archive(message);
  require_sound_message(message, widths_, [this](haddr_t address) { return type_at(address); });
  const bool info = message.kind == link_info_kind || message.kind == attribute_info_kind;
  if (info && !message.shared) judge_dense(message);
}

void HeaderGuard::judge(haddr_t at, std::string_view bytes, haddr_t end) {
  // A header whose chunks are still in HDF5's memory is read without them.
  const auto next = std::find_if(expected_.begin(), expected_.end(), [&](const Chunk& chunk) {
    return chunk.address == at && chunk.bytes == bytes.size();
  });
  if (next != expected_.end()) return void(expected_.erase(expected_.begin(), next + 1));
  expected_.clear();
  // A chunk of version 1 that continues a header may begin as a header does.
  if (bytes.size() != first_read_bytes && at + bytes.size() < std::min(end, size_)) return;
  const auto is_known = [](std::size_t width) { return width == 2 || width == 4 || width == 8; };
  try {
    const std::optional<HeaderStart> start = header_start(bytes);
    if (!start) return;
    require_sound(of_ == FileOf::anybody || !start->is_old,
                  "not a modebank archive (its object headers are of an older kind)");
    require_sound(is_known(widths_.address) && is_known(widths_.size), "the file's addresses are of an unknown width");
    expected_ = walk(at, bytes, [this](const RawMessage& message) { judge_message(message); });
  } catch (const NotKnownHere&) {
    throw Unsound{damaged};
  }
}

}  // namespace modebank::hdf5
