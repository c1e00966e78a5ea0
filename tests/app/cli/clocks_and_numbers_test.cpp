// Wrong clocks and invalid numbers. They cause messages before any fit, or results that are right in spite of them.
#include <gmock/gmock.h>

#include <cmath>
#include <functional>
#include <sstream>

#include "app/text/mode_dynamics.hpp"
#include "app/text/mode_tables.hpp"
#include "filter/step/gaussian.hpp"
#include "io/archive/archive.hpp"
#include "io/import/value_check.hpp"
#include "tests/app/cli_fixture.hpp"

namespace modebank::test {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using ::testing::HasSubstr;
using ::testing::Not;

class ClocksAndNumbers : public CliTest {
 protected:
  using Row = std::vector<std::string>;  // fields: time, wz, left, right

  /// Changes the rows of a run's file. `line`: line number in the file; the header is line 1.
  void change(const std::string& name, const std::function<void(int line, Row& row)>& change_row) const {
    std::istringstream in(csv_run(80, name == "run_00.csv" ? 1 : 2));
    std::string all, text;
    for (int line = 1; std::getline(in, text); ++line) {
      Row row;
      std::istringstream fields(text);
      for (std::string field; std::getline(fields, field, ',');) row.push_back(field);
      if (line > 1) change_row(line, row);
      for (std::size_t i = 0; i < row.size(); ++i) all += (i > 0 ? "," : "") + row[i];
      all += "\n";
    }
    write(name, all);
  }
  void change_both(const std::function<void(int line, Row& row)>& change_row) const {
    for (const char* name : {"run_00.csv", "run_01.csv"}) change(name, change_row);
  }
  ProgramResult check() const { return modebank({"check", config(), "--data.root", file(".").string()}); }
};

TEST_F(ClocksAndNumbers, Finding_D4_APauseOfADayCostsNoGrid) {
  change("run_00.csv", [](int line, Row& row) {
    if (line > 41) row[0] = std::to_string(86400.0 + std::stod(row[0]));
  });
  EXPECT_EQ(run({"--data.rate_hz", "100"}).status, 0);
  const Archive archive = read_archive(this->archive());
  Index samples = 0;
  for (const Trajectory& part : archive.recording->runs) samples += part.samples();
  EXPECT_LT(samples, 3000) << "at 100 Hz the pause alone would be 8.64 million";
  EXPECT_EQ(check().status, 0);
  EXPECT_EQ(run({"--data.lag_s", "auto"}).status, 0);
}

/// Filters accept every number that the import accepts.
static_assert(largest_value == largest_measurement);

TEST_F(ClocksAndNumbers, Finding_D7_AValueBelowTheLimitIsScored) {
  change("run_01.csv", [](int line, Row& row) { row[1] = line == 42 ? "1e29" : row[1]; });
  ASSERT_EQ(run().status, 0);
  for (const SummaryRow& row : read_archive(archive()).summary)
    if (row.role == Role::test) {
      EXPECT_EQ(row.samples, 79);
      EXPECT_LT(row.log_score, -1e3) << row.filter;
    }
}

TEST_F(ClocksAndNumbers, Finding_D9_AZeroInputLeavesTheOthersTheirErrors) {
  change_both([](int, Row& row) { row[2] = "0"; });
  const ProgramResult result = run();
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.err, HasSubstr("not identifiable from the training runs: the effect of left, which is zero"));
  EXPECT_THAT(result.out, HasSubstr("left never moves"));
  const Archive archive = read_archive(this->archive());
  const VectorXd variance = archive.windows->global.covariance.diagonal();
  EXPECT_GT(variance(0), 0.0);
  EXPECT_TRUE(std::isnan(variance(1)));
  EXPECT_GT(variance(2), 0.0);
  // The value of an unidentifiable parameter comes from its prior. Texts must not present this value as a result.
  for (const std::optional<Bank>& bank :
       {archive.bank, archive.unrefined, archive.baseline, archive.noise_only, archive.one_motion})
    for (const Mode& mode : bank.value().modes) {
      EXPECT_GT(mode.standard_error(0), 0.0);
      EXPECT_TRUE(std::isnan(mode.standard_error(1))) << mode.standard_error.transpose();
      EXPECT_GT(mode.standard_error(2), 0.0);
    }
  const Eigen::MatrixXd of_windows = archive.windows->standard_errors();
  EXPECT_TRUE(of_windows.row(1).array().isNaN().all());
  EXPECT_TRUE((of_windows.row(2).array() > 0.0).all());
  const ModeDynamics dynamics = mode_dynamics(*archive.bank, 0);
  EXPECT_GT(dynamics.gain_error(0, 1), 0.0);
  EXPECT_TRUE(std::isnan(dynamics.gain_error(0, 0)));
  const ProgramResult shown = modebank({"show", this->archive()});
  EXPECT_THAT(shown.out, HasSubstr("wz <- left not identifiable"));
  EXPECT_THAT(shown.out, Not(HasSubstr("+- nan")));
  const ProgramResult checked = check();
  EXPECT_EQ(checked.status, 0) << checked.err;
  EXPECT_THAT(checked.out, HasSubstr("left is constant: 0 in every sample"));
  EXPECT_THAT(checked.out + checked.err, Not(HasSubstr("nan")));
}

