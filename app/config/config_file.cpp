#include "app/config/config_file.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <boost/algorithm/string.hpp>
#include <cstdlib>
#include <fstream>
#include <iterator>

#include "app/config/faults.hpp"
#include "app/config/ini_lines.hpp"
#include "app/config/option_table.hpp"
#include "ident/base/nearest_name.hpp"
#include "ident/base/printable.hpp"
#include "ident/base/utf8.hpp"
#include "io/files/output_file.hpp"
#include "io/files/read_file.hpp"
#include "io/files/sha256.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app {
namespace {

std::string section_list() {
  std::vector<std::string> sections;
  for (const Option& option : option_table())
    if (sections.empty() || sections.back() != option.section()) sections.push_back(option.section());
  return boost::join(sections, ", ");
}

const Option& known_option(const std::string& where, const std::string& key) {
  const Option* option = find_option(key);
  if (option) return *option;
  const std::string section_hint =
      key.find('.') == std::string::npos ? fmt::format(" (keys belong to a section: {})", section_list()) : "";
  throw ConfigurationError(fmt::format("{}: unknown key {}{}{}", where, key, nearest_key_hint(key), section_hint));
}

}  // namespace

void set_option(Config& config, const Option& option, const std::string& where, const std::string& value,
                bool has_comment) {
  const std::string& key = option.key;
  if (holds_controls(value) && !is_path(key))
    throw ConfigurationError(fmt::format("{}: {} = '{}' contains control characters{}", where, key, printable(value),
                                         takes_quotes(key) ? "; rename that column in the log" : ""));
  try {
    option.set(config, value);
  } catch (const std::invalid_argument& error) {
    const std::string unit = option.unit.empty() ? "" : " [" + option.unit + "]";
    const std::string hint = has_comment ? "; # starts a comment, so a value cannot contain it" : "";
    throw ConfigurationError(
        fmt::format("{}: {} = '{}' {}; allowed: {}{}{}", where, key, value, error.what(), option.range, unit, hint));
  }
}

namespace {

void apply(Config& config, const std::string& where, const std::string& key, const std::string& value,
           bool has_comment) {
  set_option(config, known_option(where, key), where, value, has_comment);
}

/// If the command line sets a repeatable key, all lines of this key in the file are ignored.
void clear_overridden(Config& config, const KeyValues& overrides) {
  for (const auto& [key, value] : overrides)
    if (const Option* option = find_option(key); option && option->repeatable) option->set(config, "");
}

/// If the command line sets window.model = auto, the lags in the file are ignored.
void forget_lags(Config& config, const KeyValues& overrides) {
  if (std::find(overrides.begin(), overrides.end(), KeyValues::value_type("window.model", "auto")) == overrides.end())
    return;
  const FitOptions standard;
  config.window.state_lags = standard.state_lags;
  config.window.input_lags = standard.input_lags;
  config.window.input_delay = standard.input_delay;
  config.structure = {.length = config.structure.length, .step = config.structure.step};
}

void apply_override(Config& config, const std::string& key, const std::string& value) {
  if (value.find('#') != std::string::npos && !takes_quotes(key))
    throw ConfigurationError(fmt::format(
        "--{}: '{}' holds a #, which starts a comment in configuration files, so no value can hold one", key, value));
  apply(config, "--" + key, key, boost::trim_copy(value), false);
}

void apply_overrides(Config& config, const KeyValues& overrides, Faults& faults) {
  clear_overridden(config, overrides);
  forget_lags(config, overrides);
  for (const auto& [key, value] : overrides) faults.collect([&] { apply_override(config, key, value); });
}

/// Sets the defaults that depend on the file's folder and name.
void apply_defaults_of_file(Config& config, const std::filesystem::path& path, Origins& origins) {
  if (config.data.root.empty()) {
    const char* environment = std::getenv("MODEBANK_DATA");
    const bool set = environment && *environment;
    config.data.root = set ? environment : std::filesystem::absolute(path).parent_path().string();
    origins["data.root"] = set ? "$MODEBANK_DATA" : "folder of the file";
  }
  config.data.root = std::filesystem::absolute(config.data.root).lexically_normal().string();
  const auto name_after_file = [&](std::string& value, const std::string& key, const char* ending) {
    if (!value.empty()) return;
    value = path.stem().string() + ending;
    origins[key] = "name of the file";
  };
  name_after_file(config.archive.output, "archive.output", ".h5");
  name_after_file(config.study.output, "study.output", ".study");
}

}  // namespace

std::string nearest_key_hint(const std::string& key) {
  const std::string name = boost::trim_left_copy_if(key, boost::is_any_of("-"));
  std::vector<std::string> keys;
  for (const Option& option : option_table()) keys.push_back(option.key);
  return did_you_mean(name, keys);
}

bool has_ending_of_logs(const std::filesystem::path& path) {
  std::string ending = path.extension().string();
  boost::to_lower(ending);
  for (const char* of_logs : {".csv", ".tsv", ".dat", ".bag", ".mcap", ".db3", ".mat", ".hdf5"})
    if (ending == of_logs) return true;
  return false;
}

bool looks_like_log(const std::filesystem::path& path) {
  if (has_ending_of_logs(path)) return true;
  std::ifstream stream(path, std::ios::binary);
  std::string first(512, ' ');
  stream.read(first.data(), static_cast<std::streamsize>(first.size()));
  return first.find('\0') != std::string::npos;
}

Config load_config(const std::filesystem::path& path, const KeyValues& overrides, Origins* origins) {
  std::ifstream stream(path);
  if (stream && looks_like_log(path))
    throw ConfigurationError(
        fmt::format("{0} is a log, not a configuration: `modebank run {0}` makes a model of it, `modebank init {0}` a "
                    "configuration",
                    path.string()));
  if (!stream || std::filesystem::is_directory(path))
    throw ConfigurationError(fmt::format("cannot read the configuration {}", path.string()));
  return config_of_text({std::istreambuf_iterator<char>(stream), {}}, path, overrides, origins);
}

