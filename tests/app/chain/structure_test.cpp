// window.model = auto and window.intercept in the program: its result, archive and texts, and the keys that keep their
// values.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <boost/random/normal_distribution.hpp>
#include <cmath>
#include <random>

#include "app/config/config_file.hpp"
#include "app/config/option_table.hpp"
#include "filter/learn/chain/stages.hpp"
#include "io/archive/archive.hpp"
#include "tests/app/cli_fixture.hpp"
#include "tests/filter/learn/learn_test_support.hpp"

namespace modebank::test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class StructureOfRuns : public CliTest {
 protected:
  ProgramResult run_automatic(std::vector<std::string> more = {}) const {
    const std::vector<std::string> automatic{"--window.length", "10", "--window.model", "auto"};
    more.insert(more.begin(), automatic.begin(), automatic.end());
    return run(more);
  }
  ProgramResult run_stated(const FoundStructure& found) const {
    return run({"--window.length", "10", "--window.model", "varx", "--window.state_lags",
                std::to_string(found.state_lags), "--window.input_lags", std::to_string(found.input_lags),
                "--window.input_delay", std::to_string(found.input_delay.latest())});
  }
};

TEST_F(StructureOfRuns, IsInTheArchiveWithItsScoresAndInWhatIsPrinted) {
  const ProgramResult result = run_automatic();
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_THAT(result.out, AllOf(HasSubstr("\nstructure "), HasSubstr("left-out")));
  const Archive made = read_archive(archive());
  ASSERT_TRUE(made.structure.has_value());
  const FoundStructure& found = *made.structure;
  ASSERT_FALSE(found.scores.empty());
  EXPECT_EQ(std::count_if(found.scores.begin(), found.scores.end(), [](const StructureScore& s) { return s.chosen; }),
            1);
  for (const bool StructureScore::*taken :
       {&StructureScore::linear, &StructureScore::one_motion, &StructureScore::drifting})
    EXPECT_EQ(std::count_if(found.scores.begin(), found.scores.end(), [&](const auto& s) { return s.*taken; }), 1);
  for (const StructureScore& s : found.scores) {
    if (std::isnan(s.log_score)) continue;  // this candidate belongs to other stages
    EXPECT_NEAR(s.loss, found.scores.front().log_score - s.log_score, 1e-12);
    EXPECT_EQ(s.rmse.size(), made.recording->state_count());
    if (!s.chosen) continue;
    EXPECT_EQ(s.state_lags, found.state_lags);
    EXPECT_EQ(s.input_lags, found.input_lags);
    EXPECT_EQ(s.input_delay, found.input_delay);
  }
  EXPECT_EQ(made.windows->structure.state_lags, found.state_lags);
  EXPECT_EQ(made.bank->structure.input_lags, found.input_lags);
  EXPECT_EQ(made.bank->structure.input_delay, found.input_delay);
  EXPECT_THAT(made.config, AllOf(HasSubstr("model = auto"), HasSubstr("state_lags = auto"),
                                 HasSubstr("input_lags = auto"), HasSubstr("input_delay = auto")));
  EXPECT_THAT(modebank({"show", archive()}).out, AllOf(HasSubstr("log score"), HasSubstr("state lags")));
  const ProgramResult verified = modebank({"verify", archive()});
  EXPECT_EQ(verified.status, 0) << verified.err;
  // If the found numbers are stated in the configuration, the bank is the same.
  ASSERT_EQ(run_stated(found).status, 0);
  const Archive stated = read_archive(archive());
  EXPECT_FALSE(stated.structure.has_value());
  EXPECT_EQ(stated.bank->modes.front().model.A, made.bank->modes.front().model.A);
}

TEST_F(StructureOfRuns, KeepsTheNumbersThatAreGiven) {
  ASSERT_EQ(run_automatic({"--window.state_lags", "2", "--window.input_delay", "2"}).status, 0);
  const Archive made = read_archive(archive());
  EXPECT_EQ(made.bank->structure.state_lags, 2);
  EXPECT_EQ(made.bank->structure.input_delay, 2);
  for (const StructureScore& s : made.structure->scores) {
    EXPECT_EQ(s.state_lags, 2);
    EXPECT_EQ(s.input_delay, 2);
  }
  EXPECT_THAT(made.config, AllOf(HasSubstr("state_lags = 2"), HasSubstr("input_lags = auto")));
}

