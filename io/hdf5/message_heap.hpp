#pragma once

#include <hdf5.h>

#include <map>
#include <string>
#include <string_view>

#include "io/hdf5/record_tree.hpp"

namespace modebank::hdf5 {

/// How HDF5 lays out the heap of an object's many attributes, or of a group's many links.
struct HeapKind {
  std::size_t id_bytes;        ///< of what leads to an object
  std::uint64_t block_bits;    ///< of the smallest block's size
  std::uint64_t address_bits;  ///< of places in the heap
};
inline constexpr HeapKind attribute_heap{8, 10, 40}, link_heap{7, 9, 32};

/// A fractal heap of such a kind, read as HDF5 1.10 reads it, but for what does not fit: HDF5 hands what it finds there
/// to decoders that do not know where it ends. Member functions throw Unsound.
class MessageHeap {
 public:
  /// `bytes_at` must outlive it.
  MessageHeap(const BytesAt& bytes_at, const Widths& widths, haddr_t address, const HeapKind& kind);
  /// The message that an identifier leads to.
  std::string at(std::string_view id);

 private:
  struct Place {
    haddr_t address;
    std::uint64_t begin, bytes;  ///< in the heap
  };

  std::uint64_t row_bits(std::uint64_t row) const { return kind_.block_bits + (row > 0 ? row - 1 : 0); }
  std::uint64_t direct_rows() const;
  std::uint64_t row_of(std::uint64_t offset) const;
  std::size_t offset_bytes() const { return static_cast<std::size_t>(kind_.address_bits / 8); }
  /// Takes what every block begins with; returns the bytes of it.
  std::size_t take_start(ByteReader& reader, std::string_view letters, std::uint64_t begin) const;
  Place block_at(std::uint64_t offset);
  Place block_below(haddr_t address, std::uint64_t rows, std::uint64_t begin, std::uint64_t offset);
  std::string in_block(std::uint64_t offset, std::uint64_t bytes);
  std::string large(std::uint64_t id);
  const std::string& cached(haddr_t address, std::uint64_t bytes);

  const BytesAt& bytes_at_;
  Widths widths_;
  haddr_t address_;
  HeapKind kind_;
  haddr_t root_ = 0, large_tree_ = 0;
  std::uint64_t root_rows_ = 0;  ///< 0: the root is a block itself
  std::map<haddr_t, std::string> blocks_;
  std::map<std::uint64_t, std::pair<haddr_t, std::uint64_t>> large_;  ///< by identifier
};

}  // namespace modebank::hdf5
