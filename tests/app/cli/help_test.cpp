#include <fmt/format.h>

#include <map>
#include <nlohmann/json.hpp>
#include <variant>

#include "app/cli/command_table.hpp"
#include "app/config/config_file.hpp"
#include "app/config/option_table.hpp"
#include "app/text/terminal.hpp"
#include "tests/app/cli_fixture.hpp"

namespace modebank::test {
namespace {

class Help : public CliTest {};

TEST_F(Help, OfEveryCommandFitsAScreenAndIsTheSameBothWays) {
  for (const app::Command& command : app::command_table()) {
    const ProgramResult help = modebank({"help", command.name});
    ASSERT_EQ(help.status, 0) << command.name << help.err;
    EXPECT_EQ(help.out, modebank({command.name, "--help"}).out);
    const std::vector<std::string> lines = app::lines_of(help.out);
    EXPECT_LE(lines.size(), 41u) << help.out;  // includes the empty text after the last line break
    for (const std::string& line : lines) EXPECT_LE(app::columns_of(line), 100) << line;
    for (const app::CommandOption& option : command.options)
      EXPECT_NE(help.out.find("--" + option.long_name()), std::string::npos) << option.name;
  }
}

/// Only the table declares options: all commands with an option of one name set the same member.
TEST_F(Help, OptionsOfOneNameHaveOneTarget) {
  std::map<std::string, app::CommandOption> known;
  for (const app::Command& command : app::command_table())
    for (const app::CommandOption& option : command.options) {
      const auto [first, fresh] = known.emplace(option.long_name(), option);
      EXPECT_EQ(first->second.name, option.name) << command.name;
      EXPECT_TRUE(first->second.target == option.target) << command.name << " --" << option.long_name();
      const auto* key = std::get_if<std::string>(&option.target);
      EXPECT_TRUE(!key || command.reads(*key)) << *key;
    }
  EXPECT_EQ(known.size(), 11u);
}

TEST_F(Help, WordsAfterACommandAreCounted) {
  for (const app::Command& command : app::command_table()) {
    const auto& [text, needs, fewest, most] = command.arguments;
    if (fewest > 0) {
      const ProgramResult few = modebank({command.name});
      EXPECT_EQ(few.status, 2) << command.name;
      EXPECT_NE(few.err.find(command.name + " " + needs + ", as in: " + command.example), std::string::npos) << few.err;
    }
    if (most > 6) continue;
    std::vector<std::string> words(most + 1, config());
    words.insert(words.begin(), command.name);
    const ProgramResult many = modebank(words);
    EXPECT_EQ(many.status, 2) << command.name;
    EXPECT_NE(many.err.find(command.name + " " + needs), std::string::npos) << many.err;
  }
}

TEST_F(Help, DryRunSaysWhereEachValueComesFromAndIsAConfiguration) {
  const ProgramResult shown = modebank({"run", config(), "--dry-run", "--window.length", "17"});
  ASSERT_EQ(shown.status, 0) << shown.err;
  EXPECT_NE(shown.out.find("# --window.length"), std::string::npos);
  EXPECT_NE(shown.out.find("# " + config() + ":"), std::string::npos);
  EXPECT_NE(shown.out.find("# default"), std::string::npos);
  write("again.ini", shown.out);
  EXPECT_EQ(app::resolved_text(app::load_config(file("again.ini"), {})),
            app::resolved_text(app::load_config(config(), {{"window.length", "17"}})));
}

TEST_F(Help, JsonHasEveryCommandAndEveryKeyWithItsDefault) {
  const ProgramResult shown = modebank({"help", "--json"});
  ASSERT_EQ(shown.status, 0) << shown.err;
  const nlohmann::json found = nlohmann::json::parse(shown.out);
  std::set<std::string> commands;
  for (const nlohmann::json& command : found.at("commands")) commands.insert(command.at("name"));
  EXPECT_EQ(commands.size(), app::command_table().size());
  for (const app::Command& command : app::command_table()) EXPECT_TRUE(commands.contains(command.name)) << command.name;
  std::map<std::string, nlohmann::json> keys;
  for (const nlohmann::json& key : found.at("keys")) keys[key.at("key")] = key;
  EXPECT_EQ(keys.size(), app::option_table().size());
  for (const app::Option& option : app::option_table())
    EXPECT_EQ(keys[option.key].value("default", "absent"), option.get(app::Config{})) << option.key;
  EXPECT_GT(found.at("terms").size(), 50u);
}

TEST_F(Help, BashCompletesCommandsOptionsKeysAndValues) {
  const auto completed = [&](const std::string& words) {
    return run_program({"bash", "-c",
                        fmt::format("source {}/packaging/completion.sh; COMP_WORDS=({}); COMP_CWORD=$(({} - 1)); "
                                    "_modebank {} \"${{COMP_WORDS[-1]}}\" \"${{COMP_WORDS[-2]}}\"; "
                                    "printf '%s\\n' \"${{COMPREPLY[@]}}\" | sort -u",
                                    project_dir().string(), words, "${#COMP_WORDS[@]}", MODEBANK_PROGRAM)})
        .out;
  };
  EXPECT_EQ(completed("modebank sim"), "simulate\n");
  EXPECT_EQ(completed("modebank show --fo"), "--form\n");
  EXPECT_EQ(completed("modebank run --window.len"), "--window.length\n");
  EXPECT_EQ(completed("modebank run --data.decimal co"), "comma\n");
  EXPECT_EQ(completed("modebank show --form inc"), "increment\n");
}

}  // namespace
}  // namespace modebank::test
