#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "app/study/answers/answers.hpp"
#include "app/study/answers/answers_text.hpp"

namespace modebank::app {
namespace {

constexpr double absent = std::numeric_limits<double>::quiet_NaN();

TrialRow trial(std::vector<std::string> varied, std::vector<double> scores, std::int64_t repeat = 0) {
  TrialRow row;
  row.key = "key";
  for (const std::string& value : varied) row.key += "-" + value;
  row.key += "-" + std::to_string(repeat);
  row.varied = std::move(varied);
  row.repeat = repeat;
  row.seed = 1 + static_cast<std::uint64_t>(repeat);
  row.status = TrialStatus::done;
  row.scores = std::move(scores);
  return row;
}

/// Two keys with two values each, and two repeats. log score = 10 K + (full ? 1 : 0) + repeat / 10, for K modes.
StudyTable grid() {
  StudyTable table{
      {"mixture.components", "mixture.covariance"}, {"modes", "bank_test_log_score", "bank_test_too_far"}, {}};
  for (const int components : {2, 3})
    for (const std::string covariance : {"full", "diagonal"})
      for (const int repeat : {0, 1}) {
        const double log_score = 10.0 * components + (covariance == "full") + 0.1 * repeat;
        table.rows.push_back(trial({std::to_string(components), covariance},
                                   {static_cast<double>(components), log_score, 0.01 * components}, repeat));
      }
  return table;
}

const MainEffect& effect(const Answers& answers, const std::string& key, const std::string& value,
                         const std::string& score) {
  for (const MainEffect& candidate : answers.main_effects)
    if (candidate.key == key && candidate.value == value && candidate.score == score) return candidate;
  throw std::runtime_error("no effect of " + key + " = " + value + " on " + score);
}

TEST(StudyAnswers, MainEffectsAreMeansOverTheOtherKeys) {
  const Answers answers = answer(grid());
  EXPECT_EQ(answers.headline, "bank_test_log_score");
  const MainEffect& two = effect(answers, "mixture.components", "2", answers.headline);
  EXPECT_EQ(two.trials, 4);
  EXPECT_NEAR(two.mean, (21.0 + 21.1 + 20.0 + 20.1) / 4, 1e-12);
  EXPECT_NEAR(two.sd, std::sqrt(4 * (0.25 + 0.0025) / 3), 1e-12);  // deviations from the mean: +-0.5 +-0.05
  EXPECT_NEAR(effect(answers, "mixture.covariance", "full", answers.headline).mean, 26.05, 1e-12);
  EXPECT_NEAR(effect(answers, "mixture.components", "3", "bank_test_too_far").mean, 0.03, 1e-12);
}

/// In a full grid, the influences of the keys and of the repeats sum to one.
TEST(StudyAnswers, InfluenceIsTheShareOfVarianceExplained) {
  const Answers answers = answer(grid());
  double components = 0, covariance = 0;
  for (const KeyInfluence& influence : answers.influences)
    if (influence.score == answers.headline)
      (influence.key == "mixture.components" ? components : covariance) = influence.share;
  const double total = 25.0 + 0.25 + 0.0025;  // deviations from the mean: +-5, +-0.5 and +-0.05
  EXPECT_NEAR(components, 25.0 / total, 1e-12);
  EXPECT_NEAR(covariance, 0.25 / total, 1e-12);
}

TEST(StudyAnswers, BestIsJudgedByTheMeanOverRepeats) {
  StudyTable table = grid();
  table.rows[0].scores[1] = 100.0;   // K = 2, full: one seed is very good ...
  table.rows[1].scores[1] = -100.0;  // ... and the other seed is very bad
  const Answers answers = answer(table);
  const auto best = std::find_if(answers.best.begin(), answers.best.end(),
                                 [](const BestSetting& b) { return b.score == "bank_test_log_score"; });
  ASSERT_NE(best, answers.best.end());
  EXPECT_NEAR(best->value, 31.05, 1e-12);
  EXPECT_EQ(best->repeats, 2);
  EXPECT_EQ(table.rows[best->row].varied, (std::vector<std::string>{"3", "full"}));
}

TEST(StudyAnswers, GoalsFollowFromTheScoresNames) {
  using Kind = ScoreGoal::Kind;
  EXPECT_EQ(goal_of("bank_test_log_score", 1)->kind, Kind::higher);
  EXPECT_EQ(goal_of("noise_only_train_rmse_wz", 1)->kind, Kind::lower);
  EXPECT_EQ(goal_of("baseline_test_pit_distance", 1)->kind, Kind::lower);
  EXPECT_EQ(goal_of("bank_test_nis_mean", 3)->nominal, 3.0);
  EXPECT_EQ(goal_of("bank_test_nis_below", 3)->nominal, 0.025);
  EXPECT_EQ(goal_of("noise_only_test_too_far", 1)->nominal, 0.025);
  EXPECT_FALSE(goal_of("bank_test_samples", 1));
  EXPECT_FALSE(goal_of("modes", 1));
  const ScoreGoal tail = *goal_of("bank_test_too_far", 1);
  EXPECT_LT(tail.loss(0.02), tail.loss(0.04));
  EXPECT_LT(tail.loss(0.03), tail.loss(0.0));
}

TEST(StudyAnswers, MeanNisIsNearestToTheNumberOfStates) {
  StudyTable table{{"a"}, {"bank_test_rmse_vx", "bank_test_rmse_wz", "bank_test_nis_mean"}, {}};
  table.rows = {trial({"x"}, {1, 1, 1.1}), trial({"y"}, {1, 1, 1.9})};
  const Answers answers = answer(table);
  EXPECT_EQ(answers.best.back().row, 1U);
}

TEST(StudyAnswers, OnlyFinishedTrialsCount) {
  StudyTable table = grid();
  table.rows[0].status = TrialStatus::failed;
  table.rows[1].status = TrialStatus::missing;
  table.rows[2].scores[1] = absent;
  const Answers answers = answer(table);
  EXPECT_EQ(effect(answers, "mixture.components", "2", answers.headline).trials, 1);
  for (TrialRow& row : table.rows) row.status = TrialStatus::failed;
  const Answers nothing = answer(table);
  EXPECT_TRUE(nothing.best.empty());
  EXPECT_EQ(answers_text(table, nothing), "");
}

/// The score depends only on the variant. A value per trial would explain all of it.
TEST(StudyAnswers, ASampledKeyHasNoEffects) {
  StudyTable table{{"window.prior", "filter.variant"}, {"modes", "bank_test_log_score"}, {}};
  for (int i = 0; i < 20; ++i)
    for (const int repeat : {0, 1})
      table.rows.push_back(trial({std::to_string(0.01 * (i * 7 % 20 + 1)), i % 2 == 0 ? "imm" : "kf"},
                                 {2.0, i % 2 == 0 ? 1.0 : 0.0}, repeat));
  const Answers answers = answer(table);
  ASSERT_EQ(answers.influences.size(), 1U);
  EXPECT_EQ(answers.influences[0].key, "filter.variant");
  EXPECT_NEAR(answers.influences[0].share, 1.0, 1e-12);
  StudyTable sweep{{"window.prior"}, table.score_names, {}};  // only one key varies
  for (int i = 0; i < 20; ++i) sweep.rows.push_back(trial({std::to_string(i)}, {2.0, 1.0 * i}));
  EXPECT_EQ(answer(sweep).main_effects.size(), 20U);
  for (int i = 20; i < 40; ++i) sweep.rows.push_back(trial({std::to_string(i)}, {2.0, 1.0 * i}));
  EXPECT_EQ(answer(sweep).main_effects.size(), 0U);
}

}  // namespace
}  // namespace modebank::app