/// One state that switches between two motions, logged about other zeros of state and input.
std::string run_about(double of_state, double of_input, unsigned seed) {
  std::mt19937_64 generator(seed);
  boost::random::normal_distribution<double> noise(0.0, 0.03);
  std::string text = "time,x,u\n";
  double x = 0.0, u = 0.0;
  for (int k = 0; k < 240; ++k) {
    if (k % 12 == 0) u = static_cast<double>(generator() % 4);
    text += fmt::format("{:.1f},{:.6f},{:.2f}\n", 0.1 * k, x + of_state, u + of_input);
    x += (k / 60 % 2 == 0 ? 0.06 - 0.1 * x + 0.1 * u : -0.09 - 0.4 * x + 0.8 * u) + noise(generator);
  }
  return text;
}

/// Motions, noises and scores of all filters, and the clusters of windows; or the standard errors and R, which is 1e-8.
std::vector<Eigen::MatrixXd> numbers_of(const Archive& archive, bool errors) {
  std::vector<Eigen::MatrixXd> all;
  if (!errors) all.push_back(archive.mixture->mixture.means);
  for (const SummaryRow& row : archive.summary) {
    if (!errors) all.emplace_back(Eigen::MatrixXd::Constant(1, 1, row.log_score));
    const std::optional<Bank> bank = archive.bank_of(row.filter);
    if (!bank) continue;
    for (const Mode& mode : bank->modes) {
      if (!errors) all.insert(all.end(), {mode.model.A, mode.model.B, mode.Q});
      if (errors && row.filter != "combined") all.emplace_back(mode.standard_error);
    }
    if (errors) all.push_back(bank->R);
  }
  return all;
}

TEST_F(StructureOfRuns, DoNotDependOnWhereZeroLies) {
  write("test.ini",
        "[data]\ninputs = run_*.csv\nstate = x\ninput = u\n[window]\nintercept = true\nstate_lags = 1\n"
        "input_lags = 1\ninput_delay = 1\n[mixture]\ncomponents = 1..3\n");
  const auto learned = [&](double of_state, double of_input) {
    for (unsigned r = 0; r < 4; ++r) write(fmt::format("run_{:02}.csv", r), run_about(of_state, of_input, r + 1));
    const ProgramResult result = run();
    EXPECT_EQ(result.status, 0) << result.err;
    return read_archive(archive());
  };
  const Archive about_zero = learned(0.0, 0.0);
  for (const auto& [of_state, of_input] : {std::pair{9999.0, 0.0}, {101325.0, 0.0}, {0.0, 9999.0}}) {
    const Archive about_other = learned(of_state, of_input);
    for (const bool errors : {false, true}) {
      const auto expected = numbers_of(about_zero, errors), actual = numbers_of(about_other, errors);
      ASSERT_EQ(actual.size(), expected.size());
      for (std::size_t i = 0; i < actual.size(); ++i)
        EXPECT_LE((actual[i] - expected[i]).norm(), (errors ? 1e-5 : 1e-6) * expected[i].norm())
            << of_state << ' ' << of_input << ' ' << errors << ' ' << i;
    }
  }
}

/// window.model on the command line replaces the model of the file together with the file's lags.
TEST_F(StructureOfRuns, OfTheCommandLineForgetsTheLagsOfTheFile) {
  write_file(file("lags.ini"), "[window]\nmodel = varx\nstate_lags = 3\n");
  const auto text = [&](const app::KeyValues& keys) {
    return app::resolved_text(app::load_config(file("lags.ini"), keys));
  };
  EXPECT_THAT(text({{"window.model", "auto"}}), HasSubstr("state_lags = auto"));
  EXPECT_THAT(text({{"window.state_lags", "4"}, {"window.model", "auto"}}), HasSubstr("state_lags = 4"));
  EXPECT_THAT(text({}), AllOf(HasSubstr("state_lags = 3"), HasSubstr("input_lags = 1")));
  write_file(file("lags.ini"), "[window]\nstate_lags = 3\nmodel = auto\n");
  EXPECT_THAT(text({}), AllOf(HasSubstr("state_lags = 3"), HasSubstr("input_delay = auto")));
}

