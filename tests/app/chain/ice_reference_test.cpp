// Values of the reference analysis of the Husky-on-ice runs (BorealTC). An independent numpy script has computed them.
#include <gtest/gtest.h>

#include <algorithm>

#include "app/chain/chain.hpp"
#include "app/config/config.hpp"
#include "filter/judge/scores.hpp"
#include "filter/learn/competitors/competitors.hpp"
#include "filter/learn/from_mixture/bank.hpp"
#include "ident/fit/fit_windows.hpp"
#include "io/import/import.hpp"
#include "tests/support/paths.hpp"

namespace modebank::app {
namespace {

constexpr double theta_tolerance = 2e-4;      // the reference has four decimals
constexpr double variance_tolerance = 1e-3;   // relative; the reference has four digits
constexpr double log_score_tolerance = 0.01;  // both programs maximise the same flat likelihood
constexpr double rmse_tolerance = 2e-4;
constexpr double tail_tolerance = 1e-3;  // the reference has three decimals

Config ice_config(bool odd_runs_train) {
  Config config;
  config.data.root = test::shared_data_dir().string();
  config.data.inputs = "borealtc/ICE/pro_*.csv";
  config.data.states = "borealtc/ICE/imu_*.csv";
  config.data.state = {"wz"};
  config.data.input = {"velL", "velR"};
  config.structure.automatic_model = false;  // the reference uses one lag
  if (odd_runs_train) config.data.train = {"02", "04", "06", "08", "10", "12"};
  return config;
}

/// Values of the reference for one fold.
struct Fold {
  bool odd_runs_train;
  Index transitions, windows;
  Eigen::Vector3d theta;
  double residual_variance;
  double train_log_score, test_log_score, train_rmse, test_rmse;
  double noise_only_log_score;
  double bank_log_score_at_least, bank_rmse_at_most;  // bank with 12 components; mean over seeds
};

void PrintTo(const Fold& fold, std::ostream* out) {
  *out << (fold.odd_runs_train ? "odd runs train" : "even runs train");
}

const Fold even{false, 2636, 2492,  {-0.1561, -0.1615, 0.1610}, 6.015e-4, 2.289, 2.519, 0.0245, 0.0180,
                3.264, 2.9,  0.0180};
const Fold odd{true,  2921, 2777,  {-0.3524, -0.4440, 0.4465}, 2.096e-4, 2.816, 1.684, 0.0145, 0.0262,
               2.741, 2.5,  0.0260};

const SummaryRow& pooled(const std::vector<SummaryRow>& rows, const std::string& filter, Role role) {
  return *std::find_if(rows.begin(), rows.end(), [&](const SummaryRow& row) {
    return row.filter == filter && row.role == role && row.run == "*";
  });
}

/// The reference uses the variance about the mean of the residuals, but Q is the mean square.
double variance_about_mean(const Recording& recording, const GlobalModel& global, const LinearStructure& structure) {
  const LinearModel model = unpack(structure, global.theta);
  double sum = 0.0;
  for (const Trajectory& run : recording.runs)
    for (Index k = 0; run.role == Role::train && k < run.transitions(); ++k)
      sum += run.state(0, k + 1) - model.next(run.state.col(k), run.input.col(k))(0);
  const double mean = sum / static_cast<double>(global.transitions);
  return global.residual_covariance(0, 0) - mean * mean;
}

class IceReference : public ::testing::TestWithParam<Fold> {};

TEST_P(IceReference, CountsGlobalModelAndBaseline) {
  MODEBANK_NEEDS_SHARED_DATA();
  const Fold& fold = GetParam();
  const ChainOptions options = chain_options(ice_config(fold.odd_runs_train));
  StageSource computed;
  const Listener silent;
  Chain chain(computed, silent);
  const Archive& archive = chain.run(options, Stage::windows, {});
  EXPECT_EQ(archive.recording->transitions(Role::train), fold.transitions);
  EXPECT_EQ(archive.windows->count(), fold.windows);
  const GlobalModel& global = archive.windows->global;
  EXPECT_LE((global.theta - fold.theta).cwiseAbs().maxCoeff(), theta_tolerance) << global.theta.transpose();
  EXPECT_NEAR(variance_about_mean(*archive.recording, global, archive.windows->structure), fold.residual_variance,
              variance_tolerance * fold.residual_variance);

  const Baseline baseline = learn_baseline(*archive.recording, global, archive.windows->structure);
  EXPECT_TRUE(baseline.at_bound) << "smooth gyro data show no measurement noise";
  const auto rows_of = [&](const std::string& name, const Bank& bank) {
    const FilterOptions filter = competitor_filter(name);
    return score_filter(name, bank, *archive.recording, filter, options.scoring).summary;
  };
  const std::vector<SummaryRow> summary = rows_of("baseline", baseline.bank);
  const SummaryRow& train = pooled(summary, "baseline", Role::train);
  const SummaryRow& test = pooled(summary, "baseline", Role::test);
  EXPECT_NEAR(train.log_score, fold.train_log_score, log_score_tolerance);
  EXPECT_NEAR(test.log_score, fold.test_log_score, log_score_tolerance);
  EXPECT_NEAR(train.rmse(0), fold.train_rmse, rmse_tolerance);
  EXPECT_NEAR(test.rmse(0), fold.test_rmse, rmse_tolerance);
  if (!fold.odd_runs_train) {
    EXPECT_NEAR(test.too_far, 0.009, tail_tolerance);
    EXPECT_NEAR(test.too_close, 0.030, tail_tolerance);
  }
  const Bank noise_only = learn_noise_only(*archive.recording, archive.windows->structure, baseline.bank.R);
  EXPECT_NEAR(pooled(rows_of("noise_only", noise_only), "noise_only", Role::test).log_score, fold.noise_only_log_score,
              0.05);
}

TEST_P(IceReference, TwelveComponentsReachTheLevel) {
  MODEBANK_NEEDS_SHARED_DATA();
  const Fold& fold = GetParam();
  Config config = ice_config(fold.odd_runs_train);
  config.mixture.selection.components = {12};
  config.bank.refine = Refine::none;           // the reference pools windows and does not refine the bank
  config.mixture.windows = WindowChoice::all;  // as in the reference
  constexpr int seeds = 10;
  double log_score = 0.0, rmse = 0.0;
  for (int seed = 1; seed <= seeds; ++seed) {
    config.job.seed = static_cast<std::uint64_t>(seed);
    StageSource computed;
    const Listener silent;
    Chain chain(computed, silent);
    const Archive& archive = chain.run(chain_options(config), Stage::bank_scores, {});
    const SummaryRow& test = pooled(archive.summary, "bank", Role::test);
    log_score += test.log_score / seeds;
    rmse += test.rmse(0) / seeds;
  }
  RecordProperty("log_score", std::to_string(log_score));
  RecordProperty("rmse", std::to_string(rmse));
  EXPECT_GE(log_score, fold.bank_log_score_at_least);
  EXPECT_LE(rmse, fold.bank_rmse_at_most);
}

/// Only the data determine K. It is the same for covariance floors over four decades and for five seeds.
TEST_P(IceReference, TheNumberOfComponentsDoesNotDependOnTheFloorOrTheSeed) {
  MODEBANK_NEEDS_SHARED_DATA();
  for (const bool varx : {false, true}) {
    Config config = ice_config(GetParam().odd_runs_train);
    if (varx) {
      config.window.model = "varx";
      config.window.state_lags = 3;
    }
    StageSource computed;
    const Listener silent;
    Chain chain(computed, silent);
    const Archive& archive = chain.run(chain_options(config), Stage::windows, {});
    const WindowFits& fits = *archive.windows;
    const FeatureCloud cloud = make_features(fits, archive.recording->states, config.mixture);
    SelectionOptions options = config.mixture.selection;
    options.components = {1, 2, 3, 4, 5, 6, 7, 8};
    for (const double floor : {1e-8, 1e-6, 1e-4})
      for (std::uint64_t seed = 1; seed <= 5; ++seed) {
        options.em.covariance_floor = floor;
        const MixtureResult result = select_mixture(fits, cloud, options, seed);
        const Index components = result.mixture.components();
        EXPECT_EQ(components, GetParam().odd_runs_train ? 1 : 2) << floor << ", seed " << seed;
        EXPECT_FALSE(result.candidates[components - 1].floor_active);
      }
  }
}

INSTANTIATE_TEST_SUITE_P(BothFolds, IceReference, ::testing::Values(even, odd),
                         [](const auto& test) { return test.param.odd_runs_train ? "OddRunsTrain" : "EvenRunsTrain"; });

}  // namespace
}  // namespace modebank::app
