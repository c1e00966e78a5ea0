#include "app/chain/stage_file.hpp"

#include <fmt/format.h>

#include "io/files/sha256.hpp"

namespace modebank {

std::string stage_file_name(Stage stage, std::string_view key) { return fmt::format("{}-{}.h5", name_of(stage), key); }

bool is_stage_file_name(std::string_view name) {
  constexpr std::string_view ending = ".h5";
  const std::size_t dash = name.find('-');
  if (dash == std::string_view::npos || !name.ends_with(ending)) return false;
  name.remove_suffix(ending.size());
  return parse_name<Stage>(name.substr(0, dash)) && is_sha256(name.substr(dash + 1));
}

}  // namespace modebank
