// `modebank demo`: its modes beside the true modes, the printed commands, the built-in configurations, and the demo's
// folder.
#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <regex>
#include <utility>

#include "io/files/read_file.hpp"
#include "tests/app/cli_fixture.hpp"

namespace modebank::test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class Demo : public CliTest {
 protected:
  std::string folder() const { return file("demo").string(); }
  /// The tyre demo with few runs, so that it takes only seconds.
  ProgramResult tyres(std::vector<std::string> options = {}) const {
    options.insert(options.begin(), "tyres");
    return small_demo(options);
  }
  ProgramResult small_demo(const std::vector<std::string>& options) const {
    std::vector<std::string> words{"demo", "-o", folder(), "--simulate.runs=4", "--simulate.samples=80"};
    const std::vector<std::string> small = small_run();
    words.insert(words.end(), small.begin(), small.end());
    words.insert(words.end(), options.begin(), options.end());
    return modebank(words);
  }
  static std::vector<std::string> small_run() {
    return {"--mixture.components=1..2", "--mixture.restarts=1", "--bank.refine=none"};
  }
  std::string in_folder(const std::string& name) const { return read_file(file("demo") / name); }

  void expect_refused(const std::string& culprit) const {
    const ProgramResult result = tyres();
    EXPECT_EQ(result.status, 2);
    EXPECT_THAT(result.err, HasSubstr(culprit));
    EXPECT_THAT(result.err, HasSubstr("--force"));
  }
};

/// The found value, error and true value of each line such as "time constant 0.1507 +- 0.0006 s true 0.150".
std::vector<std::array<double, 3>> compared_numbers(const std::string& text) {
  const std::regex line(R"((-?[\d.]+) \+- ([\d.]+) \S+ +true +(-?[\d.]+)\n)");
  std::vector<std::array<double, 3>> numbers;
  for (std::sregex_iterator it(text.begin(), text.end(), line), none; it != none; ++it)
    numbers.push_back({std::stod((*it)[1]), std::stod((*it)[2]), std::stod((*it)[3])});
  return numbers;
}

/// The true values are in configs/systems/two_grounds.ini: 0.15 s, 0.95 and 0.6 s, 0.5 (rad/s)/(m/s), 0.005 rad/s.
TEST_F(Demo, FindsTheGroundsThatItSimulates) {
  const ProgramResult shown = modebank({"demo", "-o", folder()});
  ASSERT_EQ(shown.status, 0) << shown.err;
  const std::string all = shown.out + shown.err;
  EXPECT_LE(std::count(all.begin(), all.end(), '\n'), 25) << all;
  EXPECT_THAT(all, Not(HasSubstr("warning")));
  EXPECT_EQ(shown.err, "") << "progress is not for first readers";

  const auto numbers = compared_numbers(shown.out);
  ASSERT_EQ(numbers.size(), 8) << shown.out;
  std::vector<double> truths;
  for (const auto& [found, error, truth] : numbers) {
    EXPECT_NEAR(found, truth, 3 * error);
    EXPECT_LT(error, 0.03 * std::abs(truth)) << "and it says something";
    truths.push_back(truth);
  }
  EXPECT_THAT(truths, ::testing::UnorderedElementsAre(0.15, -0.95, 0.95, 0.005, 0.6, -0.5, 0.5, 0.005));
  std::smatch share;
  ASSERT_TRUE(std::regex_search(shown.out, share, std::regex(R"(([\d.]+) % of the held-out samples are assigned)")));
  EXPECT_GT(std::stod(share[1]), 95.0);
}

TEST_F(Demo, GivesTheTruthAsJson) {
  const ProgramResult shown = small_demo({"--json"});
  ASSERT_EQ(shown.status, 0) << shown.err;
  const nlohmann::json truth = nlohmann::json::parse(shown.out).at("truth");
  EXPECT_GT(truth.at("agreement"), 0.0);
  EXPECT_FALSE(truth.at("modes").empty());
}

