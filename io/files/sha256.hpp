#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>

struct evp_md_ctx_st;  // a type of libcrypto

namespace modebank {

/// Incremental SHA-256 (FIPS 180-4), computed by libcrypto. Throws std::runtime_error if libcrypto lacks SHA-256.
class Sha256 {
 public:
  Sha256();

  void update(const void* data, std::size_t bytes);
  void update(std::string_view bytes) { update(bytes.data(), bytes.size()); }
  /// The hash of the data so far, as 64 lowercase hex digits. More data may follow.
  std::string hex() const;

 private:
  struct Free {
    void operator()(evp_md_ctx_st* context) const;
  };
  using Context = std::unique_ptr<evp_md_ctx_st, Free>;

  Context context_;
};

/// Whether a text is a SHA-256, that is, 64 lowercase hexadecimal digits.
bool is_sha256(std::string_view text);

std::string sha256_hex(std::string_view bytes);

}  // namespace modebank
