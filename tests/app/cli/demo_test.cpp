// `modebank demo`: its modes beside the true modes, the printed commands, the built-in configurations, and the demo's
// folder.
#include <gmock/gmock.h>

#include <utility>

#include "io/files/read_file.hpp"
#include "tests/app/cli_fixture.hpp"

namespace modebank::test {
namespace {

using ::testing::HasSubstr;

class Demo : public CliTest {
 protected:
  std::string folder() const { return file("demo").string(); }
  /// The demo with few runs, so that it takes only seconds.
  ProgramResult small_demo(const std::vector<std::string>& options = {}) const {
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
    const ProgramResult result = small_demo();
    EXPECT_EQ(result.status, 2);
    EXPECT_THAT(result.err, HasSubstr(culprit));
    EXPECT_THAT(result.err, HasSubstr("--force"));
  }
};

TEST_F(Demo, IsTheCommandsThatItNames) {
  const ProgramResult shown = small_demo({"--data.label="});  // without labels it shows the first screen, not the truth
  ASSERT_EQ(shown.status, 0) << shown.err;
  EXPECT_EQ(in_folder("simulate_demo.ini"), read_file(project_dir() / "configs/simulate_demo.ini"));
  EXPECT_EQ(in_folder("demo.ini"), read_file(project_dir() / "configs/demo.ini"));
  EXPECT_THAT(shown.out, HasSubstr("modebank show " + folder() + "/demo.h5"));
  EXPECT_THAT(shown.out, HasSubstr("modebank report " + folder() + "/demo.h5"));

  const std::string data = file("by_hand").string();
  const ProgramResult simulated = modebank({"simulate", (project_dir() / "configs/simulate_demo.ini").string(),
                                            "--simulate.output", data, "--simulate.runs=4", "--simulate.samples=80"});
  ASSERT_EQ(simulated.status, 0) << simulated.err;
  EXPECT_EQ(in_folder("data/imu_03.csv"), read_file(file("by_hand") / "imu_03.csv"));
  std::vector<std::string> words{
      "run",          (project_dir() / "configs/demo.ini").string(), "--data.root", data, "--archive.output", archive(),
      "--data.label="};
  const std::vector<std::string> small = small_run();
  words.insert(words.end(), small.begin(), small.end());
  const ProgramResult by_hand = modebank(words);
  ASSERT_EQ(by_hand.status, 0) << by_hand.err;
  EXPECT_THAT(shown.out, HasSubstr(by_hand.out.substr(0, by_hand.out.find("archive   "))));
}

TEST_F(Demo, ConfigurationsRunAsTheyStand) {
  ASSERT_EQ(small_demo().status, 0);
  for (const auto& [from, path] : {std::pair{file("").string(), "demo/"}, std::pair{folder(), ""}}) {
    const ProgramResult again = run_program({"/bin/sh", "-c",
                                             "cd '" + from + "' && '" + MODEBANK_PROGRAM + "' run " + path +
                                                 "demo.ini --until windows --archive.output again.h5"});
    EXPECT_EQ(again.status, 0) << again.err;
  }
}

TEST_F(Demo, RepeatsInItsOwnFolderButLeavesWhatIsForeign) {
  ASSERT_EQ(small_demo().status, 0);
  EXPECT_EQ(small_demo().status, 0) << "its own folder";
  write("demo/notes.txt", "mine");
  expect_refused("notes.txt");
  std::filesystem::remove(file("demo/notes.txt"));
  write("demo/demo.ini", "[data]\nstate = wz\n");
  expect_refused("demo.ini");
  EXPECT_EQ(in_folder("demo.ini"), "[data]\nstate = wz\n");
  const ProgramResult forced = small_demo({"--force"});
  EXPECT_EQ(forced.status, 0) << forced.err;
  EXPECT_EQ(in_folder("demo.ini"), read_file(project_dir() / "configs/demo.ini"));
}

TEST_F(Demo, WritesNothingWhereItIsRefused) {
  std::filesystem::create_directory(file("demo"));
  write("demo/demo.h5", "an archive of theirs");
  expect_refused("demo.h5");
  EXPECT_EQ(in_folder("demo.h5"), "an archive of theirs");
  EXPECT_FALSE(std::filesystem::exists(file("demo/simulate_demo.ini")));
  for (const char* option : {"--data.root=x", "--archive.output=x", "--simulate.output=x"}) {
    const ProgramResult result = modebank({"demo", "-o", file("other").string(), option});
    EXPECT_EQ(result.status, 2) << option;
    EXPECT_FALSE(std::filesystem::exists(file("other"))) << option;
  }
  EXPECT_EQ(modebank({"demo", "-o", config()}).status, 2) << "a file is no folder";
  EXPECT_EQ(modebank({"demo", config()}).status, 2) << "it takes no file";
}

}  // namespace
}  // namespace modebank::test
