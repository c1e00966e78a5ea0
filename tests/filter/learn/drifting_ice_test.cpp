// The drifting model on the runs of the Husky on ice, compared with an independent numpy script.
#include <gtest/gtest.h>

#include <cmath>

#include "filter/judge/horizon.hpp"
#include "filter/learn/competitors/competitors.hpp"
#include "ident/fit/global_model.hpp"
#include "io/import/import.hpp"
#include "tests/support/golden.hpp"
#include "tests/support/matrix_compare.hpp"
#include "tests/support/paths.hpp"

namespace modebank {
namespace {

constexpr double exact = 1e-8;

Recording ice() {
  DataOptions options;
  options.root = test::shared_data_dir().string();
  options.inputs = "borealtc/ICE/pro_*.csv";
  options.states = "borealtc/ICE/imu_*.csv";
  options.state = {"wz"};
  options.input = {"velL", "velR"};
  return import_data(options).recording;
}

/// Sums over the scored samples of the held-out runs.
struct Sums {
  double samples = 0.0, log_density = 0.0, square = 0.0;

  void add(double density, double error) {
    if (std::isnan(density)) return;
    ++samples;
    log_density += density;
    square += error * error;
  }
  void expect(const nlohmann::json& golden) const {
    EXPECT_EQ(samples, golden.at("samples").get<double>());
    EXPECT_NEAR(log_density / samples, golden.at("log_score").get<double>(), exact);
    EXPECT_NEAR(std::sqrt(square / samples), golden.at("rmse").get<double>(), exact);
  }
};

class DriftingIce : public ::testing::TestWithParam<std::pair<const char*, LinearStructure>> {};

TEST_P(DriftingIce, GridScoresAndHorizonsAreNumpys) {
  MODEBANK_NEEDS_SHARED_DATA();
  const auto& [name, structure] = GetParam();
  const nlohmann::json golden = test::read_golden("drifting").at(name);
  const Recording recording = ice();
  const GlobalModel global = fit_global(recording, structure);
  const Bank model = learn_drifting(recording, global, structure, {1, 2, 10});
  Eigen::VectorXd full = model.theta(0);
  full(0) += 1.0;
  EXPECT_TRUE(test::near(full, test::golden_rows(golden.at("theta0")), exact));
  EXPECT_TRUE(test::near(model.drift.scale, test::golden_rows(golden.at("scale")), exact));
  EXPECT_NEAR(model.noise_variance()(0), golden.at("v0").get<double>(), exact * model.noise_variance()(0));
  EXPECT_EQ(model.drift.tuning.samples, golden.at("samples").get<Index>());

  const DriftingScores scores = score_drifting_grid(model, recording, {});
  EXPECT_EQ(scores.best(), golden.at("best").get<Index>());
  EXPECT_NEAR(model.drift.tuning.log_score, golden.at("log_score").get<double>(), exact);
  for (const nlohmann::json& other : golden.at("others"))
    EXPECT_NEAR(scores.log_score(other.at(0).get<Index>()), other.at(1).get<double>(), exact) << other.at(0);
  const std::vector<double> point = golden.at("point").get<std::vector<double>>();
  EXPECT_EQ((std::vector<double>{model.drift.rates.q, model.drift.rates.p0, model.drift.rates.leak,
                                 model.running_noise.lam, model.running_noise.nu}),
            std::vector<double>(point.begin(), point.begin() + 5));

  std::vector<Sums> ahead(3);
  for (const Trajectory& run : recording.runs) {
    if (run.role != Role::test) continue;
    const HorizonEvaluation many = evaluate_horizons(model, run, {}, {1, 2, 10});
    for (Index k = 0; k < run.samples(); ++k)
      for (std::size_t h = 0; h < 3; ++h) ahead[h].add(many.log_density(static_cast<Index>(h), k), many.error[h](0, k));
  }
  const nlohmann::json& held_out = golden.at("test");
  ahead[0].expect(held_out);
  for (std::size_t h = 0; h < 3; ++h) {
    SCOPED_TRACE(h);
    const nlohmann::json& expected = held_out.at("horizons").at(h);
    EXPECT_NEAR(model.running_noise.factor_at(expected.at("horizon").get<Index>()), expected.at("factor").get<double>(),
                exact);
    ahead[h].expect(expected);
  }
}

INSTANTIATE_TEST_SUITE_P(Structures, DriftingIce,
                         testing::Values(std::pair{"linear", LinearStructure{1, 2, false}},
                                         std::pair{"varx", LinearStructure{1, 2, false, 2, 2, 1}}),
                         [](const auto& instance) { return std::string(instance.param.first); });

}  // namespace
}  // namespace modebank
