#include <fmt/format.h>

#include <boost/algorithm/string.hpp>
#include <cstdlib>
#include <fstream>
#include <sstream>

#include "app/cli/check/check_suggestions.hpp"
#include "app/config/edit_file.hpp"
#include "app/config/option_table.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app {
namespace {

std::string content_of(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

void put(KeyEdit edit, std::vector<KeyEdit>& edits) {
  for (const std::string& value : edit.values)
    if (value.find('#') != std::string::npos)
      throw ConfigurationError(
          fmt::format("-o: {} = '{}' contains a #, which starts a comment in configuration files", edit.key, value));
  std::erase_if(edits, [&](const KeyEdit& earlier) { return earlier.key == edit.key; });
  edits.push_back(std::move(edit));
}

/// Relative data paths keep their meaning, even if the new file is in another folder.
void keep_root(const Config& config, const std::filesystem::path& output, std::vector<KeyEdit>& edits,
               const std::filesystem::path& file, const std::string& text) {
  const auto folder_of = [](const std::filesystem::path& path) {
    return std::filesystem::weakly_canonical(std::filesystem::absolute(path)).parent_path();
  };
  if (folder_of(file) == folder_of(output)) return;
  const char* environment = std::getenv("MODEBANK_DATA");
  const std::string stated = resolved_values(text)["data.root"];
  if (stated.empty() && environment && *environment) return;
  put({"data.root", {config.data.root}, "the folder from which the original file's data paths start"}, edits);
}

void put_suggested(const Suggestions& s, const Config& config, std::vector<KeyEdit>& edits) {
  for (const Trial& trial : s.trials) {
    if (!trial.accepted) continue;
    const std::string why = "modebank check: " + gain_reason(s, trial);
    for (const auto& [key, value] : changed_keys(config, trial.from, trial.to)) put({key, {value}, why}, edits);
  }
}

}  // namespace

std::string applied_text(const Suggestions& suggestions, const Config& config, const std::filesystem::path& file,
                         const KeyValues& overrides, const std::filesystem::path& output) {
  const std::string text = content_of(file);
  std::vector<KeyEdit> edits;
  keep_root(config, output, edits, file, text);
  for (const auto& [key, value] : overrides) {
    KeyEdit edit{key, {}, "from the command line of modebank check"};
    boost::split(edit.values, find_option(key)->get(config), [](char c) { return c == '\n'; });
    put(std::move(edit), edits);
  }
  put_suggested(suggestions, config, edits);
  return edited_text(text, edits);
}

}  // namespace modebank::app
