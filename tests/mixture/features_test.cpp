#include "mixture/features.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "ident/base/not_a_number.hpp"
#include "tests/support/matrix_compare.hpp"

namespace modebank::test {
namespace {

using Eigen::Index;

/// Five windows of one state and two inputs: valid, rank deficient, failed, not finite, valid. Parameters have the
/// names of linear_model.hpp.
WindowFits five_windows() {
  WindowFits fits;
  fits.structure = LinearStructure{1, 2, false};
  fits.windows = {{0, 0}, {0, 1}, {1, 0}, {1, 1}, {2, 0}};
  fits.parameters.resize(3, 5);
  fits.parameters << -0.1, -0.2, -0.3, -0.4, -0.5, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0;
  fits.parameters(1, 3) = not_a_number;
  fits.noise_variance = (Eigen::MatrixXd(1, 5) << 1.0, 0.5, 0.1, 0.2, 4.0).finished();
  fits.rank = (Eigen::VectorXi(5) << 3, 1, 3, 3, 3).finished();
  fits.status = (Eigen::VectorXi(5) << 0, 2, 3, 0, 1).finished();
  return fits;
}

const std::vector<Channel> states{{"wz", "rad/s"}};

TEST(Features, FullRankWindowsAreChosen) {
  const FeatureCloud cloud = make_features(five_windows(), FeatureSet::parameters, WindowChoice::full_rank, states);
  EXPECT_EQ(cloud.names, (std::vector<std::string>{"A", "B1", "B2"}));
  EXPECT_EQ(cloud.windows, (std::vector<Index>{0, 4}));
  EXPECT_EQ(cloud.runs, (std::vector<Index>{0, 2}));
  EXPECT_TRUE(near(cloud.points, (Eigen::MatrixXd(3, 2) << -0.1, -0.5, 1.0, 5.0, 6.0, 10.0).finished(), 0.0));
}

TEST(Features, AllLeavesOutOnlyFailedAndNonFiniteWindows) {
  const FeatureCloud cloud = make_features(five_windows(), FeatureSet::parameters, WindowChoice::all, states);
  EXPECT_EQ(cloud.windows, (std::vector<Index>{0, 1, 4}));
}

/// Three full-rank windows of length one. If windows begin at every second sample, they are worth two independent
/// windows for each of the three features. If windows begin at every sample, they are worth less.
TEST(Features, AutomaticTakesAllWindowsOnlyWhereTooFewHaveFullRank) {
  WindowFits fits = five_windows();
  const auto automatic = [&] {
    return make_features(fits, FeatureSet::parameters, WindowChoice::automatic, states).windows;
  };
  fits.length = 1;
  fits.step = 1;
  EXPECT_EQ(automatic(), (std::vector<Index>{0, 4})) << "without a prior the others have no theta";
  fits.prior_sd = Eigen::Vector3d::Ones();
  EXPECT_EQ(automatic(), (std::vector<Index>{0, 1, 4}));
  fits.step = 2;
  EXPECT_EQ(automatic(), (std::vector<Index>{0, 4}));
}

TEST(Features, TheOthersAreAssignedWithTheirErrors) {
  WindowFits fits = five_windows();
  fits.length = 1;
  fits.step = 2;
  fits.global.theta = Eigen::Vector3d::Zero();
  fits.transitions = Eigen::VectorXi::Constant(5, 25);
  fits.covariance = Eigen::MatrixXd(0.2 * Eigen::Matrix3d::Identity()).reshaped(9, 1).replicate(1, 5);
  ClusterOptions options;
  options.over_switch = WindowsOverSwitch::keep;
  EXPECT_TRUE(assigned_features(fits, states, options).windows.empty()) << "no prior, no theta";
  fits.prior_sd = Eigen::Vector3d::Ones();
  fits.step = 3;  // for four features
  EXPECT_EQ(make_features(fits, states, options).windows, (std::vector<Index>{0, 4}));
  const FeatureCloud others = assigned_features(fits, states, options);
  ASSERT_EQ(others.windows, (std::vector<Index>{1}));
  EXPECT_NEAR(others.covariances(0, 0), 0.2 / 0.8, 1e-14);
  EXPECT_NEAR(others.covariances(15, 0), 2.0 / (25.0 - 1.0), 1e-14);
  options.windows = WindowChoice::all;
  EXPECT_TRUE(assigned_features(fits, states, options).windows.empty()) << "all are clustered";
}

TEST(Features, TypicalErrorsAreTheMedians) {
  WindowFits fits = five_windows();
  fits.transitions = Eigen::VectorXi::Constant(5, 35);
  fits.covariance = Eigen::MatrixXd::Zero(9, 5);
  fits.covariance.row(0) << 0.04, 0.09, 100.0, 100.0, 0.25;
  const FeatureCloud cloud =
      make_features(fits, FeatureSet::parameters_and_noise, WindowChoice::all, states, WindowsOverSwitch::keep);
  ASSERT_EQ(cloud.windows.size(), 3u);
  EXPECT_NEAR(cloud.typical_error(0), 0.3, 1e-15);
  EXPECT_EQ(cloud.typical_error(1), 0.0) << "not known";
  EXPECT_NEAR(cloud.typical_error(3), std::sqrt(2.0 / 32.0), 1e-15);
}

TEST(Features, NoiseIsTheLogOfTheVariance) {
  const FeatureCloud cloud = make_features(five_windows(), FeatureSet::parameters_and_noise, WindowChoice::all, states);
  EXPECT_EQ(cloud.names, (std::vector<std::string>{"A", "B1", "B2", "log_noise_variance_wz"}));
  EXPECT_TRUE(near(cloud.points.row(3), Eigen::RowVector3d(0.0, std::log(0.5), std::log(4.0)), 1e-15));
}

TEST(Features, WindowWithoutNoiseHasNoLogVariance) {
  WindowFits fits = five_windows();
  fits.noise_variance(0, 0) = 0.0;
  EXPECT_EQ(make_features(fits, FeatureSet::parameters_and_noise, WindowChoice::all, states).windows,
            (std::vector<Index>{1, 4}));
  EXPECT_EQ(make_features(fits, FeatureSet::parameters, WindowChoice::all, states).windows,
            (std::vector<Index>{0, 1, 4}));
}

TEST(Features, StateNamesMustMatch) {
  EXPECT_THROW(make_features(five_windows(), FeatureSet::parameters, WindowChoice::all, {}), std::invalid_argument);
}

/// Points of four features whose central variances are 8/9 of the squared half-widths. The features have different
/// units and errors.
FeatureCloud four_features() {
  FeatureCloud cloud;
  cloud.names = {"a", "b", "c", "d"};
  cloud.points.resize(4, 3);
  cloud.points << -1.0, 0.0, 1.0, -3.0, 0.0, 3.0, -2.0, 0.0, 2.0, -100.0, 0.0, 100.0;
  cloud.typical_error = Eigen::Vector4d(0.1, 1.0, 0.1, 0.0);
  cloud.covariances = Eigen::VectorXd::LinSpaced(16, 0.0, 15.0).replicate(1, 3);
  cloud.windows = {0, 1, 2};
  return cloud;
}

TEST(Features, MostVariedAreMeasuredInTheirErrors) {
  const FeatureCloud cloud = four_features();
  EXPECT_EQ(most_varied(cloud, 2), (std::vector<std::string>{"a", "c"})) << "10 and 20 errors; b 3; of d it is unknown";
  EXPECT_EQ(most_varied(cloud, 3), (std::vector<std::string>{"a", "b", "c"}));
  EXPECT_EQ(most_varied(cloud, 9), cloud.names);
}

TEST(Features, FarOutliersDoNotMakeAFeatureVaried) {
  FeatureCloud cloud;
  cloud.names = {"with an outlier", "spread"};
  cloud.points = Eigen::MatrixXd::Zero(2, 100);
  cloud.points.row(1) = Eigen::RowVectorXd::LinSpaced(100, -1.0, 1.0);
  cloud.points(0, 50) = 1e6;
  cloud.typical_error = Eigen::Vector2d::Ones();
  EXPECT_EQ(most_varied(cloud, 1), std::vector<std::string>{"spread"});
}

TEST(Features, PartOfACloudKeepsItsErrors) {
  const FeatureCloud cloud = in_features(four_features(), {"d", "b"});
  EXPECT_EQ(cloud.names, (std::vector<std::string>{"d", "b"}));
  EXPECT_TRUE(near(cloud.points.col(2), Eigen::Vector2d(100.0, 3.0), 0.0));
  EXPECT_TRUE(near(cloud.typical_error, Eigen::Vector2d(0.0, 1.0), 0.0));
  EXPECT_TRUE(near(cloud.covariances.col(1), Eigen::Vector4d(15.0, 13.0, 7.0, 5.0), 0.0));
  EXPECT_THROW(in_features(four_features(), {"e"}), std::invalid_argument);
}

TEST(Features, AutomaticKeepsAllOfFewAndTwelveOfMany) {
  ClusterOptions options;
  options.over_switch = WindowsOverSwitch::keep;
  options.windows = WindowChoice::all;
  EXPECT_EQ(make_features(five_windows(), states, options).names.size(), 4u);
  WindowFits fits = five_windows();
  fits.structure = LinearStructure{1, 20, false};
  fits.parameters = Eigen::MatrixXd::Zero(21, 5);
  fits.parameters.row(7).setLinSpaced(-1.0, 1.0);
  fits.covariance = Eigen::MatrixXd::Identity(21, 21).reshaped(441, 1).replicate(1, 5);
  fits.rank.setConstant(21);
  fits.transitions = Eigen::VectorXi::Constant(5, 40);
  const FeatureCloud cloud = make_features(fits, states, options);
  EXPECT_EQ(cloud.names.size(), 12u);
  EXPECT_EQ(std::count(cloud.names.begin(), cloud.names.end(), "B7"), 1);
  EXPECT_EQ(std::count(cloud.names.begin(), cloud.names.end(), "log_noise_variance_wz"), 1);
  options.features = FeatureSet::parameters_and_noise;
  EXPECT_EQ(make_features(fits, states, options).names.size(), 22u);
}

TEST(Features, OneLagFitsStandInForModelsOfManyLagsAlone) {
  WindowFits fits;
  const auto automatic = [&] { return clusters_one_lag(fits, FeatureSet::automatic); };
  fits.structure = LinearStructure{1, 20, false};
  EXPECT_FALSE(automatic()) << "many inputs, no lags";
  EXPECT_FALSE(clusters_one_lag(fits, FeatureSet::one_lag));
  fits.structure = LinearStructure{1, 2, false, 3, 4};
  EXPECT_FALSE(automatic()) << "11 coefficients and a noise";
  EXPECT_TRUE(clusters_one_lag(fits, FeatureSet::one_lag));
  fits.structure = LinearStructure{1, 2, true, 3, 4};
  EXPECT_TRUE(automatic()) << "13 numbers";
  EXPECT_FALSE(clusters_one_lag(fits, FeatureSet::parameters_and_noise));
}

}  // namespace
}  // namespace modebank::test
