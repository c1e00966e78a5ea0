#include <fmt/format.h>

#include <map>
#include <nlohmann/json.hpp>
#include <variant>

#include "app/cli/command_table.hpp"
#include "app/cli/help_text.hpp"
#include "app/config/config_file.hpp"
#include "app/config/option_table.hpp"
#include "app/report/page/assets.hpp"
#include "app/text/screen_labels.hpp"
#include "app/text/terminal.hpp"
#include "tests/app/cli_fixture.hpp"
#include "tests/app/labels_of.hpp"

namespace modebank::test {
namespace {

class Help : public CliTest {};

ProgramResult in_shell(const std::string& shell, const std::string& script) {
  return run_program({shell, "-c", script});
}

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

/// The labels of `run` and `show`. run_log_test tests the labels of `run LOG`.
TEST_F(Help, ExplainsEveryLabelOfTheScreen) {
  const ProgramResult made = run();
  ASSERT_EQ(made.status, 0) << made.err;
  std::set<std::string> labels = labels_of(made.out);
  EXPECT_GE(labels.size(), 7u) << made.out;
  labels.merge(labels_of(modebank({"show", archive()}).out));
  EXPECT_GE(labels.size(), 16u);
  for (const std::string& label : labels)
    EXPECT_NE(app::help_on(label).find(label + " (a line of the screen): "), std::string::npos) << label;
  for (const app::ScreenLabel& label : app::screen_labels())
    EXPECT_NE(app::help_on(label.name).find(label.means), std::string::npos) << label.name;
}

/// All names of a term lead to it. Words that are not used for the term also lead to it.
TEST_F(Help, AnswersEveryWordOfTheGlossary) {
  for (const nlohmann::json& term : nlohmann::json::parse(app::assets::terms_json())) {
    std::vector<std::string> names{term.at("term")};
    for (const char* member : {"also", "not"})
      for (const std::string name : term.at(member)) names.push_back(name);
    for (const std::string& name : names)
      EXPECT_NE(app::help_on(name).find(term.at("means").get<std::string>()), std::string::npos) << name;
  }
  EXPECT_EQ(app::help_on("regime").find("\"regime\" is called mode here.\nmode: "), 0u) << app::help_on("regime");
}

TEST_F(Help, CaseMattersWhereTwoTermsDifferByIt) {
  EXPECT_EQ(app::help_on("Q").find("process noise: Q: covariance of what a mode's model does not predict"), 0u);
  EXPECT_EQ(app::help_on("q").find("q: Number of free parameters of a mixture"), 0u);
  EXPECT_EQ(app::help_on("rmse"), app::help_on("RMSE"));
}

TEST_F(Help, KnowsSectionsAndKeys) {
  const std::string section = modebank({"help", "window"}).out;
  for (const app::Option& option : app::option_table()) {
    EXPECT_EQ(section.find("--" + option.key + " ") != std::string::npos, option.section() == "window") << option.key;
  }
  EXPECT_NE(modebank({"help", "bank.refine"}).out.find("--bank.refine"), std::string::npos);
}

TEST_F(Help, OfEveryKeySaysWhenToTouchIt) {
  for (const app::Option& option : app::option_table()) {
    EXPECT_FALSE(option.when.empty()) << option.key;
    EXPECT_FALSE(option.when.ends_with(".")) << option.key << ": the full stop is the printer's";
  }
  const std::string help = modebank({"help", "data.split"}).out;
  EXPECT_NE(help.find("When to change it: for a single long run"), std::string::npos) << help;
  EXPECT_NE(help.find("changes the stage data and those that follow"), std::string::npos) << help;
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
  EXPECT_GT(known.size(), 15u);
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

TEST_F(Help, ErrorsAreColouredOnATerminalAlone) {
  const auto on_terminal = [](const std::string& variables) {
    return run_program({"script", "-qc", variables + " TERM=xterm " + MODEBANK_PROGRAM + " run no.ini", "/dev/null"})
        .out;
  };
  const std::string coloured = "\x1b[1;31mmodebank:\x1b[0m cannot read the configuration no.ini";
  EXPECT_NE(on_terminal("").find(coloured), std::string::npos) << on_terminal("");
  EXPECT_EQ(on_terminal("NO_COLOR=1").find("\x1b[1"), std::string::npos) << on_terminal("NO_COLOR=1");
  EXPECT_EQ(modebank({"run", "no.ini"}).err.find("modebank: cannot read the configuration no.ini"), 0u);
}

TEST_F(Help, ConfigSaysWhereEachValueComesFromAndIsAConfiguration) {
  const ProgramResult shown = modebank({"config", config(), "--window.length", "17"});
  ASSERT_EQ(shown.status, 0) << shown.err;
  EXPECT_NE(shown.out.find("# --window.length"), std::string::npos);
  EXPECT_NE(shown.out.find("# " + config() + ":"), std::string::npos);
  EXPECT_NE(shown.out.find("# default"), std::string::npos);
  write("again.ini", shown.out);
  EXPECT_EQ(app::resolved_text(app::load_config(file("again.ini"), {})),
            app::resolved_text(app::load_config(config(), {{"window.length", "17"}})));
}

TEST_F(Help, ConfigNamesTheLineOfEachValueOfARepeatableKey) {
  write("derived.ini", "[data]\ninputs = run_*.csv\nstate = a\nderive = a = 2 * wz\nderive = b = 3 * wz\n");
  const std::string shown = modebank({"config", file("derived.ini").string()}).out;
  EXPECT_NE(shown.find(fmt::format("{:<40}  # {}:4\n", "derive = a = 2 * wz", file("derived.ini").string())),
            std::string::npos)
      << shown;
  EXPECT_NE(shown.find("derived.ini:5\n"), std::string::npos) << shown;
}

TEST_F(Help, SchemaHasEveryKeyWithItsDefault) {
  const ProgramResult shown = modebank({"config", "--schema"});
  ASSERT_EQ(shown.status, 0) << shown.err;
  const nlohmann::json sections = nlohmann::json::parse(shown.out).at("properties");
  for (const app::Option& option : app::option_table()) {
    const nlohmann::json& key = sections.at(option.section()).at("properties").at(option.name());
    EXPECT_EQ((option.repeatable ? key.at("oneOf").at(0) : key).at("default"), option.get(app::Config{})) << option.key;
  }
}

TEST_F(Help, DryRunNamesFilesAndWritesNone) {
  const ProgramResult result = run({"--dry-run"});
  ASSERT_EQ(result.status, 0) << result.err;
  for (const char* part : {"reads     ", "run_00.csv", "run_01.csv", "writes    ", "out.h5"})
    EXPECT_NE(result.out.find(part), std::string::npos) << result.out;
  EXPECT_TRUE(left_behind().empty());
}

/// If stages come from an archive, the data also come from this archive.
TEST_F(Help, DryRunOnAnArchivesStagesReadsTheArchive) {
  write("out.h5", "is not opened");
  const ProgramResult result = modebank({"cluster", config(), "--archive.input", archive(), "--dry-run"});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.out.find("reads     " + archive()), std::string::npos) << result.out;
  EXPECT_EQ(result.out.find("run_00.csv"), std::string::npos) << result.out;
}

TEST_F(Help, BashCompletesCommandsOptionsKeysAndWords) {
  write("c.bash", modebank({"completion", "bash"}).out);
  const auto completed = [&](const std::string& words) {
    return in_shell("bash",
                    fmt::format("source {}; COMP_WORDS=({}); COMP_CWORD=$((${{#COMP_WORDS[@]}} - 1)); _modebank; "
                                "echo \" ${{COMPREPLY[@]}} \"",
                                file("c.bash").string(), words))
        .out;
  };
  EXPECT_EQ(completed("modebank iden"), " identify \n");
  EXPECT_EQ(completed("modebank verify --rep"), " --repair \n");
  EXPECT_EQ(completed("modebank run --window.len"), " --window.length \n");
  EXPECT_EQ(completed("modebank run --data.decimal co"), " comma \n");
  EXPECT_EQ(completed("modebank show --form inc"), " increment \n");
  EXPECT_EQ(completed("modebank export a.h5 --to ca"), " casadi \n");
  EXPECT_EQ(completed("modebank help window.len"), " window.length \n");
  EXPECT_EQ(completed("modebank help verif"), " verify \n");
  EXPECT_EQ(completed("modebank help 'log sc'"), " log\\ score \n");
}

/// `help` explains each topic that the completion offers.
TEST_F(Help, EveryTermOfTheGlossaryIsExplained) {
  EXPECT_GT(app::term_names().size(), 50u);
  for (const std::string& term : app::term_names()) EXPECT_NO_THROW(app::help_on(term)) << term;
}

class CompletionScript : public Help, public ::testing::WithParamInterface<const char*> {};

TEST_P(CompletionScript, IsReadByItsShell) {
  const std::string shell = GetParam();
  MODEBANK_NEEDS(has_program(shell), shell + " is absent: apt-get install " + shell);
  write("script", modebank({"completion", shell}).out);
  const ProgramResult read = in_shell(shell, fmt::format("{} -n {}", shell, file("script").string()));
  EXPECT_EQ(read.status, 0) << read.err;
}

INSTANTIATE_TEST_SUITE_P(Shells, CompletionScript, ::testing::Values("zsh", "fish"),
                         [](const auto& about) { return std::string(about.param); });

TEST_F(Help, ManualPagesAreCleanRoff) {
  MODEBANK_NEEDS(has_program("mandoc"), "mandoc is absent: apt-get install mandoc");
  for (const app::Command& command : app::command_table()) {
    write("page.1", modebank({"manual", command.name}).out);
    const ProgramResult lint = run_program({"mandoc", "-Tlint", "-Wwarning", file("page.1").string()});
    EXPECT_EQ(lint.status, 0) << command.name << '\n' << lint.out << lint.err;
  }
  write("page.1", modebank({"manual"}).out);
  const ProgramResult lint = run_program({"mandoc", "-Tlint", "-Wwarning", file("page.1").string()});
  EXPECT_EQ(lint.status, 0) << lint.out << lint.err;
}

}  // namespace
}  // namespace modebank::test
