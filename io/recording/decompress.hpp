#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

namespace modebank {

enum class Compression { none, bz2, lz4, zstd };

/// Memory that is used again for each chunk.
class Buffer {
 public:
  /// Makes room for `bytes` bytes. The first `kept` bytes keep their content.
  char* reserve(std::size_t bytes, std::size_t kept);
  char* data() { return bytes_.get(); }
  std::size_t capacity() const { return capacity_; }

 private:
  std::unique_ptr<char[]> bytes_;
  std::size_t capacity_ = 0;
};

struct Unpacked {
  std::string_view bytes;  ///< number of bytes in the buffer: all bytes, or those before the error
  std::string failure;     ///< reason of an error; empty if there is none
};

/// Decompresses a chunk that declares a size of `declared` bytes. Memory grows with the actual output, so a wrong size
/// costs no memory. Output beyond the declared size is an error.
Unpacked unpack(Compression compression, std::string_view packed, std::uint64_t declared, Buffer& buffer);

/// The size that a zstd frame declares. If it declares none, a number larger than any message.
std::uint64_t zstd_content_bytes(std::string_view packed);

}  // namespace modebank
