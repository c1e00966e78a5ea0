#include "io/hdf5/message_heap.hpp"

#include <bit>
#include <utility>

namespace modebank::hdf5 {

namespace {

constexpr char damaged_heap[] = "a heap of links or attributes is damaged",
               unusual_heap[] = "a heap of links or attributes is not as HDF5 makes it, which is not read";
constexpr std::uint64_t row_width = 4, row_width_bits = 2;  // blocks in a row
constexpr std::uint64_t largest_block_bits = 16, most_in_blocks = 4096;
constexpr std::size_t block_letters_bytes = 4, block_checksum_bytes = 4;

}  // namespace

MessageHeap::MessageHeap(const BytesAt& bytes_at, const Widths& widths, haddr_t address, const HeapKind& kind)
    : bytes_at_(bytes_at), widths_(widths), address_(address), kind_(kind) {
  constexpr std::uint64_t with_checksums = 2, id_wrapped = 1;
  const std::string header = bytes_at(address, 22 + 12 * widths.size + 3 * widths.address);
  ByteReader reader(header);
  require_sound(reader.take(block_letters_bytes) == "FRHP" && reader.number(1) == 0, damaged_heap);
  const bool sizes = reader.number(2) == kind.id_bytes && reader.number(2) == 0;
  require_sound(sizes && (reader.number(1) & ~id_wrapped) == with_checksums && reader.number(4) == most_in_blocks,
                unusual_heap);
  reader.take(widths.size);  // the next large message's identifier
  large_tree_ = reader.number(widths.address);
  reader.take(widths.size + widths.address + 8 * widths.size);  // free space, and what there is of everything
  const bool blocks =
      reader.number(2) == row_width && reader.number(widths.size) == std::uint64_t{1} << kind.block_bits &&
      reader.number(widths.size) == std::uint64_t{1} << largest_block_bits && reader.number(2) == kind.address_bits;
  require_sound(blocks, unusual_heap);
  reader.take(2);  // rows at the start
  root_ = reader.number(widths.address);
  root_rows_ = reader.number(2);
  require_sound(root_rows_ <= kind.address_bits - kind.block_bits - row_width_bits + 1, damaged_heap);
}

/// The first rows lead to blocks, those after them to more rows.
std::uint64_t MessageHeap::direct_rows() const { return largest_block_bits - kind_.block_bits + 2; }

/// Rows hold as much as all before them, but for the first two.
std::uint64_t MessageHeap::row_of(std::uint64_t offset) const {
  const std::uint64_t in_first = offset >> (kind_.block_bits + row_width_bits);
  return static_cast<std::uint64_t>(std::bit_width(in_first));
}

std::size_t MessageHeap::take_start(ByteReader& reader, std::string_view letters, std::uint64_t begin) const {
  require_sound(reader.take(block_letters_bytes) == letters && reader.number(1) == 0 &&
                    reader.number(widths_.address) == address_ && reader.number(offset_bytes()) == begin,
                damaged_heap);
  return block_letters_bytes + 1 + widths_.address + offset_bytes();
}

const std::string& MessageHeap::cached(haddr_t address, std::uint64_t bytes) {
  constexpr std::size_t most_blocks = 256;
  const auto found = blocks_.find(address);
  if (found != blocks_.end() && found->second.size() == bytes) return found->second;
  if (blocks_.size() >= most_blocks) blocks_.clear();
  return blocks_[address] = bytes_at_(address, bytes);
}

MessageHeap::Place MessageHeap::block_below(haddr_t address, std::uint64_t rows, std::uint64_t begin,
                                            std::uint64_t offset) {
  const std::uint64_t row = row_of(offset - begin), bits = row_bits(row);
  require_sound(row < rows, damaged_heap);
  const std::uint64_t row_begin = row == 0 ? 0 : std::uint64_t{1} << (bits + row_width_bits);
  const std::uint64_t column = (offset - begin - row_begin) >> bits;
  const std::uint64_t place = begin + row_begin + (column << bits);
  const std::string& block = cached(address, block_letters_bytes + 1 + widths_.address + offset_bytes() +
                                                 rows * row_width * widths_.address + block_checksum_bytes);
  ByteReader reader(block);
  take_start(reader, "FHIB", begin);
  reader.take(static_cast<std::size_t>(row * row_width + column) * widths_.address);
  const haddr_t below = reader.number(widths_.address);
  if (row < direct_rows()) return {below, place, std::uint64_t{1} << bits};
  return block_below(below, bits - kind_.block_bits - row_width_bits + 1, place, offset);
}

MessageHeap::Place MessageHeap::block_at(std::uint64_t offset) {
  if (root_rows_ > 0) return block_below(root_, root_rows_, 0, offset);
  return {root_, 0, std::uint64_t{1} << kind_.block_bits};
}

std::string MessageHeap::in_block(std::uint64_t offset, std::uint64_t bytes) {
  require_sound(offset < std::uint64_t{1} << kind_.address_bits, damaged_heap);
  const Place place = block_at(offset);
  const std::string& block = cached(place.address, place.bytes);
  ByteReader reader(block);
  const std::uint64_t start = take_start(reader, "FHDB", place.begin) + block_checksum_bytes;
  const std::uint64_t at = offset - place.begin;
  require_sound(at >= start && at < place.bytes && bytes <= place.bytes - at, damaged_heap);
  return block.substr(static_cast<std::size_t>(at), static_cast<std::size_t>(bytes));
}

std::string MessageHeap::large(std::uint64_t id) {
  if (large_.empty())
    each_record(bytes_at_, widths_, large_tree_, {1, widths_.address + 2 * widths_.size}, [&](std::string_view record) {
      ByteReader reader(record);
      const haddr_t address = reader.number(widths_.address);
      const std::uint64_t bytes = reader.number(widths_.size);
      require_sound(large_.try_emplace(reader.number(widths_.size), address, bytes).second, damaged_heap);
    });
  const auto found = large_.find(id);
  require_sound(found != large_.end(), damaged_heap);
  return bytes_at_(found->second.first, found->second.second);
}

std::string MessageHeap::at(std::string_view id) try {
  constexpr std::uint64_t in_a_block = 0x00, by_itself = 0x10;
  constexpr std::size_t length_bytes = 2;
  ByteReader reader(id);
  const std::uint64_t kind = reader.number(1);
  if (kind == by_itself) {
    require_sound(widths_.address + widths_.size > kind_.id_bytes - 1,
                  unusual_heap);  // else it would tell where itself
    return large(reader.number(kind_.id_bytes - 1));
  }
  require_sound(kind == in_a_block, damaged_heap);
  const std::uint64_t offset = reader.number(offset_bytes());
  return in_block(offset, reader.number(length_bytes));
} catch (const NotKnownHere&) {
  throw Unsound{damaged_heap};
}

}  // namespace modebank::hdf5
