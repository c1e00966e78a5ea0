// Free runs: `run` scores them, and `predict` makes them for new inputs.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <fstream>
#include <sstream>

#include "io/archive/archive.hpp"
#include "tests/app/cli_fixture.hpp"

namespace modebank::test {
namespace {

using ::testing::HasSubstr;

class Predict : public CliTest {
 protected:
  struct Line {
    std::string run;
    std::vector<double> values;  ///< fields: time, wz, sd, lower, upper, mode
  };
  static std::vector<Line> lines_of(const std::string& csv) {
    std::istringstream text(csv);
    std::string line;
    std::getline(text, line);
    EXPECT_EQ(line, "run,time,wz_predicted,wz_sd,wz_lower,wz_upper,mode");
    std::vector<Line> lines;
    while (std::getline(text, line)) {
      std::istringstream fields(line);
      Line& next = lines.emplace_back();
      std::getline(fields, next.run, ',');
      for (std::string field; std::getline(fields, field, ',');) next.values.push_back(std::stod(field));
    }
    return lines;
  }

  /// The lines must equal the archive's free run of the same run, sample by sample.
  static void expect_archived(const std::vector<Line>& lines, const FreeRun& expected, Index first) {
    ASSERT_EQ(std::ssize(lines), expected.mean.cols() - first);
    for (Index k = first; k < expected.mean.cols(); ++k) {
      const std::vector<double>& v = lines[static_cast<std::size_t>(k - first)].values;
      EXPECT_EQ(v[1], expected.mean(0, k)) << k;
      EXPECT_EQ(v[2], expected.deviation(0, k)) << k;
      EXPECT_EQ(v[3], expected.lower(0, k)) << k;
      EXPECT_EQ(v[4], expected.upper(0, k)) << k;
      EXPECT_EQ(v[5], expected.mode(k)) << k;
    }
  }

  /// Writes new.csv: run 01, with states only in the first `known` rows.
  void write_new_inputs(int known) const {
    std::ifstream old(file("run_01.csv"));
    std::string line, text;
    for (int row = -1; std::getline(old, line); ++row) {
      const auto state = line.find(',') + 1;
      if (row >= known) line.replace(state, line.find(',', state) - state, "");
      text += line + "\n";
    }
    write("run_01.new", text);
  }
};

TEST_F(Predict, RunScoresEveryFilter) {
  const ProgramResult result = run({"--filter.simulate", "5"});
  ASSERT_EQ(result.status, 0) << result.err;
  const Archive stored = read_archive(archive());
  EXPECT_EQ(stored.free_runs.size(), 6u * 4u);  // five filters and their combination, for two runs and two pools
  for (const FreeRunRow& row : stored.free_runs) {
    EXPECT_EQ(row.samples, 75);
    EXPECT_NEAR(row.fit(0), 100.0 * (1.0 - row.nrmse(0)), 1e-12);
  }
  const Trajectory& measured = stored.recording->runs[1];
  const FreeRun& bank = stored.evaluations[0].free_runs[1];
  const double rmse = std::sqrt((measured.state - bank.mean).rightCols(75).squaredNorm() / 75.0);
  EXPECT_NEAR(stored.free_runs[2].rmse(0), rmse, 1e-12);
  EXPECT_EQ(stored.free_runs[2].run, "01");
  const ProgramResult shown = modebank({"show", archive()});
  EXPECT_THAT(shown.out, HasSubstr("Free run: 5 measured samples"));
  EXPECT_THAT(shown.out, HasSubstr("FIT %"));
  EXPECT_EQ(modebank({"verify", archive()}).status, 0);
  EXPECT_EQ(modebank({"report", archive(), "-o", file("page.html").string()}).status, 0);
}

TEST_F(Predict, SaysOfNewInputsWhatRunSaidOfTheSame) {
  for (const std::string method : {"moments", "paths"}) {
    ASSERT_EQ(run({"--filter.simulate", "5", "--filter.simulate_method", method, "--job.threads", "2"}).status, 0);
    const Archive stored = read_archive(archive());
    write_new_inputs(5);
    for (const FilterEvaluation& evaluation : stored.evaluations) {
      const ProgramResult result = modebank({"predict", archive(), "--data.inputs", file("run_*.new").string(),
                                             "--filter", evaluation.filter, "--job.threads", "1"});
      ASSERT_EQ(result.status, 0) << result.err;
      expect_archived(lines_of(result.out), evaluation.free_runs[1], 5);
    }
  }
}

TEST_F(Predict, WritesAFileOfAsManySamplesAsAreAskedFor) {
  ASSERT_EQ(run().status, 0);
  write_new_inputs(8);
  const std::vector<std::string> command{"predict",   archive(), "--data.inputs", file("run_*.new").string(),
                                         "--samples", "8",       "--horizon",     "10"};
  const ProgramResult printed = modebank(command);
  ASSERT_EQ(printed.status, 0) << printed.err;
  const std::vector<Line> lines = lines_of(printed.out);
  ASSERT_EQ(lines.size(), 10u);
  EXPECT_EQ(lines[0].run, "01");
  EXPECT_NEAR(lines[0].values[0], 0.8, 1e-12);
  std::vector<std::string> to_file = command;
  to_file.insert(to_file.end(), {"-o", file("predicted.csv").string()});
  EXPECT_EQ(modebank(to_file).out, "");
  std::ifstream stream(file("predicted.csv"));
  EXPECT_EQ((std::string{std::istreambuf_iterator<char>(stream), {}}), printed.out);
}

TEST_F(Predict, RefusesWhatItCannotStartFrom) {
  ASSERT_EQ(run({"--window.model", "varx", "--window.state_lags", "3"}).status, 0);
  const auto error = [&](const std::vector<std::string>& options, int status) {
    std::vector<std::string> words{"predict"};
    words.insert(words.end(), options.begin(), options.end());
    const ProgramResult result = modebank(words);
    EXPECT_EQ(result.status, status) << result.err;
    return result.err;
  };
  EXPECT_THAT(error({}, 2), HasSubstr("predict needs one archive"));
  EXPECT_THAT(error({archive()}, 2), HasSubstr("--samples N"));
  EXPECT_THAT(error({archive(), "--samples", "-1"}, 2), HasSubstr("filter.simulate = '-1'"));
  EXPECT_THAT(error({archive(), "--samples", "2"}, 2), HasSubstr("starts from at least 3 measured samples"));
  EXPECT_THAT(error({archive(), "--samples", "5", "--filter", "other"}, 2), HasSubstr("track.filter"));
  EXPECT_THAT(error({archive(), "--samples", "5", "--data.inputs", "none_*.csv"}, 2), HasSubstr("none_*.csv"));
  EXPECT_THAT(error({archive(), "--samples", "80"}, 1), HasSubstr("run 00 has 80 samples, of which 80"));
  write_new_inputs(2);
  EXPECT_THAT(error({archive(), "--samples", "5", "--data.inputs", file("run_*.new").string()}, 1),
              HasSubstr("too few complete measurements among its first 5 samples"));
  const ProgramResult other = run({"--samples", "5"});
  EXPECT_EQ(other.status, 2);
  EXPECT_THAT(other.err, HasSubstr("run does not read --samples"));
  const ProgramResult early = run({"--window.model", "varx", "--window.state_lags", "3", "--filter.simulate", "2"});
  EXPECT_EQ(early.status, 2);
  EXPECT_THAT(early.err, HasSubstr("filter.simulate = 2"));
}

}  // namespace
}  // namespace modebank::test
