// Pairs of samples from two archives, and of repeats of two settings.
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "app/report/page/paired_runs.hpp"
#include "app/report/page/study_page.hpp"

namespace modebank::test {
namespace {

using app::report::gain_between;

/// Six held-out runs with the same rate. `gains[r]`: how much better every sample of run r is predicted.
Archive archive_with(const std::vector<double>& gains) {
  Archive archive;
  archive.recording.emplace();
  FilterEvaluation evaluation;
  evaluation.filter = "bank";
  for (std::size_t r = 0; r < gains.size(); ++r) {
    Trajectory run;
    run.run = std::to_string(r);
    run.role = Role::test;
    run.time_s = Eigen::VectorXd::LinSpaced(50, 0.0, 4.9);
    run.state = Eigen::MatrixXd::Constant(1, 50, static_cast<double>(r));
    archive.recording->runs.push_back(run);
    RunEvaluation scored;
    scored.log_density = Eigen::VectorXd::Constant(50, gains[r]);
    scored.log_density(0) = NAN;
    evaluation.runs.push_back(scored);
  }
  archive.evaluations.push_back(evaluation);
  archive.summary.push_back({"bank", Role::test, "*"});
  return archive;
}

/// The runs have equal length, so the error is that of the mean of six numbers.
TEST(PairedRuns, TheErrorIsThatOfTheRunsMeans) {
  const std::vector<double> gains{0.1, 0.3, 0.2, -0.1, 0.4, 0.15};
  const auto result = gain_between(archive_with(gains), archive_with(std::vector<double>(6, 0.0)));
  const double mean = std::accumulate(gains.begin(), gains.end(), 0.0) / 6;
  double squares = 0.0;
  for (const double gain : gains) squares += (gain - mean) * (gain - mean);
  EXPECT_EQ(result.runs, 6);
  EXPECT_NEAR(result.gain.gain, mean, 1e-12);
  EXPECT_NEAR(result.gain.standard_error, std::sqrt(squares / 5 / 6), 1e-12);
  EXPECT_NEAR(result.gain.margin, 2.5705818356363 * std::sqrt(squares / 5 / 6), 1e-9);  // t(0.975, 5)
}

TEST(PairedRuns, OtherSamplesDoNotCount) {
  Archive first = archive_with({0.1, 0.2, 0.3}), second = archive_with({0.0, 0.0, 0.0});
  second.recording->runs[1].state *= 2.0;     // other measurements
  second.recording->runs[2].run = "another";  // another run
  EXPECT_EQ(gain_between(first, second).runs, 1);
  second.recording->runs[0].time_s *= 2.0;
  const auto none = gain_between(first, second);
  EXPECT_EQ(none.runs, 0);
  EXPECT_TRUE(std::isnan(none.gain.gain));
  EXPECT_NE(none.difference, "");
}

TEST(RepeatGain, IsPairedByRepeat) {
  app::StudyTable table;
  table.score_names = {"bank_test_log_score"};
  for (const double score : {1.0, 2.0, 3.0, 0.8, 1.9, 2.7}) {
    app::TrialRow row;
    row.repeat = static_cast<std::int64_t>(table.rows.size() % 3);
    row.scores = {score};
    table.rows.push_back(row);
  }
  const auto gain = app::report::repeat_gain(table, {0, 1, 2}, {3, 4, 5}, 0);
  EXPECT_EQ(gain.repeats, 3);
  EXPECT_NEAR(gain.gain, 0.2, 1e-12);
  EXPECT_NEAR(gain.standard_error, 0.1 / std::sqrt(3.0), 1e-12);  // standard error of the mean of 0.2, 0.1, 0.3
  EXPECT_NEAR(gain.margin, 4.302652729749464 * 0.1 / std::sqrt(3.0), 1e-9);
  EXPECT_TRUE(std::isnan(app::report::repeat_gain(table, {0}, {3}, 0).margin));
  EXPECT_EQ(app::report::repeat_gain(table, {0}, {4}, 0).repeats, 0);
}

}  // namespace
}  // namespace modebank::test