TEST_F(Demo, IsTheCommandsThatItNames) {
  const ProgramResult shown = tyres();
  ASSERT_EQ(shown.status, 0) << shown.err;
  EXPECT_EQ(in_folder("simulate_ice.ini"), read_file(project_dir() / "configs/simulate_ice.ini"));
  EXPECT_EQ(in_folder("tyres.ini"), read_file(project_dir() / "configs/tyres.ini"));
  EXPECT_THAT(shown.out, HasSubstr("modebank show " + folder() + "/tyres.h5"));
  EXPECT_THAT(shown.out, HasSubstr("modebank report " + folder() + "/tyres.h5"));

  const std::string data = file("by_hand").string();
  const ProgramResult simulated = modebank({"simulate", (project_dir() / "configs/simulate_ice.ini").string(),
                                            "--simulate.output", data, "--simulate.runs=4", "--simulate.samples=80"});
  ASSERT_EQ(simulated.status, 0) << simulated.err;
  EXPECT_EQ(in_folder("data/imu_03.csv"), read_file(file("by_hand") / "imu_03.csv"));
  std::vector<std::string> words{
      "run", (project_dir() / "configs/tyres.ini").string(), "--data.root", data, "--archive.output", archive()};
  const std::vector<std::string> small = small_run();
  words.insert(words.end(), small.begin(), small.end());
  const ProgramResult by_hand = modebank(words);
  ASSERT_EQ(by_hand.status, 0) << by_hand.err;
  const std::size_t next = by_hand.out.find("next   "),
                    use = by_hand.out.find("use   ");  // the next step is not compared, because it may contain the
                                                       // archive's name
  EXPECT_THAT(shown.out, HasSubstr(by_hand.out.substr(0, next)));
  EXPECT_THAT(shown.out, HasSubstr(by_hand.out.substr(use, by_hand.out.find("archive   ") - use)));
}

TEST_F(Demo, ConfigurationsRunAsTheyStand) {
  for (const auto& [word, name] : {std::pair{"--quiet", "demo"}, std::pair{"tyres", "tyres"}}) {
    std::filesystem::remove_all(file("demo"));
    ASSERT_EQ(small_demo({word}).status, 0);
    for (const auto& [from, path] : {std::pair{file("").string(), "demo/"}, std::pair{folder(), ""}}) {
      const ProgramResult again = run_program({"/bin/sh", "-c",
                                               "cd '" + from + "' && '" + MODEBANK_PROGRAM + "' identify " + path +
                                                   name + ".ini --archive.output " + name + "_again.h5"});
      EXPECT_EQ(again.status, 0) << again.err;
    }
  }
}

TEST_F(Demo, RepeatsInItsOwnFolderButLeavesWhatIsForeign) {
  ASSERT_EQ(tyres().status, 0);
  EXPECT_EQ(tyres().status, 0) << "its own folder";
  write("demo/notes.txt", "mine");
  expect_refused("notes.txt");
  std::filesystem::remove(file("demo/notes.txt"));
  write("demo/tyres.ini", "[data]\nstate = wz\n");
  expect_refused("tyres.ini");
  EXPECT_EQ(in_folder("tyres.ini"), "[data]\nstate = wz\n");
  const ProgramResult forced = tyres({"--force"});
  EXPECT_EQ(forced.status, 0) << forced.err;
  EXPECT_EQ(in_folder("tyres.ini"), read_file(project_dir() / "configs/tyres.ini"));
}

TEST_F(Demo, WritesNothingWhereItIsRefused) {
  std::filesystem::create_directory(file("demo"));
  write("demo/tyres.h5", "an archive of theirs");
  expect_refused("tyres.h5");
  EXPECT_EQ(in_folder("tyres.h5"), "an archive of theirs");
  EXPECT_FALSE(std::filesystem::exists(file("demo/simulate_ice.ini")));
  for (const char* option : {"--data.root=x", "--archive.output=x", "--simulate.output=x"}) {
    const ProgramResult result = modebank({"demo", "-o", file("other").string(), option});
    EXPECT_EQ(result.status, 2) << option;
    EXPECT_FALSE(std::filesystem::exists(file("other"))) << option;
  }
  EXPECT_EQ(modebank({"demo", "-o", config()}).status, 2) << "a file is no folder";
  EXPECT_THAT(modebank({"demo", config()}).err, HasSubstr("`modebank demo tyres`")) << "it takes no file";
}

}  // namespace
}  // namespace modebank::test
