#include "io/files/sha256.hpp"

#include <openssl/evp.h>

#include <array>
#include <stdexcept>

namespace modebank {

namespace {

constexpr std::size_t hash_bytes = 32;

void require_success(bool success) {
  if (!success) throw std::runtime_error("libcrypto cannot compute SHA-256");
}

}  // namespace

void Sha256::Free::operator()(evp_md_ctx_st* context) const { EVP_MD_CTX_free(context); }

Sha256::Sha256() : context_(EVP_MD_CTX_new()) {
  require_success(context_ && EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr) == 1);
}

void Sha256::update(const void* data, std::size_t bytes) {
  require_success(EVP_DigestUpdate(context_.get(), data, bytes) == 1);
}

std::string Sha256::hex() const {
  // EVP_DigestFinal_ex ends a context, so the call gets a copy.
  const Context copy(EVP_MD_CTX_new());
  std::array<unsigned char, hash_bytes> hash;
  require_success(copy && EVP_MD_CTX_copy_ex(copy.get(), context_.get()) == 1 &&
                  EVP_DigestFinal_ex(copy.get(), hash.data(), nullptr) == 1);
  constexpr char digits[] = "0123456789abcdef";
  std::string text;
  for (const unsigned char byte : hash) {
    text += digits[byte >> 4];
    text += digits[byte & 15];
  }
  return text;
}

bool is_sha256(std::string_view text) {
  return text.size() == 2 * hash_bytes && text.find_first_not_of("0123456789abcdef") == std::string_view::npos;
}

std::string sha256_hex(std::string_view bytes) {
  Sha256 hash;
  hash.update(bytes);
  return hash.hex();
}

}  // namespace modebank
