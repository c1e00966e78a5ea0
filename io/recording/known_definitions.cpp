#include "io/recording/known_definitions.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "io/files/read_file.hpp"

namespace modebank {

namespace {

const std::map<std::string, std::string_view>& built_in() {
  static const std::map<std::string, std::string_view> parts = split_definitions("", known_definitions_text);
  return parts;
}

std::optional<std::string_view> find_built_in(const std::string& type) {
  const auto found = built_in().find(type);
  return found == built_in().end() ? std::nullopt : std::optional(found->second);
}

/// Whether a name that is used in a path leads to no other folder.
bool is_plain(std::string_view name) {
  return !name.empty() &&
         std::all_of(name.begin(), name.end(), [](unsigned char c) { return std::isalnum(c) || c == '_'; });
}

}  // namespace

std::optional<std::string_view> KnownDefinitions::from_folder(const std::string& type) const {
  const std::size_t slash = type.find('/');
  if (folder_.empty() || slash == std::string::npos) return {};
  const std::string package = type.substr(0, slash), name = type.substr(slash + 1);
  if (!is_plain(package) || !is_plain(name)) return {};
  const auto known = files_.find(type);
  if (known != files_.end()) return known->second;
  constexpr std::uintmax_t most_bytes = 1 << 20;
  const std::string file = name + ".msg";
  for (const auto& path : {folder_ / package / "msg" / file, folder_ / package / file, folder_ / file}) {
    std::error_code error;
    if (!std::filesystem::is_regular_file(path, error) || std::filesystem::file_size(path, error) > most_bytes)
      continue;
    return files_[type] = read_file(path);
  }
  return {};
}

std::vector<std::shared_ptr<const Schema>> KnownDefinitions::candidates(const std::string& type,
                                                                        std::string& problem) const {
  const std::string root = short_type(type);
  std::vector<std::shared_ptr<const Schema>> found;
  const auto consider = [&](const Schema::Lookup& lookup) {
    try {
      found.push_back(std::make_shared<Schema>(root, Dialect::ros2, lookup));
    } catch (const DefinitionError& error) {
      if (problem.empty()) problem = error.what();
    }
  };
  if (find_built_in(root)) consider(find_built_in);
  const std::string older = root + "@humble";
  if (find_built_in(older))
    consider([&](const std::string& name) { return find_built_in(name == root ? older : name); });
  if (found.empty() || from_folder(root))
    consider([&](const std::string& name) {
      const auto own = from_folder(name);
      return own ? own : find_built_in(name);
    });
  return found;
}

}  // namespace modebank
