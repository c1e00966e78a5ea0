#include "app/view/secret.hpp"

#include <fmt/format.h>
#include <sys/random.h>

#include <array>
#include <cerrno>
#include <system_error>

namespace modebank::app::view {

std::string random_secret() {
  std::array<unsigned char, 16> bytes{};
  // As few bytes come whole or not at all, once the kernel has gathered enough since boot.
  if (::getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size()))
    throw std::system_error(errno, std::generic_category(), "no random numbers for the page's token");
  std::string text;
  for (const unsigned char byte : bytes) text += fmt::format("{:02x}", byte);
  return text;
}

bool same_secret(std::string_view given, std::string_view secret) {
  if (given.size() != secret.size() || secret.empty()) return false;  // its length is no secret
  volatile unsigned char different = 0;
  for (std::size_t i = 0; i < secret.size(); ++i)
    different = static_cast<unsigned char>(different | (given[i] ^ secret[i]));
  return different == 0;
}

}  // namespace modebank::app::view