/// If an input equals the state, the decay and all gains are unidentifiable.
TEST_F(ClocksAndNumbers, Finding_D9_AnOpenStateLeavesNoTimeConstantAndNoGain) {
  change_both([](int, Row& row) { row[3] = row[1]; });
  const ProgramResult result = run();
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.err, HasSubstr("the effect of the state wz, right, which are zero or sums of multiples"));
  const Archive archive = read_archive(this->archive());
  for (const app::ModeTable::Row& row : app::mode_table(archive).rows) {
    for (std::size_t i = 3; i < row.cells.size(); ++i) EXPECT_EQ(row.cells[i], "not identifiable");
  }
  EXPECT_THAT(check().out, HasSubstr("the effect of the state wz, right, which are zero or sums of multiples"));
}

/// Counts every measured sample that has no score.
TEST_F(ClocksAndNumbers, MeasuredSamplesWithoutAScoreAreCounted) {
  change("run_00.csv", [](int, Row&) {});
  change("run_01.csv", [](int line, Row& row) {
    if (line % 3 == 0) row[1] = "";
  });
  const ProgramResult result =
      run({"--data.missing", "predict", "--window.model", "varx", "--window.state_lags", "3", "--bank.refine", "none"});
  ASSERT_EQ(result.status, 0) << result.err;
  // Every third of 80 samples is missing, starting with the second. The other 53 samples remain; three of these are at
  // the start.
  EXPECT_THAT(result.err, HasSubstr("scores: 50 of 133 measured samples have no score, most of them in run 01"));
  EXPECT_THAT(modebank({"show", archive()}).out, HasSubstr("measured samples have no score"));
  const ProgramResult gaps = run({"--data.missing", "gap", "--bank.refine", "none"});
  ASSERT_EQ(gaps.status, 0) << gaps.err;
  EXPECT_THAT(gaps.err, Not(HasSubstr("have no score")));
  const ProgramResult where = run({"--data.missing", "gap", "--data.where", "left < 0.4"});
  EXPECT_THAT(where.err, HasSubstr("measured samples are left out: data.where is false or missing there"));
}

TEST_F(ClocksAndNumbers, Finding_D16_OneOutlierThatOwnsTheGlobalModelIsNamed) {
  change("run_00.csv", [](int line, Row& row) { row[1] = line == 42 ? "1e5" : row[1]; });
  const char* said = "run_00.csv:42: run \"00\": wz = 100000 holds 100 % of the variance of wz in the training runs";
  EXPECT_THAT(run().err, HasSubstr(said));
  EXPECT_THAT(check().out, HasSubstr("run_00.csv:42: run \"00\": wz = 100000"));
  // In a held-out run, the column affects scores but no model. Samples with data.where = false are not data.
  change("run_00.csv", [](int, Row&) {});
  EXPECT_THAT(run().err, Not(HasSubstr("% of the variance of")));
  change("run_01.csv", [](int line, Row& row) { row[1] = line == 42 ? "1e5" : row[1]; });
  EXPECT_THAT(run().err, Not(HasSubstr("in the training runs")));
  change("run_01.csv", [](int, Row&) {});
  change("run_00.csv", [](int line, Row& row) { row[1] = line == 42 ? "1e5" : row[1]; });
  EXPECT_THAT(run({"--data.where", "abs(wz) < 1000", "--window.length", "15"}).err,
              Not(HasSubstr("% of the variance of")));
}

}  // namespace
}  // namespace modebank::test
