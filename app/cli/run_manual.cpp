#include <fmt/format.h>
#include <fmt/ranges.h>

#include <boost/algorithm/string.hpp>

#include "app/chain/build_info.hpp"
#include "app/cli/command_table.hpp"
#include "app/cli/commands.hpp"
#include "app/config/config.hpp"
#include "app/config/option_table.hpp"
#include "modebank/base/error.hpp"

/// Manual pages in roff, for man(7).
namespace modebank::app {
namespace {

/// Text with roff's special characters escaped.
std::string roff(std::string text) {
  boost::replace_all(text, "\\", "\\e");
  boost::replace_all(text, "-", "\\-");
  boost::replace_all(text, "'", "\\(aq");
  boost::replace_all(text, "^", "\\(ha");
  boost::replace_all(text, "~", "\\(ti");
  boost::replace_all(text, "`", "\\(ga");
  if (!text.empty() && text.front() == '.') text = "\\&" + text;
  return text;
}

std::string title(const std::string& name) {
  return fmt::format(".TH {} 1 {} \"modebank {}\" modebank\n", boost::to_upper_copy(roff(name)), build_info::date,
                     build_info::version);
}

std::string item(const std::string& term, const std::string& text) {
  return fmt::format(".TP\n.B {}\n{}\n", roff(term), roff(text));
}

std::string options_text(const std::vector<CommandOption>& options) {
  std::string text;
  for (const CommandOption& option : options) text += item(option.typed(), option.help + ".");
  return text;
}

std::string keys_text(const Command& command) {
  const Config defaults{};
  std::string text;
  for (const Option& option : option_table()) {
    if (!command.reads(option.key)) continue;
    const std::string value = option.get(defaults);
    text += item("--" + option.key,
                 fmt::format("{}. {}{} (default: {}).", option.help, option.range,
                             option.unit.empty() ? "" : " [" + option.unit + "]", value.empty() ? "empty" : value));
  }
  return text.empty()
             ? ""
             : ".SH CONFIGURATION KEYS\nKeys of the configuration file. An option overrides the file.\n" + text;
}

std::string page_of(const Command& command) {
  const std::string name = "modebank-" + command.name;
  const std::string details = command.details.empty() ? command.summary + "." : command.details;
  const std::string options = options_text(command.options);
  return title(name) + fmt::format(".SH NAME\n{} \\- {}\n", roff(name), roff(command.summary)) +
         fmt::format(".SH SYNOPSIS\n.B modebank {}\n{}\n", command.name,
                     roff(command.arguments.text + (options.empty() ? "" : " [options]") +
                          (command.keys.empty() ? "" : " [--section.key value ...]"))) +
         fmt::format(".SH DESCRIPTION\n{}\n.SH OPTIONS\n{}", roff(details), options + options_text(common_options())) +
         keys_text(command) +
         fmt::format(".SH EXAMPLES\n.EX\n{}\n.EE\n.SH SEE ALSO\n.BR modebank (1)\n", roff(command.example));
}

std::string main_page() {
  std::string text =
      title("modebank") +
      ".SH NAME\nmodebank \\- identify modes of motion from logs, with honest uncertainty\n"
      ".SH SYNOPSIS\n.B modebank\n.I COMMAND\n[FILE...] [\\-\\-section.key value ...]\n"
      ".SH DESCRIPTION\nFits local linear models to logged runs, clusters them, makes a bank of modes for a "
      "filter and judges it on runs held out.\n.SH COMMANDS\n";
  std::vector<std::string> pages;
  for (const Command& command : command_table()) {
    text += item(boost::trim_copy(command.name + " " + command.arguments.text), command.summary + ".");
    pages.push_back(fmt::format(".BR modebank\\-{} (1)", command.name));
  }
  text += ".SH OPTIONS\n" + options_text(common_options());
  text += ".SH EXIT STATUS\n" + item("0", "Done.") + item("1", "A file's content is invalid, or the run failed.") +
          item("2", "Usage, configuration or path.");
  text += ".SH ENVIRONMENT\n" +
          item("MODEBANK_DATA", "The folder from which relative data paths start, unless data.root is set.") +
          item("COLUMNS", "Width of tables.") + item("NO_COLOR", "No colours.");
  return text + fmt::format(".SH SEE ALSO\n{}\n", fmt::join(pages, ",\n"));
}

}  // namespace

int run_manual(const CommandLine& line) {
  if (line.files.empty()) {
    fmt::print("{}", main_page());
    return 0;
  }
  const Command* command = find_command(line.files.front());
  if (!command) throw ConfigurationError(fmt::format("{} is no command (modebank help)", line.files.front()));
  fmt::print("{}", page_of(*command));
  return 0;
}

}  // namespace modebank::app
