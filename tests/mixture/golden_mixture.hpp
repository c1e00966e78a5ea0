#pragma once

#include <gtest/gtest.h>

#include <vector>

#include "tests/support/golden.hpp"
#include "tests/support/matrix_compare.hpp"

namespace modebank::test {

/// Allows sums of about a thousand terms in another order. The tests compare algorithms, not rounding.
constexpr double mixture_tolerance = 1e-8;

/// Compares a fit with one of a golden file. `unit`: sizes of the features, which differ by a factor of 500; empty:
/// the first component's standard deviations.
inline void expect_golden_fit(const nlohmann::json& golden, double log_likelihood, const Eigen::VectorXd& weights,
                              const Eigen::MatrixXd& means, const std::vector<Eigen::MatrixXd>& covariances,
                              Eigen::ArrayXd unit) {
  if (unit.size() == 0) unit = golden_rows(golden["covariances"][0]).diagonal().array().sqrt();
  EXPECT_NEAR(log_likelihood, golden["log_likelihood"].get<double>(), mixture_tolerance);
  EXPECT_TRUE(near(weights, golden_rows(golden["weights"]), mixture_tolerance));
  EXPECT_TRUE(near(means.array().colwise() / unit, golden_columns(golden["means"]).array().colwise() / unit,
                   mixture_tolerance));
  ASSERT_EQ(covariances.size(), golden["covariances"].size());
  for (std::size_t k = 0; k < covariances.size(); ++k) {
    const Eigen::ArrayXXd difference = (covariances[k] - golden_rows(golden["covariances"][k])).array();
    EXPECT_TRUE(near((difference.colwise() / unit).rowwise() / unit.transpose(),
                     Eigen::MatrixXd::Zero(unit.size(), unit.size()), mixture_tolerance))
        << "component " << k;
  }
}

/// The two golden files of fits, with the features' units.
inline const std::vector<std::pair<const char*, Eigen::ArrayXd>> golden_mixtures{
    {"mixture", {}}, {"extreme_deconvolution", Eigen::Array3d(0.02, 1.0, 10.0)}};

}  // namespace modebank::test
