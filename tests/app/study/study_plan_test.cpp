#include "app/study/space/study_plan.hpp"

#include <gtest/gtest.h>

#include <set>

#include "app/config/config_file.hpp"
#include "app/config/option_table.hpp"
#include "modebank/base/error.hpp"
#include "tests/app/cli_fixture.hpp"

namespace modebank::test {
namespace {

using namespace modebank::app;

class StudyPlans : public CliTest {
 protected:
  Config configured(const KeyValues& overrides) const {
    KeyValues all{{"study.output", file("study").string()}};
    all.insert(all.end(), overrides.begin(), overrides.end());
    return load_config(config(), all);
  }
  StudyPlan plan(const KeyValues& overrides) const {
    Provenance provenance;
    provenance.modebank_version = "1";
    return make_plan(configured(overrides), provenance);
  }
  static std::set<std::string> keys(const StudyPlan& plan) {
    std::set<std::string> all;
    for (const TrialRow& row : plan.table.rows) all.insert(row.key);
    return all;
  }
  static std::string refusal(const StudyPlan& before, const StudyPlan& now) {
    try {
      check_plan_goes_on(before, now, "folder");
    } catch (const std::exception& error) {
      return error.what();
    }
    return "";
  }
};

const KeyValues three{{"study.vary", "mixture.components = 1 | 2 | 3"}};

TEST_F(StudyPlans, KeysNameConfigurationAndDataWhateverTheStudyAroundThem) {
  const std::set<std::string> expected =
      keys(plan({{"study.vary", "mixture.components = 1 | 2"}, {"study.vary", "filter.variant = imm | kf"}}));
  EXPECT_EQ(expected.size(), 4u);
  EXPECT_EQ(keys(plan({{"study.vary", "filter.variant = kf | imm"}, {"study.vary", "mixture.components = {1..2}"}})),
            expected);
  EXPECT_EQ(keys(plan({{"study.vary", "mixture.components = 1 | 2"},
                       {"study.vary", "filter.variant = imm | kf"},
                       {"job.threads", "7"},
                       {"archive.output", "elsewhere.h5"},
                       {"study.jobs", "3"}})),
            expected);
  write("run_01.csv", csv_run(80, 9));
  const std::set<std::string> other =
      keys(plan({{"study.vary", "mixture.components = 1 | 2"}, {"study.vary", "filter.variant = imm | kf"}}));
  for (const std::string& key : other) EXPECT_EQ(expected.count(key), 0u);
}

TEST_F(StudyPlans, InvalidCombinationsAreDroppedWithTheReason) {
  const StudyPlan made = plan(
      {{"study.vary", "mixture.error_aware = true | false"}, {"study.vary", "window.covariance = model | sandwich"}});
  ASSERT_EQ(made.table.rows.size(), 4u);
  std::size_t dropped = 0;
  for (const TrialRow& row : made.table.rows) {
    if (row.status != TrialStatus::dropped) continue;
    ++dropped;
    EXPECT_EQ(row.varied, (std::vector<std::string>{"true", "sandwich"}));
    EXPECT_NE(row.message.find("window.covariance"), std::string::npos);
    EXPECT_TRUE(row.key.empty());
  }
  EXPECT_EQ(dropped, 1u);
}

TEST_F(StudyPlans, RepeatsBeginWithTheOwnSeedAndDoNotDependOnTheRest) {
  const StudyPlan few = plan({{"study.vary", "mixture.components = 1 | 2"}, {"study.repeats", "3"}, {"job.seed", "5"}});
  const StudyPlan many =
      plan({{"study.vary", "mixture.components = 2 | 3"}, {"study.repeats", "4"}, {"job.seed", "5"}});
  ASSERT_EQ(few.table.rows.size(), 6u);
  EXPECT_EQ(few.table.rows[0].seed, 5u);
  EXPECT_EQ(few.table.rows[3].seed, 5u);
  std::set<std::uint64_t> seeds;
  for (int r = 0; r < 3; ++r) {
    seeds.insert(few.table.rows[r].seed);
    EXPECT_EQ(few.table.rows[3 + r].seed, many.table.rows[r].seed);
    EXPECT_EQ(few.table.rows[3 + r].key, many.table.rows[r].key);
  }
  EXPECT_EQ(seeds.size(), 3u);
}

/// Runs that differ only in job.seed are repeats of one setting, as with study.repeats.
TEST_F(StudyPlans, AVariedSeedCountsAsRepeats) {
  const StudyPlan seeded = plan({{"study.vary", "job.seed = 7 | 8 | 9"}, {"study.vary", "mixture.components = 1 | 2"}});
  EXPECT_EQ(seeded.table.varied_keys, std::vector<std::string>{"mixture.components"});
  ASSERT_EQ(seeded.table.rows.size(), 6u);
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_EQ(seeded.table.rows[i].varied, std::vector<std::string>{i < 3 ? "1" : "2"});
    EXPECT_EQ(seeded.table.rows[i].repeat, static_cast<std::int64_t>(i % 3));
    EXPECT_EQ(seeded.table.rows[i].seed, 7 + i % 3);
  }
  // The key equals the key of the same run in a study that does not vary the seed.
  EXPECT_EQ(seeded.table.rows[4].key,
            plan({{"study.vary", "mixture.components = 2"}, {"job.seed", "8"}}).table.rows[0].key);
  const StudyPlan alone = plan({{"study.vary", "job.seed = 7 | 8"}, {"study.repeats", "2"}});
  EXPECT_TRUE(alone.table.varied_keys.empty());
  ASSERT_EQ(alone.table.rows.size(), 4u);
  EXPECT_EQ(alone.table.rows[2].seed, 8u);
  EXPECT_EQ(alone.table.rows[3].repeat, 3);
  EXPECT_NE(alone.table.rows[3].seed, alone.table.rows[1].seed);
}

TEST_F(StudyPlans, TrialsAreConfigurationsOfTheirOwn) {
  const Config study = configured({{"study.vary", "mixture.components = 3"}, {"archive.output", "x.h5"}});
  StudyPlan made = plan({{"study.vary", "mixture.components = 3"}});
  const Config trial = trial_config(study, made.table.varied_keys, made.table.rows[0]);
  EXPECT_EQ(trial.mixture.selection.components, std::vector<Index>{3});
  EXPECT_TRUE(trial.study.vary.empty());
  EXPECT_EQ(trial.archive.output, trial_archive(file("study"), made.table.rows[0].key).string());
  // The configuration in an archive has the same hash after it is read back.
  EXPECT_EQ(config_hash(resolved_config(resolved_text(trial))), config_hash(trial));
}

TEST_F(StudyPlans, PlanFilesReadBack) {
  StudyPlan made = plan(
      {{"study.vary", "mixture.error_aware = true | false"}, {"study.vary", "window.covariance = model | sandwich"}});
  write_plan(file(""), made);
  const StudyPlan stored = read_plan(file(""));
  EXPECT_EQ(stored.config, made.config);
  EXPECT_EQ(stored.table.varied_keys, made.table.varied_keys);
  ASSERT_EQ(stored.table.rows.size(), made.table.rows.size());
  for (std::size_t i = 0; i < made.table.rows.size(); ++i) {
    EXPECT_EQ(stored.table.rows[i].key, made.table.rows[i].key);
    EXPECT_EQ(stored.table.rows[i].varied, made.table.rows[i].varied);
    EXPECT_EQ(stored.table.rows[i].seed, made.table.rows[i].seed);
    EXPECT_EQ(stored.table.rows[i].status, made.table.rows[i].status);
    EXPECT_EQ(stored.table.rows[i].message, made.table.rows[i].message);
  }
  ASSERT_EQ(stored.provenance.inputs.size(), 2u);
  EXPECT_EQ(refusal(stored, made), "");
}

TEST_F(StudyPlans, MoreValuesGoOnOthersAreRefusedWithTheDifference) {
  const StudyPlan before = plan(three);
  EXPECT_EQ(refusal(before, plan({{"study.vary", "mixture.components = {1..5}"}})), "");
  EXPECT_EQ(refusal(before, plan({{"study.vary", "mixture.components = {1..3}"}, {"study.repeats", "2"}})), "");
  // A new varied key is accepted if its values include the configured value.
  EXPECT_EQ(refusal(before,
                    plan({{"study.vary", "mixture.components = {1..3}"}, {"study.vary", "filter.variant = imm | kf"}})),
            "");
  const std::string fewer = refusal(before, plan({{"study.vary", "mixture.components = 1 | 2"}}));
  EXPECT_NE(fewer.find("1 of its 3 runs"), std::string::npos) << fewer;
  KeyValues changed = three;
  changed.emplace_back("mixture.restarts", "3");
  const std::string other = refusal(before, plan(changed));
  EXPECT_NE(other.find("mixture.restarts '5' -> '3'"), std::string::npos) << other;
}

TEST_F(StudyPlans, ChangedDataAreRefusedWithTheFile) {
  const StudyPlan before = plan(three);
  write("run_01.csv", csv_run(80, 9));
  const StudyPlan now = plan(three);
  EXPECT_THROW(check_plan_goes_on(before, now, "folder"), DataError);
  const std::string text = refusal(before, now);
  EXPECT_NE(text.find("run_01.csv has SHA-256"), std::string::npos) << text;
  EXPECT_EQ(text.find("run_00.csv"), std::string::npos) << text;
}

}  // namespace
}  // namespace modebank::test
