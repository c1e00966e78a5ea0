#include "io/files/temporary_file.hpp"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <charconv>
#include <climits>
#include <csignal>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "ident/base/characters.hpp"

namespace modebank {

namespace {

namespace fs = std::filesystem;

constexpr char separator = '~';
constexpr std::string_view suffix = ".tmp";

/// What may stand in a part of a name: the separator, slashes and blanks may not.
std::string plain(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return !is_letter(c) && !is_digit(c) && c != '-' && c != '.'; }, '_');
  return text;
}

std::string content_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

std::string host_name() {
  std::array<char, 256> name{};
  if (::gethostname(name.data(), name.size() - 1) != 0) return {};
  return plain(name.data());
}

std::string boot_identifier() {
  std::string text = content_of("/proc/sys/kernel/random/boot_id");
  text.erase(std::remove_if(text.begin(), text.end(), [](char c) { return c == '-' || c == '\n'; }), text.end());
  return plain(text);
}

/// The number in "pid:[4026531836]".
std::string process_space() {
  std::error_code error;
  const std::string link = fs::read_symlink("/proc/self/ns/pid", error).string();
  std::string digits;
  std::copy_if(link.begin(), link.end(), std::back_inserter(digits), is_digit);
  return digits;
}

template <class Number>
std::optional<Number> number_in(std::string_view text) {
  Number number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

/// Field 22 of /proc/PROCESS/stat; the name in field 2 may hold blanks and brackets. 0 where it cannot be read.
std::uint64_t start_tick(const std::string& process) {
  constexpr std::size_t fields_between = 19;  // from 3, which follows the name, to 22
  const std::string line = content_of("/proc/" + process + "/stat");
  std::size_t at = line.rfind(") ");
  if (at == std::string::npos) return 0;
  at += 2;
  for (std::size_t field = 0; field < fields_between; ++field) {
    at = line.find(' ', at);
    if (at == std::string::npos) return 0;
    ++at;
  }
  const std::size_t end = std::min(line.find(' ', at), line.size());
  return number_in<std::uint64_t>(std::string_view(line).substr(at, end - at)).value_or(0);
}

std::vector<std::string_view> parts_of(std::string_view text) {
  std::vector<std::string_view> parts;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(separator, begin), text.size());
    parts.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return parts;
}

}  // namespace

ProcessIdentity this_process() {
  return {host_name(), boot_identifier(), process_space(), ::getpid(), start_tick("self")};
}

ProcessState state_of(const ProcessIdentity& process) {
  const ProcessIdentity here = this_process();
  // What the kernel does not tell cannot be compared.
  if (here.host.empty() || here.boot.empty() || here.space.empty()) return ProcessState::unknown;
  if (process.host != here.host || process.boot != here.boot || process.space != here.space)
    return ProcessState::unknown;
  if (::kill(static_cast<pid_t>(process.process), 0) != 0 && errno == ESRCH) return ProcessState::gone;
  const std::uint64_t began = start_tick(std::to_string(process.process));
  const bool another = began != 0 && process.start_tick != 0 && began != process.start_tick;
  return another ? ProcessState::gone : ProcessState::living;
}

std::string process_word(const ProcessIdentity& process) {
  std::string word = process.host;
  for (const std::string& part :
       {process.boot, process.space, std::to_string(process.process), std::to_string(process.start_tick)})
    word += separator + part;
  return word;
}

std::optional<ProcessIdentity> parse_process_word(std::string_view word) {
  const std::vector<std::string_view> parts = parts_of(word);
  if (parts.size() != 5) return std::nullopt;
  const auto process = number_in<std::int64_t>(parts[3]);
  const auto tick = number_in<std::uint64_t>(parts[4]);
  // Zero and negative numbers are groups of processes.
  if (!process || !tick || *process <= 0 || *process > INT_MAX) return std::nullopt;
  return ProcessIdentity{std::string(parts[0]), std::string(parts[1]), std::string(parts[2]), *process, *tick};
}

fs::path temporary_path(const fs::path& target) {
  constexpr std::size_t longest_name = 255;  // of a file, in bytes
  static std::atomic<unsigned> counter = 0;
  const std::string end =
      separator + process_word(this_process()) + separator + std::to_string(counter++) + std::string(suffix);
  std::string name = target.filename().string();
  name.resize(std::min(name.size(), longest_name - std::min(longest_name, end.size() + 1)));
  return target.parent_path() / ("." + name + end);
}

std::optional<TemporaryName> parse_temporary_name(std::string_view name) {
  if (name.empty() || name.front() != '.' || !name.ends_with(suffix)) return std::nullopt;
  const std::vector<std::string_view> parts = parts_of(name.substr(1, name.size() - 1 - suffix.size()));
  constexpr std::size_t behind_target = 6;  // the process's five and the file's number; the target may hold separators
  if (parts.size() <= behind_target || !number_in<unsigned>(parts.back())) return std::nullopt;
  const char* const word = parts[parts.size() - behind_target].data();
  const auto owner = parse_process_word({word, static_cast<std::size_t>(parts.back().data() - 1 - word)});
  if (!owner) return std::nullopt;
  return TemporaryName{{name.data() + 1, word - 1}, *owner};
}

std::size_t remove_leftovers(const fs::path& folder) {
  std::size_t removed = 0;
  std::error_code error;
  std::vector<fs::path> left;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error))
    if (const auto name = parse_temporary_name(entry->path().filename().string());
        name && state_of(name->owner) == ProcessState::gone)
      left.push_back(entry->path());
  for (const fs::path& path : left) {
    fs::remove_all(path, error);  // links are removed, not followed
    if (!error) ++removed;
  }
  return removed;
}

}  // namespace modebank
