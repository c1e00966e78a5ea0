#include "io/files/temporary_file.hpp"

#include <algorithm>
#include <chrono>
#include <random>
#include <string_view>
#include <system_error>
#include <vector>

namespace modebank {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t word_digits = 12;
constexpr std::string_view mark = ".modebank-", suffix = ".tmp", hexadecimal = "0123456789abcdef";

bool is_temporary_name(std::string_view name) {
  constexpr std::size_t tail = mark.size() + word_digits + suffix.size();
  if (name.size() <= tail || name.front() != '.' || !name.ends_with(suffix)) return false;
  name.remove_prefix(name.size() - tail);
  return name.starts_with(mark) && name.find_first_not_of(hexadecimal, mark.size()) == mark.size() + word_digits;
}

}  // namespace

std::string random_word() {
  std::random_device chance;
  std::string word;
  while (word.size() < word_digits) word += hexadecimal[chance() % hexadecimal.size()];
  return word;
}

fs::path temporary_path(const fs::path& target) {
  constexpr std::size_t longest_name = 255;  // limit of a file name's length, in bytes
  const std::string end = std::string(mark) + random_word() + std::string(suffix);
  std::string name = "." + target.filename().string();
  name.resize(std::min(name.size(), longest_name - end.size()));
  return target.parent_path() / (name + end);
}

bool is_leftover(const fs::path& path) {
  std::error_code error;
  if (!is_temporary_name(path.filename().string())) return false;
  const fs::file_time_type written = fs::last_write_time(path, error);
  return !error && fs::file_time_type::clock::now() - written > std::chrono::hours(24);
}

void remove_leftovers(const fs::path& folder) {
  std::error_code error;
  std::vector<fs::path> left;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error))
    if (is_leftover(entry->path())) left.push_back(entry->path());
  for (const fs::path& path : left) fs::remove_all(path, error);  // this removes links without following them
}

}  // namespace modebank
