// Components made of windows that contain a switch.
#include "filter/learn/from_mixture/passing_windows.hpp"

#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include "tests/support/matrix_compare.hpp"

namespace modebank {
namespace {

using test::near;

/// Windows of 25 transitions, `step` apart, in runs with these labels. All windows have the same residual variance.
struct Labelled {
  WindowFits fits;
  MixtureResult mixture;

  Labelled(const std::vector<std::vector<int>>& runs, Index components, Index step) {
    fits.structure = {1, 1, false};
    fits.length = 25;
    fits.step = step;
    std::vector<int> labels;
    for (std::size_t r = 0; r < runs.size(); ++r)
      for (std::size_t i = 0; i < runs[r].size(); ++i) {
        fits.windows.push_back({static_cast<Index>(r), static_cast<Index>(i) * step});
        labels.push_back(runs[r][i]);
      }
    fits.resize(std::ssize(labels));
    fits.noise_variance.setConstant(1e-4);
    mixture.labels = Eigen::Map<const Eigen::VectorXi>(labels.data(), std::ssize(labels));
    mixture.mixture.weights = Eigen::VectorXd::Constant(components, 1.0 / static_cast<double>(components));
  }
};

std::vector<int> sequence(const std::vector<std::pair<int, int>>& stretches) {
  std::vector<int> labels;
  for (const auto& [label, count] : stretches) labels.insert(labels.end(), static_cast<std::size_t>(count), label);
  return labels;
}

// A window of 25 transitions contains a given switch for 24 starts.
TEST(PassingWindows, AComponentThatLastsNoLongerThanASwitchTakes) {
  const Labelled data({sequence({{0, 60}, {2, 24}, {1, 60}, {2, 24}, {0, 60}})}, 3, 1);
  EXPECT_TRUE(near(passing_shares(data.fits, data.mixture), Eigen::Vector3d(0.0, 0.0, 1.0), 0.0));
}

TEST(PassingWindows, WhatIsNotClusteredInBetweenCountsForItsLength) {
  const Labelled data({sequence({{0, 60}, {2, 8}, {-1, 8}, {2, 8}, {1, 60}})}, 3, 1);
  EXPECT_TRUE(near(passing_shares(data.fits, data.mixture), Eigen::Vector3d(0.0, 0.0, 1.0), 0.0));
}

TEST(PassingWindows, AModeThatLastsLongerOrFillsARunDoesNotPass) {
  const Labelled longer({sequence({{0, 60}, {1, 26}, {0, 60}})}, 2, 1);
  EXPECT_TRUE(near(passing_shares(longer.fits, longer.mixture), Eigen::Vector2d(0.0, 0.0), 0.0));
  const Labelled ends({sequence({{1, 10}, {0, 60}, {1, 10}}), sequence({{1, 10}})}, 2, 1);
  EXPECT_TRUE(near(passing_shares(ends.fits, ends.mixture), Eigen::Vector2d(0.0, 0.0), 0.0));
}

TEST(PassingWindows, StartsMayBeFartherApart) {
  // 24 starts contain at most five windows at step five
  const Labelled data({sequence({{0, 20}, {1, 5}, {0, 20}})}, 2, 5);
  EXPECT_TRUE(near(passing_shares(data.fits, data.mixture), Eigen::Vector2d(0.0, 1.0), 0.0));
}

}  // namespace
}  // namespace modebank
