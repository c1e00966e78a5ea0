// Damage that users, foreign study folders or file names can cause. Each case was a real defect.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "app/cli/track_output.hpp"
#include "app/config/config_file.hpp"
#include "app/study/space/study_plan.hpp"
#include "ident/base/distributions.hpp"
#include "ident/base/printable.hpp"
#include "io/archive/bank/load_bank.hpp"
#include "io/files/read_file.hpp"
#include "tests/app/cli_fixture.hpp"
#include "tests/io/archive/archive_patch.hpp"

namespace modebank::test {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

class Robustness : public CliTest {
 protected:
  /// The folder of a study. Its plan has one trial with this key.
  fs::path study_of(const std::string& key) const {
    const fs::path folder = file("study");
    fs::create_directories(folder / "trials");
    app::StudyPlan plan;
    plan.config = app::resolved_text(app::Config());
    plan.table.varied_keys = {"mixture.components"};
    app::TrialRow row;
    row.key = key;
    row.varied = {"1"};
    plan.table.rows = {row};
    app::write_plan(folder, plan);
    return folder;
  }
  ProgramResult report(const fs::path& study) const {
    return modebank({"report", study.string(), "-o", file("page.html").string()});
  }
  ProgramResult until_windows(const std::string& config, std::vector<std::string> options = {}) const {
    options.insert(options.begin(), {"run", config, "--until", "windows", "--archive.output", archive()});
    return modebank(options);
  }
};

TEST_F(Robustness, D1AKeyThatNamesAFileElsewhereIsRefused) {
  write("victim.h5", "precious");
  const ProgramResult result = report(study_of("../../victim"));
  EXPECT_EQ(result.status, 1);
  EXPECT_THAT(result.err, HasSubstr("the key \"../../victim\" is not 64 hexadecimal digits"));
  EXPECT_EQ(read_file(file("victim.h5")), "precious");
}

TEST_F(Robustness, D13TailsBeyondEverySeriesAreZeroAndUndefinedOnesNaN) {
  EXPECT_EQ(chi_square_upper_tail(1e300, 2.0), 0.0);
  EXPECT_EQ(chi_square_upper_tail(4.6e18, 1.0), 0.0);
  EXPECT_NEAR(chi_square_upper_tail(3.841458820694124, 1.0), 0.05, 1e-12);
  EXPECT_TRUE(std::isnan(chi_square_upper_tail(-1.0, 1.0)));
  EXPECT_TRUE(std::isnan(chi_square_quantile(0.5, std::nan(""))));
}

TEST_F(Robustness, D14TheStoredConfigurationRunsAgainWhateverThePath) {
  for (const std::string name :
       {"ha#sh", "new\nstate = oops", "ends in blank ", "quo\"ted", "back\\slash", "tab\tbed"}) {
    const fs::path folder = file("folders") / name;
    fs::create_directories(folder);
    for (const char* part : {"test.ini", "run_00.csv", "run_01.csv"}) fs::copy_file(file(part), folder / part);
    const ProgramResult first = until_windows((folder / "test.ini").string(), {"--force"});
    ASSERT_EQ(first.status, 0) << name << first.err;
    write("again.ini", load_configuration(archive()));
    const ProgramResult again = until_windows(file("again.ini").string());
    EXPECT_EQ(again.status, 0) << name << again.err;
  }
}

TEST_F(Robustness, D15BytesThatAreNoUtf8AreShownAsNumbers) {
  EXPECT_EQ(printable("gr\xf6\xdf"
                      "e"),
            "gr\\xf6\\xdfe");
  EXPECT_EQ(printable("gr\xc3\xb6\xc3\x9f"
                      "e \xe2\x82\xac \xf0\x9f\xa4\x96"),
            "gr\xc3\xb6\xc3\x9f"
            "e \xe2\x82\xac \xf0\x9f\xa4\x96");
  // Invalid UTF-8: cut off, longer than needed, an unpaired surrogate, beyond Unicode.
  EXPECT_EQ(printable("\xe2\x82"), "\\xe2\\x82");
  EXPECT_EQ(printable("\xc0\xaf"), "\\xc0\\xaf");
  EXPECT_EQ(printable("\xed\xa0\x80"), "\\xed\\xa0\\x80");
  EXPECT_EQ(printable("\xf4\x90\x80\x80"), "\\xf4\\x90\\x80\\x80");
  EXPECT_EQ(printable_name("a\xffz\n"), "a\\xffz\\x0a");
  EXPECT_FALSE(holds_controls("gr\xf6\n"));
  EXPECT_TRUE(name_holds_controls("gr\xf6\n"));
}

/// attack_05: a byte that is not UTF-8 made the JSON library throw.
TEST_F(Robustness, D15TracksLinesAreUtf8WhateverTheName) {
  FilterEstimate estimate;
  estimate.state = estimate.mode_probability = Eigen::VectorXd::Ones(1);
  estimate.covariance = Eigen::MatrixXd::Ones(1, 1);
  const LiveVerdict verdict{Eigen::VectorXd::Ones(1), Eigen::VectorXd::Ones(1), Eigen::VectorXd::Ones(1)};
  for (const bool as_json : {true, false}) {
    const app::EstimateWriter writer({"gr\xf6\xdf"
                                      "e"},
                                     1, app::EstimateLines{as_json, false});
    fmt::memory_buffer out;
    writer.header(out);
    writer.line("", 0.5, estimate, verdict, {}, out);
    const std::string text = fmt::to_string(out);
    EXPECT_THAT(text, HasSubstr("gr\\"));
    EXPECT_EQ(printable(text), text);
    if (as_json) {
      EXPECT_TRUE(nlohmann::json::parse(text).contains("gr\\xf6\\xdfe"));
    }
  }
}

TEST_F(Robustness, P8AnOutputIsReplacedByItsLike) {
  ASSERT_EQ(run({"--mixture.components", "1"}).status, 0);
  fs::copy_file(file("run_01.csv"), file("log.csv"));
  const std::string log = file("log.csv").string();
  const std::vector<std::vector<std::string>> commands{
      {"predict", archive(), "--data.inputs", log, "--samples", "5", "-o", file("predicted.csv").string()},
      {"report", archive(), "-o", file("page.html").string()},
      {"export", archive(), "--force", "--to", "json", "-o", file("a.json").string()},
      {"export", archive(), "--force", "--to", "c", "-o", file("a.c").string()}};
  write("predicted.csv", "");  // an empty file can be replaced
  for (const std::vector<std::string>& words : commands)
    for (int time = 0; time < 2; ++time) {
      const ProgramResult result = modebank(words);
      EXPECT_EQ(result.status, 0) << words.front() << " " << words.back() << result.err;
    }
}

TEST_F(Robustness, P8WordsBehindTwoDashesAreFiles) {
  write("--force.ini", app::resolved_text(app::Config()));
  EXPECT_EQ(modebank({"--", "check", config()}).status, 0);
  EXPECT_THAT(modebank({"run", "--", "--force"}).err, HasSubstr("--force"));
  EXPECT_THAT(modebank({"run", "--", config(), "--force"}).err, HasSubstr("run needs one configuration file"));
}

/// Characters that change how a terminal displays a log, a table or C source.
TEST_F(Robustness, D15CharactersThatTurnTheDirectionAreShown) {
  EXPECT_EQ(printable("a\u202eb\u2066c\u2028d\u2029"), "a\\u202eb\\u2066c\\u2028d\\u2029");
  EXPECT_EQ(printable("\u2027\u202f\u2065\u206a \u05d0"), "\u2027\u202f\u2065\u206a \u05d0");
  write("run_00.csv", "time,\"wz\nmodebank: all is well\",left,right\n");
  EXPECT_THAT(until_windows(config()).err, HasSubstr("time, wz\\x0amodebank: all is well, left"));
}

}  // namespace
}  // namespace modebank::test
