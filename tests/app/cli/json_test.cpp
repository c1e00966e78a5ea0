#include <fstream>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>

#include "app/cli/command_table.hpp"
#include "tests/app/cli_fixture.hpp"

/// The output of `--json` agrees with docs/reference/json.md.
namespace modebank::test {
namespace {

using nlohmann::json;

class Json : public CliTest {
 protected:
  /// The only object on standard output.
  json object(const std::vector<std::string>& arguments, int status = 0) const {
    std::vector<std::string> all = arguments;
    all.emplace_back("--json");
    const ProgramResult result = modebank(all);
    EXPECT_EQ(result.status, status) << arguments[0] << ": " << result.err;
    const json found = json::parse(result.out, nullptr, false);
    EXPECT_TRUE(found.is_object()) << arguments[0] << ": " << result.out;
    if (!found.is_object()) return json::object();
    EXPECT_EQ(found.value("command", ""), arguments[0]);
    EXPECT_EQ(found.value("status", -1), status);
    EXPECT_FALSE(found.value("modebank", "").empty());
    return found;
  }
};

/// Words in backquotes in the documentation's lines on this command.
std::set<std::string> documented(const std::string& command) {
  std::ifstream stream(project_dir() / "docs/reference/json.md");
  std::set<std::string> words;
  for (std::string line; std::getline(stream, line);) {
    const std::size_t end = line.find('|', 1);
    if (line.empty() || line[0] != '|' || line.substr(0, end).find("`" + command + "`") == std::string::npos) continue;
    const std::string rest = line.substr(end);
    const std::regex word("`([a-z_0-9]+)`");
    for (std::sregex_iterator it(rest.begin(), rest.end(), word), none; it != none; ++it) words.insert((*it)[1]);
  }
  return words;
}

void expect_documented(const json& object) {
  const std::set<std::string> words = documented(object.at("command"));
  for (const auto& [name, value] : object.items())
    if (name != "command" && name != "modebank" && name != "status") {
      EXPECT_TRUE(words.contains(name)) << object.at("command") << " gives " << name;
    }
}

/// `track` prints one object per sample, so it is tested separately.
TEST_F(Json, EveryCommandHasIt) {
  for (const app::Command& command : app::command_table()) {
    EXPECT_NE(command.find_option("json"), nullptr) << command.name;
    if (command.name != "demo" && command.name != "track") {
      EXPECT_FALSE(documented(command.name).empty()) << command.name;
    }
  }
}

TEST_F(Json, CommandsGiveTheMembersThatAreDocumented) {
  const std::vector<std::vector<std::string>> commands{
      {"help"},
      {"help", "window.length"},
      {"run", config(), "--dry-run"},
      {"check", config()},
      {"init", file("run_00.csv").string(), "-o", file("init.ini").string()},
      {"run", config(), "--until", "windows", "--archive.output", file("windows.h5").string()},
      {"run", config(), "--archive.output", archive()},
      {"run", config(), "--archive.bank", archive(), "--archive.output", file("judged.h5").string()},
      {"show", archive(), "/bank/A"},
      {"show", archive(), "/bank"},
      {"predict", archive(), "--samples", "5"},
      {"predict", archive(), "--samples", "5", "-o", file("p.csv").string()},
      {"export", archive(), "--to", "json", "--force"},
      {"export", archive(), "--to", "c", "--force", "-o", file("f.c").string()},
      {"report", archive(), "-o", file("page.html").string()},
      {"report", file("").string(), "-o", file("site").string()},
      {"verify", archive()},
      {"study", config(), "--study.vary", "window.length = 20 | 25", "--study.output", file("s").string()},
  };
  for (const std::vector<std::string>& command : commands) expect_documented(object(command));
}

}  // namespace
}  // namespace modebank::test
