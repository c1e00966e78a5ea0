#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

namespace modebank {

enum class Compression { none, bz2, lz4, zstd };

/// Memory that is reused from chunk to chunk.
class Buffer {
 public:
  /// Makes room for `bytes`; the first `kept` bytes keep their content.
  char* reserve(std::size_t bytes, std::size_t kept);
  char* data() { return bytes_.get(); }
  std::size_t capacity() const { return capacity_; }

 private:
  std::unique_ptr<char[]> bytes_;
  std::size_t capacity_ = 0;
};

struct Unpacked {
  std::string_view bytes;  ///< bytes in the buffer: all, or those before the error
  std::string failure;     ///< reason of an error, else empty
};

/// Decompresses a chunk that declares `declared` bytes. Memory grows with the actual output, so a false size costs no
/// memory. More bytes than declared are an error.
Unpacked unpack(Compression compression, std::string_view packed, std::uint64_t declared, Buffer& buffer);

/// Size that a zstd frame declares; if it declares none, more than any message has.
std::uint64_t zstd_content_bytes(std::string_view packed);

}  // namespace modebank
