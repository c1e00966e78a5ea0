#pragma once

#include <hdf5.h>

#include <array>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "io/hdf5/handle.hpp"
#include "io/hdf5/message_heap.hpp"
#include "io/hdf5/message_soundness.hpp"

namespace modebank::hdf5 {

/// Judges the object headers of a file that others wrote before HDF5 1.10 decodes them: it decodes attributes and
/// datatypes from their messages without knowing where those end. Versions 1 and 2 are judged, the latter also without
/// a checksum that fits, which HDF5 looks at, and with them what of an object's messages lies in a heap: many links,
/// many attributes.
///
/// HDF5 reads a header with up to 512 bytes at its address, then what is left of its first chunk, then the chunks that
/// continue it, and nothing else in between. All of them are judged at the first of these reads.
class HeaderGuard {
 public:
  /// Of an open file with `size` bytes; both must outlive this.
  HeaderGuard(int descriptor, haddr_t size, FileOf of) : descriptor_(descriptor), size_(size), of_(of) {}
  /// Bytes in which HDF5 looks for the file's superblock, which says how wide addresses are and where they count from.
  void see_superblock(haddr_t at, std::string_view bytes);
  /// Metadata of the kind that object headers are; `end` is that of what HDF5 uses of the file. Addresses count from
  /// the file's first byte. Throws Unsound.
  void judge(haddr_t at, std::string_view bytes, haddr_t end);

 private:
  struct Chunk {
    haddr_t address;
    std::uint64_t bytes;
  };
  using See = std::function<void(const RawMessage&)>;

  std::vector<Chunk> walk(haddr_t at, std::string_view begin, const See& see) const;
  void see_messages(const HeaderStart& header, std::string_view messages, std::vector<Chunk>& chunks,
                    const See& see) const;
  std::string bytes_at(haddr_t at, std::uint64_t count) const;
  /// The same at an address as the file states it.
  std::string content_at(haddr_t address, std::uint64_t count) const;
  std::uint64_t type_at(haddr_t address);
  void judge_message(const RawMessage& message);
  void judge_dense(const RawMessage& message);
  struct DenseTree;
  void judge_tree(haddr_t address, const DenseTree& tree, std::uint64_t kind, MessageHeap& heap);

  int descriptor_;
  haddr_t size_;
  FileOf of_;
  haddr_t base_ = 0;  ///< of addresses in the file
  Widths widths_;
  std::vector<Chunk> expected_;                  ///< what HDF5 is to read next of a header that was judged
  std::map<haddr_t, std::uint64_t> type_bytes_;  ///< of headers with a datatype
  std::set<std::array<haddr_t, 3>> dense_;       ///< heaps and trees that were judged
  std::uint64_t dense_bytes_ = 0;                ///< of the messages in them
};

}  // namespace modebank::hdf5
