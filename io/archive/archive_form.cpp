#include "io/archive/archive_form.hpp"

#include <array>
#include <exception>
#include <string_view>

#include "io/archive/bank/open_archive.hpp"
#include "io/archive/inspect.hpp"
#include "io/files/read_file.hpp"
#include "io/files/sha256.hpp"

namespace modebank {

FileForm archive_form() {
  return {"an archive", [](const std::filesystem::path& path) {
            constexpr std::string_view signature = "\x89HDF\r\n\x1a\n";
            constexpr std::size_t hash_bytes = 64;
            std::array<char, user_block_bytes + signature.size()> front{};
            open_file(path).read(front.data(), front.size());
            const std::string_view bytes(front.data(), front.size());
            const bool is_ours = is_sha256(bytes.substr(0, hash_bytes)) || bytes.substr(user_block_bytes) == signature;
            return is_ours && !is_table_of_runs(path);
          }};
}

bool is_table_of_runs(const std::filesystem::path& path) {
  try {
    const nlohmann::json members = inspect(path, "/").at("members");
    return members.contains("study") || members.contains("plan");
  } catch (const std::exception&) {
    return false;
  }
}

}  // namespace modebank
