#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace modebank {

/// Incremental SHA-256 (FIPS 180-4).
class Sha256 {
 public:
  void update(const void* data, std::size_t bytes);
  void update(std::string_view bytes) { update(bytes.data(), bytes.size()); }
  /// Lowercase hex (64 characters) of everything so far; more may follow.
  std::string hex() const;

  static constexpr std::size_t block_bytes = 64;
  using State = std::array<std::uint32_t, 8>;

 private:
  State state_{0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a, 0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19};
  std::array<unsigned char, block_bytes> block_{};  ///< the begun block: bytes_ % block_bytes are there
  std::uint64_t bytes_ = 0;                         ///< so far
};

/// Whether a text is one: 64 lowercase hexadecimal digits.
bool is_sha256(std::string_view text);

std::string sha256_hex(std::string_view bytes);

}  // namespace modebank
