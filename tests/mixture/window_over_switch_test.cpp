#include "mixture/window_over_switch.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "mixture/features.hpp"

namespace modebank {
namespace {

/// Windows of 25 transitions of one run. The residual variance is 1e-4. In windows 40..60 it is `ratio` times as large.
WindowFits fits_with_a_loud_stretch(double ratio, Index step = 1) {
  WindowFits fits;
  fits.structure = {1, 2, false};
  fits.length = 25;
  fits.step = step;
  for (Index i = 0; i < 100; ++i) fits.windows.push_back({0, i * step});
  fits.resize(100);
  fits.parameters.setZero();
  fits.noise_variance.setConstant(1e-4);
  fits.noise_variance.middleCols(40, 21).setConstant(ratio * 1e-4);
  fits.rank.setConstant(3);
  fits.status.setConstant(static_cast<int>(FitStatus::converged));
  return fits;
}

// The 99 % quantile of F(22, 22) is 2.785 (scipy: f.ppf(0.99, 22, 22)).
TEST(WindowOverSwitch, LouderThanBothDisjointNeighbours) {
  const std::vector<bool> flags = windows_over_switch(fits_with_a_loud_stretch(2.8));
  for (std::size_t i = 0; i < flags.size(); ++i) EXPECT_EQ(flags[i], i >= 40 && i <= 60) << i;
}

TEST(WindowOverSwitch, NotBelowTheQuantile) {
  const std::vector<bool> flags = windows_over_switch(fits_with_a_loud_stretch(2.77));
  EXPECT_EQ(std::count(flags.begin(), flags.end(), true), 0);
}

TEST(WindowOverSwitch, AModeThatLastsHasNone) {
  // With step 5, the windows with the larger variance cover 100 transitions. So each of these windows has a neighbour
  // with the same variance.
  const std::vector<bool> flags = windows_over_switch(fits_with_a_loud_stretch(100.0, 5));
  EXPECT_EQ(std::count(flags.begin(), flags.end(), true), 0);
}

TEST(WindowOverSwitch, NeighboursAreOfTheSameRun) {
  WindowFits fits = fits_with_a_loud_stretch(100.0);
  for (std::size_t i = 50; i < 100; ++i) fits.windows[i].run = 1;
  const std::vector<bool> flags = windows_over_switch(fits);
  EXPECT_EQ(std::count(flags.begin(), flags.end(), true), 0);
}

TEST(WindowOverSwitch, WindowsAreLeftOutOfTheCloudOnlyOnRequest) {
  const WindowFits fits = fits_with_a_loud_stretch(10.0);
  const std::vector<Channel> states{{"wz", "rad/s"}};
  EXPECT_EQ(make_features(fits, FeatureSet::parameters, WindowChoice::all, states).windows.size(), 100u);
  EXPECT_EQ(make_features(fits, FeatureSet::parameters, WindowChoice::all, states, WindowsOverSwitch::leave_out)
                .windows.size(),
            79u);
}

}  // namespace
}  // namespace modebank
