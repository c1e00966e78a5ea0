// Mixture reduction: moments are preserved, the closest pair is merged first, and the windows' labels are updated.
#include <gtest/gtest.h>

#include <cmath>

#include "mixture/select.hpp"

namespace modebank {
namespace {

MixtureResult four_components() {
  MixtureResult result;
  result.mixture.weights = Eigen::Vector4d(0.4, 0.1, 0.3, 0.2);
  result.mixture.means.resize(2, 4);
  result.mixture.means << 0.0, 5.0, 0.3, -4.0, 0.0, 1.0, 0.1, 2.0;
  for (const double scale : {1.0, 0.5, 1.2, 2.0})
    result.mixture.covariances.push_back(scale * Eigen::Matrix2d{{1.0, 0.2}, {0.2, 0.7}});
  Eigen::MatrixXd responsibilities(4, 3);
  responsibilities << 0.7, 0.1, NAN, 0.1, 0.1, NAN, 0.1, 0.2, NAN, 0.1, 0.6, NAN;
  result.responsibilities = responsibilities;
  result.labels = Eigen::Vector3i(0, 3, -1);
  return result;
}

Eigen::Vector2d mean_of(const GaussianMixture& m) { return m.means * m.weights; }

Eigen::Matrix2d covariance_of(const GaussianMixture& m) {
  Eigen::Matrix2d sum = Eigen::Matrix2d::Zero();
  for (Eigen::Index k = 0; k < m.components(); ++k) {
    const Eigen::Vector2d d = m.means.col(k) - mean_of(m);
    sum += m.weights(k) * (m.covariances[k] + d * d.transpose());
  }
  return sum;
}

TEST(MergeComponents, KeepsTheMomentsOfTheMixture) {
  const MixtureResult before = four_components();
  for (const Eigen::Index most : {3, 2, 1}) {
    const MixtureResult after = merge_components(before, most);
    ASSERT_EQ(after.mixture.components(), most);
    EXPECT_NEAR(after.mixture.weights.sum(), 1.0, 1e-14);
    EXPECT_LT((mean_of(after.mixture) - mean_of(before.mixture)).norm(), 1e-13);
    EXPECT_LT((covariance_of(after.mixture) - covariance_of(before.mixture)).norm(), 1e-12);
    EXPECT_NEAR(after.responsibilities.all().col(0).sum(), 1.0, 1e-14);
  }
}

TEST(MergeComponents, TakesTheClosestPairFirstAndWindowsFollow) {
  const MixtureResult after = merge_components(four_components(), 3);  // components 0 and 2 overlap almost completely
  EXPECT_NEAR(after.mixture.weights(0), 0.7, 1e-14);
  const Eigen::MatrixXd responsibilities = after.responsibilities.all();
  EXPECT_NEAR(responsibilities(0, 0), 0.8, 1e-14);
  EXPECT_NEAR(responsibilities(2, 1), 0.6, 1e-14);
  EXPECT_TRUE(std::isnan(responsibilities(0, 2)));
  EXPECT_EQ(after.labels, Eigen::Vector3i(0, 2, -1));
}

TEST(MergeComponents, LeavesSmallerMixturesAlone) {
  EXPECT_EQ(merge_components(four_components(), 9).mixture.components(), 4);
  EXPECT_THROW(merge_components(four_components(), 0), std::invalid_argument);
}

}  // namespace
}  // namespace modebank