namespace {

/// The lines of a file, applied one after the other.
class FileLines {
 public:
  FileLines(const std::filesystem::path& path, Config& config, Origins& origins)
      : path_(path), config_(config), origins_(origins) {}

  void apply_line(const FileEntry& entry) {
    const std::string where = fmt::format("{}:{}", path_.string(), entry.line);
    const Option* option = find_option(entry.key);
    const auto [earlier, fresh] = seen_.emplace(entry.key, entry.line);
    if (!fresh && !(option && option->repeatable))
      throw ConfigurationError(fmt::format("{}: {} is already set in line {}", where, entry.key, earlier->second));
    apply(config_, where, entry.key, entry.value, entry.has_comment);
    origins_[entry.key] = fresh ? where : origins_[entry.key] + "\n" + where;
    if (entry.comment_touches_value)
      spdlog::warn(
          "{}: {} is cut to '{}': # starts a comment{}", where, entry.key, entry.value,
          takes_quotes(entry.key) ? "; a value that holds one stands in double quotes" : ", so no value can hold one");
    // A relative data.root in a file is relative to the folder of that file, not to the current folder.
    if (entry.key == "data.root" && !config_.data.root.empty())
      config_.data.root = (std::filesystem::absolute(path_).parent_path() / config_.data.root).string();
  }

 private:
  const std::filesystem::path& path_;
  Config& config_;
  Origins& origins_;
  std::map<std::string, int> seen_;  ///< number of the line that sets a key
};

}  // namespace

Config config_of_text(const std::string& bytes, const std::filesystem::path& path, const KeyValues& overrides,
                      Origins* origins) {
  Config config;
  Origins found;
  Faults faults;
  if (!is_utf8(bytes)) spdlog::warn("{}: {}", path.string(), read_as_windows_1252);
  FileLines lines(path, config, found);
  for (const FileEntry& entry : parse_lines(bytes, path.string(), faults))
    faults.collect([&] { lines.apply_line(entry); });
  apply_overrides(config, overrides, faults);
  faults.refuse();
  for (const auto& [key, value] : overrides) found[key] = "--" + key;
  apply_defaults_of_file(config, path, found);
  if (origins) *origins = std::move(found);
  return config;
}

namespace {

/// The keys of a resolved configuration that still exist and for which `wanted` returns true.
template <class Wanted>
Config config_of(const std::string& resolved, Wanted wanted) {
  Config config;
  for (const auto& [key, value] : resolved_values(resolved))
    if (wanted(key) && find_option(key)) apply(config, "stored configuration", key, value, false);
  return config;
}

}  // namespace

Config stored_config(const std::string& resolved, const KeyValues& overrides) {
  Config config = config_of(resolved, [](const std::string& key) {
    return key.rfind("data.", 0) == 0 || key.rfind("filter.", 0) == 0 || key == "job.seed";
  });
  Faults faults;
  apply_overrides(config, overrides, faults);
  faults.refuse();
  return config;
}

bool is_configuration(const std::filesystem::path& path) {
  constexpr std::uintmax_t largest = 1 << 22;
  if (std::filesystem::file_size(path) > largest) return false;
  const std::string text = read_file(path);
  try {
    const std::map<std::string, std::string> values = resolved_values(text);
    return std::any_of(values.begin(), values.end(), [](const auto& value) { return find_option(value.first); });
  } catch (const ConfigurationError&) {
    return ("\n" + text).find("\n[data]") != std::string::npos;  // broken, but no log
  }
}

void check_configuration_output(const std::string& option, const std::filesystem::path& path,
                                const std::vector<std::filesystem::path>& sources, bool force) {
  check_output({option, path, {"a configuration", is_configuration}}, sources);
  if (!force && std::filesystem::exists(path))
    throw ConfigurationError(
        fmt::format("{} exists: name another file (-o FILE), or overwrite it with --force", path.string()));
}

Config resolved_config(const std::string& resolved) {
  return config_of(resolved, [](const std::string&) { return true; });
}

std::string resolved_text(const Config& config) {
  std::string text, section;
  for (const Option& option : option_table()) {
    if (option.section() != section) text += fmt::format("{}[{}]\n", text.empty() ? "" : "\n", option.section());
    section = option.section();
    std::vector<std::string> values;
    boost::split(values, option.get(config), [](char c) { return c == '\n'; });
    if (is_path(option.key)) values = {option.get(config)};
    if (takes_quotes(option.key)) std::transform(values.begin(), values.end(), values.begin(), path_text);
    for (const std::string& value : values) text += option.name() + " =" + (value.empty() ? "" : " " + value) + "\n";
  }
  return text;
}

std::map<std::string, std::string> resolved_values(const std::string& resolved) {
  Faults faults;
  const std::vector<FileEntry> entries = parse_lines(resolved, "stored configuration", faults);
  faults.refuse();
  std::map<std::string, std::string> values;
  for (const FileEntry& entry : entries) {
    std::string& value = values[entry.key];
    value += (value.empty() ? "" : "\n") + entry.value;
  }
  return values;
}

bool decides_numbers(const std::string& key) {
  const Option* const option = find_option(key);
  return option && option->stage;
}

std::string config_hash(const Config& config) {
  std::vector<std::string> lines;
  for (const Option& option : option_table()) {
    if (option.stage) lines.push_back(option.key + "=" + option.get(config) + "\n");
  }
  std::sort(lines.begin(), lines.end());
  return sha256_hex(boost::join(lines, ""));
}

}  // namespace modebank::app
