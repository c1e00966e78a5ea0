// The library function learn_bank and `modebank run` give identical banks on the same runs.
#include <gtest/gtest.h>

#include "io/archive/archive.hpp"
#include "modebank/learn/learn.hpp"
#include "tests/app/cli_fixture.hpp"
#include "tests/support/recorded_runs.hpp"

namespace modebank::test {
namespace {

class LearnBank : public CliTest {
 protected:
  /// Makes an archive by `run` with these arguments, learns a bank from the archive's runs, and compares both banks.
  void expect_the_bank_of_run(const std::vector<std::string>& arguments, const LearnOptions& options) {
    const ProgramResult result = run(arguments);
    ASSERT_EQ(result.status, 0) << result.err;
    const Archive made = read_archive(archive());
    const learn::Learned learned = learn::learn_bank(recorded_runs(*made.recording), options);
    const Bank &expected = *made.bank, &bank = learned.bank.internal();
    EXPECT_EQ(bank.structure, expected.structure);
    ASSERT_EQ(bank.mode_count(), expected.mode_count());
    for (std::size_t j = 0; j < bank.modes.size(); ++j) {
      EXPECT_EQ(bank.theta(static_cast<Index>(j)), expected.theta(static_cast<Index>(j)));
      EXPECT_EQ(bank.modes[j].Q, expected.modes[j].Q);
      EXPECT_TRUE(same_bits(to_vector(bank.modes[j].standard_error), to_vector(expected.modes[j].standard_error)));
    }
    EXPECT_EQ(bank.R, expected.R);
    EXPECT_EQ(bank.transition.matrix(), expected.transition.matrix());
    EXPECT_EQ(bank.initial_probability, expected.initial_probability);
    EXPECT_EQ(learned.baseline.internal().R, made.baseline->R);
    EXPECT_EQ(learned.baseline.internal().theta(0), made.baseline->theta(0));
  }
};

LearnOptions as_the_fixture_has_it() {
  LearnOptions options;
  options.window.length = 20;
  options.mixture.selection.components = {1, 2};
  return options;
}

TEST_F(LearnBank, IsThatOfRun) {
  LearnOptions options = as_the_fixture_has_it();
  options.search_lags = options.automatic_length = options.automatic_step = true;
  expect_the_bank_of_run({"--window.model", "auto"}, options);
}

TEST_F(LearnBank, IsThatOfRunWithEveryStageAskedOtherwise) {
  LearnOptions options = as_the_fixture_has_it();
  options.window.loss = Loss::cauchy;
  options.mixture.selection.components = {1, 2, 3};
  options.mixture.selection.em.covariance = CovarianceType::diagonal;
  options.seed = 9;
  expect_the_bank_of_run(
      {"--window.model", "linear", "--window.length", "20", "--window.step", "1", "--window.loss", "cauchy",
       "--mixture.components", "1..3", "--mixture.covariance", "diagonal", "--job.seed", "9", "--bank.refine", "auto"},
      options);
}

TEST_F(LearnBank, IsThatOfRunWithoutRefinement) {
  LearnOptions options = as_the_fixture_has_it();
  options.automatic_step = true;
  options.bank.refine = Refine::none;
  expect_the_bank_of_run(
      {"--window.model", "linear", "--window.length", "20", "--window.step", "auto", "--bank.refine", "none"}, options);
}

TEST_F(LearnBank, IsThatOfRunWhereOneFilterIsAskedFor) {
  LearnOptions options = as_the_fixture_has_it();
  options.search_lags = options.automatic_step = true;
  options.filter.variant = FilterVariant::kf;
  expect_the_bank_of_run(
      {"--window.model", "auto", "--window.length", "20", "--window.step", "auto", "--filter.variant", "kf"}, options);
}

}  // namespace
}  // namespace modebank::test
