#include "app/cli/command_line.hpp"

#include <fmt/format.h>

#include <boost/algorithm/string.hpp>
#include <boost/program_options.hpp>
#include <cstdlib>
#include <filesystem>

#include "app/cli/command_table.hpp"
#include "app/cli/given_options.hpp"
#include "app/config/config_file.hpp"
#include "app/config/option_table.hpp"
#include "app/study/launch/shell.hpp"
#include "modebank/base/error.hpp"

namespace po = boost::program_options;

namespace modebank::app {
namespace {

/// Options of predict alone, short for these keys.
constexpr std::pair<const char*, const char*> predict_words[]{
    {"samples", "filter.simulate"}, {"horizon", "filter.simulate_horizon"}, {"filter", "track.filter"}};

/// What holds an option's value; command_table says which commands have it and what it means.
po::options_description describe_options(CommandLine& line) {
  po::options_description description;
  auto add = description.add_options();
  const auto add_switch = [&add](const char* name, bool& value) { add(name, po::bool_switch(&value)); };
  add_switch("help,h", line.help);
  add_switch("version", line.version);
  add_switch("quiet,q", line.quiet);
  add_switch("verbose,v", line.verbose);
  add_switch("dry-run", line.dry_run);
  add_switch("schema", line.schema);
  add_switch("markdown", line.markdown);
  add_switch("json", line.json);
  add_switch("repair", line.repair);
  add_switch("findings", line.findings);
  add_switch("apply", line.apply);
  add_switch("force", line.force);
  add_switch("yes", line.yes);
  add("form", po::value(&line.form));
  add("output,o", po::value(&line.output));
  add("to", po::value(&line.exported.to));
  add("table", po::value(&line.exported.table));
  add("run", po::value(&line.run));
  add("wheel_separation_m", po::value(&line.exported.wheel_separation_m));
  add("wheel_radius_m", po::value(&line.exported.wheel_radius_m));
  add("words", po::value<std::vector<std::string>>());
  for (const auto& [word, key] : predict_words) add(word, po::value<std::string>());
  for (const Option& option : option_table())
    add(option.key.c_str(), po::value<std::vector<std::string>>()->composing());  // given twice, the last wins
  return description;
}

/// Whether the shell finds this program by the name alone.
bool is_in_path(const std::filesystem::path& program) {
  const char* const path = std::getenv("PATH");
  std::vector<std::string> folders;
  boost::split(folders, path == nullptr ? std::string() : std::string(path), boost::is_any_of(":"));
  for (const std::string& folder : folders) {
    std::error_code absent;
    const std::filesystem::path candidate = std::filesystem::path(folder) / program.filename();
    if (std::filesystem::exists(candidate, absent)) return std::filesystem::equivalent(candidate, program, absent);
  }
  return false;
}

std::string program_as_called(const std::string& typed) {
  const bool by_name = typed.find('/') == std::string::npos || is_in_path(typed);
  return by_name ? std::filesystem::path(typed).filename().string() : shell_quoted(typed);
}

/// Behind it all words are files, whatever they look like.
const std::string end_of_options = "--";

bool takes_a_value(const po::options_description& description, const std::string& word) {
  if (word.rfind("--", 0) != 0 || word == end_of_options) return false;
  const po::option_description* option = description.find_nothrow(word.substr(2), false);
  return option && option->semantic()->max_tokens() > 0;
}

/// Whether a word that follows a key is the next option, so that the key's value was forgotten. Values may look like
/// options themselves: those of sbatch do.
bool is_option(const po::options_description& description, const std::string& word) {
  const std::string key = word.substr(0, word.find('='));
  const std::string name = key.find('.') == std::string::npos ? word : key;
  return name.rfind("--", 0) == 0 && name != end_of_options && description.find_nothrow(name.substr(2), false);
}

/// The words with each key and its value as Boost takes them for what they are, whatever the value holds: --key=value,
/// or two words where the value is empty.
std::vector<std::string> joined_values(int argc, const char* const* argv, const po::options_description& description) {
  std::vector<std::string> words;
  const auto push = [&](const std::string& key, const std::string& value) {
    if (value.empty())
      words.insert(words.end(), {key, value});
    else
      words.push_back(key + "=" + value);
  };
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == end_of_options) {
      words.insert(words.end(), argv + i, argv + argc);
      break;
    }
    const auto equal_sign = word.find('=');
    if (word.rfind("--", 0) == 0 && equal_sign != std::string::npos)
      push(word.substr(0, equal_sign), word.substr(equal_sign + 1));
    else if (!takes_a_value(description, word))
      words.push_back(word);
    else if (i + 1 < argc && !is_option(description, argv[i + 1]))
      push(word, argv[++i]);
    else
      throw ConfigurationError(fmt::format("the required argument for option '{}' is missing", word));
  }
  return words;
}

}  // namespace

std::string shell_quoted(const std::string& word) { return shell_word(word); }

CommandLine parse_command_line(int argc, const char* const* argv) {
  CommandLine line;
  for (int i = 0; i < argc; ++i) line.typed += (i ? " " : "") + shell_quoted(argv[i]);
  line.program = program_as_called(argc > 0 ? argv[0] : "modebank");
  if (argc > 1) refuse_gone_command(argv[1]);  // before its options, which went with it
  const po::options_description description = describe_options(line);
  po::positional_options_description positional;
  positional.add("words", -1);
  po::variables_map values;
  try {
    // No guessing: an abbreviated key would change its meaning when keys are added.
    const int style = po::command_line_style::unix_style & ~po::command_line_style::allow_guessing;
    const po::parsed_options parsed = po::command_line_parser(joined_values(argc, argv, description))
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
  if (const Command* command = find_command(line.command); command && !line.help) check_options(*command, line);
  for (const auto& [word, key] : predict_words)
    if (values.count(word)) line.overrides.emplace_back(key, values[word].as<std::string>());
  if (line.form != "increment" && line.form != "full")
    throw ConfigurationError(fmt::format("--form {}: allowed are increment and full", line.form));
  return line;
}

}  // namespace modebank::app
