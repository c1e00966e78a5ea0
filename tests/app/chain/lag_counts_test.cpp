// Numbers of lags that are found by cross-validation, on simulated systems whose order is known.
#include "ident/fit/lag_counts.hpp"

#include <gmock/gmock.h>

#include <boost/random/normal_distribution.hpp>
#include <nlohmann/json.hpp>
#include <random>

#include "app/chain/stages.hpp"
#include "app/config/config_file.hpp"
#include "filter/judge/paired_gain.hpp"
#include "tests/app/cli_fixture.hpp"

namespace modebank::test {
namespace {

using Eigen::Index;
using ::testing::AllOf;
using ::testing::HasSubstr;

/// y[k+1] = sum_i a_i y[k+1-i] + 0.3 u[k] + noise, u held for five samples.
Recording arx_runs(const std::vector<double>& a, Index runs, Index samples, std::uint64_t seed) {
  std::mt19937_64 generator(seed);
  boost::random::normal_distribution<double> normal;
  Recording recording{{{"y", ""}}, {{"u", ""}}, {}};
  for (Index r = 0; r < runs; ++r) {
    Trajectory run;
    run.run = "run" + std::to_string(r);
    run.time_s = Eigen::VectorXd::LinSpaced(samples, 0.0, 0.1 * static_cast<double>(samples - 1));
    run.state = Eigen::MatrixXd::Zero(1, samples);
    run.input = Eigen::MatrixXd::Zero(1, samples);
    double u = 0.0;
    for (Index k = 0; k < samples; ++k) {
      if (k % 5 == 0) u = normal(generator);
      run.input(0, k) = u;
      if (k + 1 == samples) break;
      run.state(0, k + 1) = 0.3 * u + 0.1 * normal(generator);
      for (Index i = 0; i < std::ssize(a) && i <= k; ++i)
        run.state(0, k + 1) += a[static_cast<std::size_t>(i)] * run.state(0, k - i);
    }
    recording.runs.push_back(std::move(run));
  }
  return recording;
}

/// One mode, so that it is quick.
LagCounts found_in(const Recording& recording) {
  ChainOptions options;
  options.window.model = "varx";
  options.window.step = 10;
  options.mixture.selection.components = {1};
  options.bank.em.folds = 2;
  options.bank.em.max_iterations = 10;
  options.automatic_lags = {true, true};
  return find_lag_counts(recording, *chain_inputs(options).lag_counts, Listener());
}

const std::vector<double> one_lag{0.8}, three_lags{0.9, -0.4, 0.25};

TEST(LagCounts, AreThoseOfTheSystemInMostSeeds) {
  constexpr int seeds = 4;
  int three = 0, one = 0, one_input = 0;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    const LagCounts of_three = found_in(arx_runs(three_lags, 10, 120, seed)),
                    of_one = found_in(arx_runs(one_lag, 10, 120, seed));
    three += of_three.state_lags == 3;
    one += of_one.state_lags == 1;
    one_input += (of_three.input_lags == 1) + (of_one.input_lags == 1);
  }
  EXPECT_GE(3 * three, 2 * seeds);
  EXPECT_GE(3 * one, 2 * seeds);
  EXPECT_GE(3 * one_input, 4 * seeds);
}

TEST(LagCounts, AreTheFewestWithinOneStandardErrorOnCommonSamples) {
  const LagCounts found = found_in(arx_runs(three_lags, 1, 600, 3));  // one run: stretches are left out
  ASSERT_EQ(found.scores.size(), 8U);
  for (const char* varied : {"state_lags", "input_lags"}) {
    double best = -1e300;
    int chosen = 0;
    std::ptrdiff_t samples = 0;
    for (const LagCountScore& s : found.scores)
      if (s.varied == varied) best = std::max(best, s.log_score);
    for (const LagCountScore& s : found.scores) {
      if (s.varied != varied) continue;
      if (samples == 0) samples = s.samples;
      EXPECT_EQ(s.samples, samples);
      EXPECT_NEAR(s.loss, best - s.log_score, 1e-12);
      const bool as_good = s.loss <= std::max(s.loss_standard_error, 1e-3);
      EXPECT_EQ(s.chosen, as_good && chosen == 0) << varied << s.log_score;
      chosen += s.chosen;
    }
    EXPECT_EQ(chosen, 1) << varied;
    EXPECT_GT(samples, 500);
  }
}

class LagCountsOfRuns : public CliTest {
 protected:
  const std::vector<std::string> automatic{"--window.length",     "10",   "--window.model",      "varx",
                                           "--window.state_lags", "auto", "--window.input_lags", "auto"};
  ProgramResult run_automatic(std::vector<std::string> more = {}) const {
    more.insert(more.begin(), automatic.begin(), automatic.end());
    return run(more);
  }
};

TEST_F(LagCountsOfRuns, AreInTheArchiveWithTheirScoresAndInWhatIsPrinted) {
  const ProgramResult result = run_automatic();
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("lags found:"));
  const Archive made = read_archive(archive());
  ASSERT_TRUE(made.lag_counts.has_value());
  EXPECT_EQ(made.lag_counts->scores.size(), 8U);
  EXPECT_EQ(made.windows->structure.state_lags, made.lag_counts->state_lags);
  EXPECT_EQ(made.bank->structure.state_lags, made.lag_counts->state_lags);
  EXPECT_EQ(made.bank->structure.input_lags, made.lag_counts->input_lags);
  EXPECT_THAT(made.config, AllOf(HasSubstr("state_lags = auto"), HasSubstr("input_lags = auto")));
  EXPECT_THAT(modebank({"show", archive()}).out, AllOf(HasSubstr("state_lags = "), HasSubstr("input_lags = ")));
  const ProgramResult verified = modebank({"verify", archive()});
  EXPECT_EQ(verified.status, 0) << verified.err;
  // The bank is the one that the same numbers give when they are stated.
  ASSERT_EQ(run({"--window.length", "10", "--window.model", "varx", "--window.state_lags",
                 std::to_string(made.lag_counts->state_lags), "--window.input_lags",
                 std::to_string(made.lag_counts->input_lags)})
                .status,
            0);
  const Archive stated = read_archive(archive());
  EXPECT_FALSE(stated.lag_counts.has_value());
  EXPECT_EQ(stated.bank->modes.front().model.A, made.bank->modes.front().model.A);
}

TEST_F(LagCountsOfRuns, AreRefusedWhereThereAreNone) {
  for (const char* model : {"linear", "icr", "slip"}) {
    const ProgramResult result = run({"--window.model", model, "--window.state_lags", "auto"});
    EXPECT_EQ(result.status, 2);
    EXPECT_THAT(result.err, HasSubstr(std::string("auto are those of model = varx, not of ") + model));
  }
  EXPECT_THAT(run_automatic({"--window.prior_sd", "1, 2"}).err, HasSubstr("give one value for all"));
  EXPECT_THAT(run({"--window.model", "varx", "--window.state_lags", "automatic"}).err, HasSubstr("1 to 100 or auto"));
  EXPECT_EQ(run({"--window.model", "varx", "--window.input_lags", "0"}).status, 2);
}

}  // namespace
}  // namespace modebank::test
