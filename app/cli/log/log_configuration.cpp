#include "app/cli/log/log_configuration.hpp"

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
  std::erase_if(edits_,
                [&](const KeyEdit& edit) { return edit.key == key && (!value.empty() || edit.values.empty()); });
  edits_.push_back({key, value.empty() ? std::vector<std::string>{} : std::vector{value}, why});
}

void LogConfiguration::explain(const std::string& key, const std::string& why) {
  for (ProposedKey& stated : proposal_.keys)
    if (data_section + stated.key == key) stated.why = why;
  for (KeyEdit& edit : edits_)
    if (edit.key == key) edit.comment = why;
}

std::string LogConfiguration::text() const { return edited_text(configuration_text(proposal_, command_), edits_); }

Config LogConfiguration::config(const std::filesystem::path& file, const std::filesystem::path& archive) const {
  Config config = config_of_text(text(), file, {{"archive.output", archive.string()}});
  validate(config);
  return config;
}

}  // namespace modebank::app
