#include "app/cli/log/log_configuration.hpp"

#include <algorithm>
#include <utility>

namespace modebank::app {
namespace {

const std::string data_section = "data.";

}  // namespace

void LogConfiguration::set(const std::string& key, const std::string& value, const std::string& why) {
  if (key.starts_with(data_section)) {
    const std::string name = key.substr(data_section.size());
    if (value.empty())
      proposal_.add(name, "", why);
    else
      proposal_.set(name, value, why);
    return;
  }
  std::erase_if(keys_,
                [&](const Key& earlier) { return earlier.is(key) && (!value.empty() || earlier.value.empty()); });
  const std::size_t dot = key.find('.');
  keys_.push_back({key.substr(0, dot), key.substr(dot + 1), value, why});
}

void LogConfiguration::explain(const std::string& key, const std::string& why) {
  for (ProposedKey& stated : proposal_.keys)
    if (data_section + stated.key == key) stated.why = why;
  for (Key& stated : keys_)
    if (stated.is(key)) stated.why = why;
}

std::string LogConfiguration::text() const {
  std::vector<std::pair<std::string, std::string>> sections;  // with their lines, in the order of their first keys
  for (const Key& key : keys_) {
    auto section =
        std::find_if(sections.begin(), sections.end(), [&](const auto& s) { return s.first == key.section; });
    if (section == sections.end()) section = sections.insert(section, {key.section, ""});
    if (!key.why.empty()) section->second += "# " + key.why + "\n";
    if (!key.value.empty()) section->second += key.name + " = " + key.value + "\n";
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
