#include "app/cli/command_line.hpp"

#include <fmt/format.h>

#include <boost/program_options.hpp>

#include "app/config/config_file.hpp"
#include "app/config/option_table.hpp"
#include "modebank/base/error.hpp"

namespace po = boost::program_options;

namespace modebank::app {
namespace {

/// Options of predict alone, short for these keys.
constexpr std::pair<const char*, const char*> predict_words[]{
    {"samples", "filter.simulate"}, {"horizon", "filter.simulate_horizon"}, {"filter", "track.filter"}};

po::options_description describe_options(CommandLine& line) {
  po::options_description description;
  auto add = description.add_options();
  add("help,h", po::bool_switch(&line.help));
  add("version", po::bool_switch(&line.version));
  add("markdown", po::bool_switch(&line.markdown));
  add("json", po::bool_switch(&line.json));
  add("repair", po::bool_switch(&line.repair));
  add("findings", po::bool_switch(&line.findings));
  add("apply", po::bool_switch(&line.apply));
  add("force", po::bool_switch(&line.force));
  add("yes", po::bool_switch(&line.yes));
  add("form", po::value(&line.form));
  add("output,o", po::value(&line.output));
  add("to", po::value(&line.exported.to));
  add("table", po::value(&line.exported.table));
  add("float", po::bool_switch(&line.exported.single_precision));
  add("wheel_separation_m", po::value(&line.exported.wheel_separation_m));
  add("wheel_radius_m", po::value(&line.exported.wheel_radius_m));
  add("words", po::value<std::vector<std::string>>());
  for (const auto& [word, key] : predict_words) add(word, po::value<std::string>());
  for (const Option& option : option_table())
    add(option.key.c_str(), po::value<std::vector<std::string>>()->composing());  // given twice, the last wins
  return description;
}

std::string shell_quoted(const std::string& word) {
  return word.find_first_of(" \t*|'\"#$&;()<>") == std::string::npos ? word : "'" + word + "'";
}

/// --key=value as two words, because Boost refuses the empty value of --key=.
std::vector<std::string> split_at_equal_signs(int argc, const char* const* argv) {
  std::vector<std::string> words;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    const auto equal_sign = word.find('=');
    const bool key_with_value = word.rfind("--", 0) == 0 && equal_sign != std::string::npos;
    words.push_back(word.substr(0, key_with_value ? equal_sign : std::string::npos));
    if (key_with_value) words.push_back(word.substr(equal_sign + 1));
  }
  return words;
}

}  // namespace

CommandLine parse_command_line(int argc, const char* const* argv) {
  CommandLine line;
  for (int i = 0; i < argc; ++i) line.typed += (i ? " " : "") + shell_quoted(argv[i]);
  const po::options_description description = describe_options(line);
  po::positional_options_description positional;
  positional.add("words", -1);
  po::variables_map values;
  try {
    // No guessing: an abbreviated key would change its meaning when keys are added.
    const int style = po::command_line_style::unix_style & ~po::command_line_style::allow_guessing;
    const po::parsed_options parsed = po::command_line_parser(split_at_equal_signs(argc, argv))
                                          .options(description)
                                          .positional(positional)
                                          .style(style)
                                          .run();
    for (const po::option& option : parsed.options)
      if (option.string_key.find('.') != std::string::npos)
        line.overrides.emplace_back(option.string_key, option.value.at(0));
      else if (option.position_key < 0)
        line.given.push_back(option.string_key);
    po::store(parsed, values);
    po::notify(values);
  } catch (const po::unknown_option& error) {
    const std::string name = error.get_option_name();
    throw ConfigurationError(fmt::format("unknown option {}{}", name, nearest_key_hint(name)));
  } catch (const po::error& error) {
    throw ConfigurationError(error.what());
  }
  if (values.count("words")) line.files = values["words"].as<std::vector<std::string>>();
  if (!line.files.empty()) {
    line.command = line.files.front();
    line.files.erase(line.files.begin());
  }
  for (const auto& [word, key] : predict_words)
    if (values.count(word)) line.overrides.emplace_back(key, values[word].as<std::string>());
  if (line.form != "increment" && line.form != "full")
    throw ConfigurationError(fmt::format("--form {}: allowed are increment and full", line.form));
  return line;
}

}  // namespace modebank::app
