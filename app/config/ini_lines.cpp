#include "app/config/ini_lines.hpp"

#include <fmt/format.h>

#include <boost/algorithm/string.hpp>
#include <boost/program_options.hpp>
#include <charconv>
#include <optional>
#include <sstream>
#include <utility>

#include "ident/base/printable.hpp"
#include "ident/base/utf8.hpp"

namespace po = boost::program_options;

namespace modebank::app {

bool is_path(const std::string& key) {
  return key == "data.root" || key == "archive.output" || key == "archive.bank" || key == "study.output" ||
         key == "simulate.output";
}

bool takes_quotes(const std::string& key) {
  if (is_path(key)) return true;
  for (const char* of_names : {"derive", "where", "state", "input", "truth", "time", "run", "label", "na"})
    if (key == std::string("data.") + of_names) return true;
  return false;
}

std::string path_text(const std::string& path) {
  const std::string shown = printable_name(path);
  if (shown == path && boost::trim_copy(path) == path && path.find('#') == std::string::npos && !path.starts_with('"'))
    return path;
  std::string text = "\"";
  for (std::size_t i = 0; i < path.size(); ++i) {
    const char c = path[i];
    constexpr char second_set = '\xc2';  // first UTF-8 byte of those control characters that have two bytes
    if (is_control(c) || c == second_set || (i > 0 && path[i - 1] == second_set))
      text += fmt::format("\\x{:02x}", static_cast<unsigned char>(c));
    else
      text += (c == '"' || c == '\\' ? "\\" : "") + std::string(1, c);
  }
  return text + "\"";
}

namespace {

/// The quoted value at the start of `text`. Nullopt if text follows the quotes that is not a comment.
std::optional<std::string> unquoted(std::string_view text) {
  std::string value;
  std::size_t i = 1;
  for (; i < text.size() && text[i] != '"'; ++i) {
    if (text[i] != '\\') {
      value += text[i];
      continue;
    }
    if (++i == text.size()) return std::nullopt;
    unsigned code = 0;
    if (text[i] == 'x' && i + 2 < text.size() &&
        std::from_chars(text.data() + i + 1, text.data() + i + 3, code, 16).ptr == text.data() + i + 3) {
      value += static_cast<char>(code);
      i += 2;
    } else {
      value += text[i] == 'n' ? '\n' : text[i];
    }
  }
  if (i >= text.size()) return std::nullopt;
  const std::string rest = boost::trim_copy(std::string(text.substr(i + 1)));
  return rest.empty() || rest.front() == '#' ? std::optional(value) : std::nullopt;
}

/// A line with a quoted value, for a key that takes_quotes. `section`: as in the file, "[data]".
std::optional<FileEntry> quoted_entry(const std::string& section, const std::string& line, int number) {
  const std::size_t equal = line.find('='), quote = equal == std::string::npos ? equal : line.find('"', equal);
  if (quote == std::string::npos || !boost::trim_copy(line.substr(equal + 1, quote - equal - 1)).empty())
    return std::nullopt;
  const std::string name = boost::trim_copy(line.substr(0, equal));
  const std::string key = section.empty() ? name : section.substr(1, section.size() - 2) + "." + name;
  if (!takes_quotes(key)) return std::nullopt;
  const std::optional<std::string> value = unquoted(std::string_view(line).substr(quote));
  return value ? std::optional(FileEntry{key, *value, number}) : std::nullopt;
}

}  // namespace

std::vector<FileEntry> parse_lines(std::string_view text, const std::string& path, Faults& faults) {
  std::string storage;
  std::istringstream stream{std::string(utf8_or_windows_1252(text, storage))};
  static const po::options_description no_options;
  std::vector<FileEntry> entries;
  std::string section, line;
  for (int number = 1; std::getline(stream, line); ++number) {
    if (number == 1 && line.rfind("\xEF\xBB\xBF", 0) == 0) line.erase(0, 3);
    const std::size_t hash = line.find('#');
    const bool touches = hash != std::string::npos && hash > 0 && line[hash - 1] != ' ' && line[hash - 1] != '\t';
    std::string content = boost::trim_copy(line.substr(0, hash));
    if (content.empty()) continue;
    if (content.front() == '[' && content.back() == ']') {
      section = content;
      continue;
    }
    if (auto entry = quoted_entry(section, line, number)) {
      entries.push_back(*std::move(entry));
      continue;
    }
    std::istringstream one(section + "\n" + line + "\n");
    try {
      const po::parsed_options parsed = po::parse_config_file(one, no_options, true);
      for (const po::option& option : parsed.options)
        entries.push_back({option.string_key, option.value.at(0), number, hash != std::string::npos, touches});
    } catch (const po::error&) {
      faults.add(fmt::format("{}:{}: '{}' is neither [section] nor key = value", path, number, content));
    }
  }
  return entries;
}

}  // namespace modebank::app
