#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>

namespace modebank {

/// Incremental SHA-256 (FIPS 180-4) by OpenSSL.
class Sha256 {
 public:
  Sha256();
  ~Sha256();
  Sha256(Sha256&&) noexcept;
  Sha256& operator=(Sha256&&) noexcept;

  void update(const void* data, std::size_t bytes);
  void update(std::string_view bytes) { update(bytes.data(), bytes.size()); }
  /// Lowercase hex (64 characters) of everything so far; more may follow.
  std::string hex() const;

 private:
  struct Context;
  std::unique_ptr<Context> context_;
};

std::string sha256_hex(std::string_view bytes);

}  // namespace modebank
