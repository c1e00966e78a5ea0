#include "app/cli/log/log_configuration.hpp"

#include <algorithm>
#include <utility>

namespace modebank::app {
void LogConfiguration::set(const std::string& key, const std::string& value, const std::string& why) {
  std::erase_if(keys_,
                [&](const Key& earlier) { return earlier.key == key && (!value.empty() || earlier.value.empty()); });
  keys_.push_back({key, value, why});
}

void LogConfiguration::explain(const std::string& key, const std::string& why) {
  for (ProposedKey& stated : proposal_.keys)
    if ("data." + stated.key == key) stated.why = why;
  for (Key& stated : keys_)
    if (stated.key == key) stated.why = why;
}

std::string LogConfiguration::text() const {
  std::vector<std::pair<std::string, std::string>> sections;  // with their lines, in the order of their first keys
  for (const auto& [key, value, why] : keys_) {
    const std::string name = key.substr(0, key.find('.'));
    auto section = std::find_if(sections.begin(), sections.end(), [&](const auto& s) { return s.first == name; });
    if (section == sections.end()) section = sections.insert(section, {name, ""});
    if (!why.empty()) section->second += "# " + why + "\n";
    if (!value.empty()) section->second += key.substr(name.size() + 1) + " = " + value + "\n";
  }
  std::string text = configuration_text(proposal_, command_);
  for (const auto& [name, lines] : sections) text += "\n[" + name + "]\n" + lines;
  return text;
}

Config LogConfiguration::config(const std::filesystem::path& file, const std::filesystem::path& archive) const {
  Config config = config_of_text(text(), file, {{"archive.output", archive.string()}});
  validate(config);
  return config;
}

}  // namespace modebank::app
