#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

namespace modebank {

enum class Compression { none, bz2, lz4, zstd };

/// Memory that is used again from chunk to chunk.
class Buffer {
 public:
  /// Room for `bytes`, of which the first `kept` stay as they are.
  char* reserve(std::size_t bytes, std::size_t kept);
  char* data() { return bytes_.get(); }
  std::size_t capacity() const { return capacity_; }

 private:
  std::unique_ptr<char[]> bytes_;
  std::size_t capacity_ = 0;
};

struct Unpacked {
  std::string_view bytes;  ///< in the buffer: all, or what came before the failure
  std::string failure;     ///< why it is not all, or empty
};

/// Takes a chunk apart that says it holds `declared` bytes. Memory grows with what really comes out, so that a false
/// size costs none; more than declared is a failure.
Unpacked unpack(Compression compression, std::string_view packed, std::uint64_t declared, Buffer& buffer);

/// What a frame of zstd says it holds; more than any message when it does not say.
std::uint64_t zstd_content_bytes(std::string_view packed);

}  // namespace modebank
