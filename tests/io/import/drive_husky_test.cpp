#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "ident/fit/fit_windows.hpp"
#include "ident/fit/global_model.hpp"
#include "ident/fit/motion_fit.hpp"
#include "io/import/import.hpp"
#include "modebank/ident/auto_diff_motion_model.hpp"
#include "tests/support/paths.hpp"

// The DRIVE data: a Husky under random commands. They are compared with ../shared/data/drive_husky/README.md and
// tests/golden/generate/drive_husky.py.
namespace modebank {
namespace {

DataOptions drive_options(std::vector<std::string> states) {
  DataOptions options;
  options.root = test::shared_data_dir().string();
  options.inputs = "drive_husky/husky_samples.csv";
  options.run = "block";
  options.time = {"t_block"};
  options.state = std::move(states);
  options.input = {"wheel_left", "wheel_right"};
  return options;
}

Recording all_training(Recording recording) {
  for (Trajectory& run : recording.runs) run.role = Role::train;
  return recording;
}

/// The static model y = c + g (right - left).
struct YawRegression {
  template <class T>
  void operator()(const T* b, const T*, const T* u, double, T* next) const {
    next[0] = b[0] + b[1] * (u[1] - u[0]);
  }
};

struct LineFit {
  Eigen::Vector2d coefficients;
  double r_squared;
};

/// Regression of state `i` over all samples without an ICP jump. `steady_only`: only windows at constant speed are
/// used. The truth columns contain the flags for these two conditions.
LineFit regress(const Recording& recording, Index i, bool steady_only) {
  std::vector<double> y, left, right;
  for (const Trajectory& run : recording.runs)
    for (Index k = 0; k < run.samples(); ++k) {
      if (run.truth(0, k) != 0.0 || (steady_only && run.truth(1, k) != 1.0)) continue;
      y.push_back(run.state(i, k));
      left.push_back(run.input(0, k));
      right.push_back(run.input(1, k));
    }
  const auto N = std::ssize(y);
  Trajectory line;  // sample k + 1 responds to input k
  line.time_s = Eigen::VectorXd::LinSpaced(N + 1, 0.0, static_cast<double>(N));
  line.state = Eigen::MatrixXd::Zero(1, N + 1);
  line.input = Eigen::MatrixXd::Zero(2, N + 1);
  line.state.rightCols(N) = Eigen::Map<const Eigen::RowVectorXd>(y.data(), N);
  line.input.row(0).head(N) = Eigen::Map<const Eigen::RowVectorXd>(left.data(), N);
  line.input.row(1).head(N) = Eigen::Map<const Eigen::RowVectorXd>(right.data(), N);
  const auto model = make_auto_diff_model<1, 2, 2>(YawRegression(), "yaw regression", {{"c", "rad/s"}, {"g", "1"}});
  Recording single;
  single.states = {{"y", ""}};
  single.inputs = {{"left", ""}, {"right", ""}};
  single.runs = {line};
  const GlobalModel fit = fit_global(single, *model);
  const auto values = line.state.rightCols(N).array();
  return {fit.theta, 1.0 - fit.noise_variance()(0) / (values - values.mean()).square().mean()};
}

TEST(DriveHusky, RegressionsAreThoseOfItsReadme) {
  MODEBANK_NEEDS_SHARED_DATA();
  DataOptions options = drive_options({"gyro_z", "icp_yawrate_fit"});
  options.truth = {"icp_jump", "steady"};
  const Recording recording = import_data(options).recording;
  const LineFit gyro = regress(recording, 0, false), steady = regress(recording, 0, true),
                icp = regress(recording, 1, false);
  EXPECT_NEAR(gyro.coefficients(0), -0.002, 5e-4);
  EXPECT_NEAR(gyro.coefficients(1), 0.1129, 5e-5);
  EXPECT_NEAR(gyro.r_squared, 0.883, 5e-4);
  EXPECT_NEAR(steady.coefficients(1), 0.1151, 5e-5);
  EXPECT_NEAR(steady.r_squared, 0.905, 5e-4);
  EXPECT_NEAR(icp.coefficients(0), -0.003, 5e-4);
  EXPECT_NEAR(icp.coefficients(1), 0.1139, 5e-5);
  EXPECT_NEAR(icp.r_squared, 0.809, 5e-4);
}

TEST(DriveHusky, ThreeStatesAsNumpyHasThem) {
  MODEBANK_NEEDS_SHARED_DATA();
  const Recording recording =
      all_training(import_data(drive_options({"gyro_z", "icp_vx_fit", "icp_vy_fit"})).recording);
  const GlobalModel global = fit_global(recording, LinearStructure{3, 2, false});
  EXPECT_EQ(global.transitions, 23919);
  Eigen::VectorXd expected(15);
  expected << -0.026277697553, 0.002042120298, 0.005740391973, -0.00268997731, 0.002260471196, 0.006410018526,
      -0.081912255374, -0.03210514036, 0.005841805723, 0.004772058784, 0.01369619869, 0.001030493033, -0.059057259589,
      0.000977240402, -0.000911917783;
  EXPECT_LT((global.theta - expected).cwiseAbs().maxCoeff(), 1e-11);
}

// The wheel columns are 0.3 s late. With the nominal wheel radius, the effective track in these data is 1.43 to 1.46 m.
TEST(DriveHusky, SlipModelFindsTheEffectiveTrack) {
  MODEBANK_NEEDS_SHARED_DATA();
  DataOptions options = drive_options({"gyro_z"});
  options.lag_s = -0.3;
  const GlobalModel global =
      fit_global(all_training(import_data(options).recording), *make_motion_model("slip", {1, 2, 0.165}));
  EXPECT_NEAR(global.theta(0), 1.44, 0.05 * 1.44);
  EXPECT_LT(std::sqrt(global.covariance(0, 0)), 0.03);
  RecordProperty("effective_track_m", std::to_string(global.theta(0)));
}

}  // namespace
}  // namespace modebank
