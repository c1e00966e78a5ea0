#include "app/cli/help_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/algorithm/string/case_conv.hpp>
#include <boost/algorithm/string/replace.hpp>
#include <nlohmann/json.hpp>
#include <vector>

#include "app/config/config.hpp"
#include "app/config/option_table.hpp"
#include "app/report/page/assets.hpp"
#include "ident/base/nearest_name.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app {
namespace {

std::string option_text(const Option& option) {
  const std::string value = option.get(Config{});
  return fmt::format("  --{} {}{}\n      {} (default: {})\n", option.key, option.range,
                     option.unit.empty() ? "" : " [" + option.unit + "]", option.help, value.empty() ? "empty" : value);
}

}  // namespace

std::string option_help() {
  std::string text, section;
  for (const Option& option : option_table()) {
    if (option.section() != section) text += fmt::format("\n[{}]\n", option.section());
    section = option.section();
    text += option_text(option);
  }
  return text;
}

std::string option_markdown() {
  const Config defaults{};
  std::string text = "| key | allowed | unit | default | meaning |\n|---|---|---|---|---|\n";
  for (const Option& option : option_table()) {
    const std::string value = option.get(defaults);
    std::string range = option.range, help = option.help;
    boost::replace_all(range, "|", "\\|");
    boost::replace_all(help, "|", "\\|");
    text += fmt::format("| `{}` | {} | {} | {} | {} |\n", option.key, range, option.unit,
                        value.empty() ? "" : "`" + value + "`", help);
  }
  return text;
}

std::string meaning_of(const std::string& name) {
  std::vector<std::string> known;
  const std::string wanted = boost::algorithm::to_lower_copy(name);
  for (const nlohmann::json& entry : nlohmann::json::parse(assets::terms_json())) {
    std::vector<std::string> names = entry.at("also");
    names.push_back(entry.at("term"));
    for (std::string& other : names) boost::algorithm::to_lower(other);
    if (std::find(names.begin(), names.end(), wanted) != names.end())
      return fmt::format("{}: {}\n", entry.at("term").get<std::string>(), entry.at("means").get<std::string>());
    known.push_back(entry.at("term"));
  }
  for (const Option& option : option_table()) {
    if (option.key == name) return option_text(option);
    known.push_back(option.key);
  }
  throw ConfigurationError(fmt::format("{} is neither a term nor a key{}; terms are {}", name,
                                       did_you_mean(name, known), fmt::join(known.begin(), known.begin() + 8, ", ")));
}

}  // namespace modebank::app