TEST(WindowLengthKey, FollowsTheModelUnlessItIsGiven) {
  app::Config config;
  const app::Option& length = *app::find_option("window.length");
  EXPECT_EQ(length.get(config), "auto");
  EXPECT_TRUE(app::chain_options(config).automatic_windows.length);
  app::find_option("window.model")->set(config, "linear");
  EXPECT_EQ(length.get(config), "25");
  EXPECT_FALSE(app::chain_options(config).automatic_windows.length);
  app::find_option("window.model")->set(config, "auto");
  length.set(config, "40");
  EXPECT_EQ(length.get(config), "40");
  EXPECT_FALSE(app::chain_options(config).automatic_windows.length);
  app::find_option("window.model")->set(config, "linear");
  length.set(config, "auto");
  EXPECT_EQ(length.get(config), "auto");
  EXPECT_TRUE(app::chain_options(config).automatic_windows.length);
}

/// If there are thirteen coefficients or more, windows are longer and one-lag fits are clustered. The texts state both.
TEST_F(StructureOfRuns, WindowsOfManyLagsAreLongerAndClusteredByOneLagFits) {
  ASSERT_EQ(
      run({"--window.model", "varx", "--window.state_lags", "6", "--window.input_lags", "6", "--window.length", "auto"})
          .status,
      0);
  const Archive made = read_archive(archive());
  const Index regressors = made.windows->structure.regressors();
  EXPECT_GE(2 * made.windows->length, 3 * regressors);
  EXPECT_LE(made.windows->length, 3 * regressors);
  EXPECT_EQ(made.mixture->feature_names.front(), "A");
  EXPECT_EQ(made.mixture->features.cols(), made.windows->count());
  EXPECT_EQ(made.bank->structure.state_lags, 6);
  EXPECT_THAT(modebank({"show", archive()}).out, HasSubstr("of one-lag fits of the same windows"));
  EXPECT_EQ(modebank({"verify", archive()}).status, 0);
  EXPECT_EQ(modebank({"report", archive(), "-o", file("page.html")}).status, 0);
  EXPECT_EQ(
      run({"--window.model", "varx", "--window.state_lags", "8", "--window.input_lags", "8", "--bank.theta", "mean"})
          .status,
      2);
}

/// The inputs act with opposite signs in two modes. In a single linear model these effects cancel, so it may choose a
/// wrong delay. With that delay no modes would be found.
TEST(StageStructures, ModesAreAskedForTheUsualDelayToo) {
  const Recording recording = simulated_runs(6, 300, 1, [](const auto& x, const auto& u, Index k, double w) {
    return 0.5 * x(k) + (k / 60 % 2 == 0 ? 0.4 : -0.4) * u(k) + 0.05 * w;
  });
  FoundStructure found{1, 1, 2};
  StructureScore linear{1, 1, 2};
  linear.rmse = Eigen::VectorXd::Ones(1);
  linear.chosen = true;
  found.scores = {linear};
  choose_for_stages(recording, {{true, true, true}, {}}, found);
  EXPECT_EQ(found.delays_of_modes(), 1);
  EXPECT_EQ(found.input_delay, 2);
}

/// Lags in the configuration may need more measured samples than a free run has at its start. These lags stay, and no
/// other lags are tried.
TEST(StageStructures, StatedLagsBeyondAFreeRunStay) {
  Recording recording = empty_recording(1, 1);
  for (Index r = 0; r < 4; ++r) add_run(recording, Eigen::MatrixXd::Random(1, 100), Eigen::MatrixXd::Random(1, 100));
  FoundStructure found{5, 1, 1};
  StructureScore stated{5, 1, 1};
  stated.rmse = Eigen::VectorXd::Ones(1);
  stated.chosen = true;
  found.scores = {stated};
  choose_for_stages(recording, {{false, true, true, 3}, {}}, found);
  EXPECT_EQ(found.state_lags, 5);
  EXPECT_EQ(found.scores.size(), 1u);
  EXPECT_TRUE(found.scores.front().drifting);
}

}  // namespace
}  // namespace modebank::test
