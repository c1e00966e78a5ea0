#include "mixture/straddling.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "mixture/features.hpp"

namespace modebank {
namespace {

/// Windows of 25 transitions of one run; residual variance 1e-4, and `ratio` times that in windows 40..60.
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
TEST(Straddling, LouderThanBothDisjointNeighbours) {
  const std::vector<bool> flags = straddling_windows(fits_with_a_loud_stretch(2.8));
  for (std::size_t i = 0; i < flags.size(); ++i) EXPECT_EQ(flags[i], i >= 40 && i <= 60) << i;
}

TEST(Straddling, NotBelowTheQuantile) {
  const std::vector<bool> flags = straddling_windows(fits_with_a_loud_stretch(2.77));
  EXPECT_EQ(std::count(flags.begin(), flags.end(), true), 0);
}

TEST(Straddling, AModeThatLastsIsNotStraddling) {
  // At step 5 the loud stretch lasts 100 transitions: every window in it has a neighbour as loud as itself.
  const std::vector<bool> flags = straddling_windows(fits_with_a_loud_stretch(100.0, 5));
  EXPECT_EQ(std::count(flags.begin(), flags.end(), true), 0);
}

TEST(Straddling, NeighboursAreOfTheSameRun) {
  WindowFits fits = fits_with_a_loud_stretch(100.0);
  for (std::size_t i = 50; i < 100; ++i) fits.windows[i].run = 1;
  const std::vector<bool> flags = straddling_windows(fits);
  EXPECT_EQ(std::count(flags.begin(), flags.end(), true), 0);
}

TEST(Straddling, WindowsAreLeftOutOfTheCloudOnlyOnRequest) {
  const WindowFits fits = fits_with_a_loud_stretch(10.0);
  const std::vector<Channel> states{{"wz", "rad/s"}};
  EXPECT_EQ(make_features(fits, FeatureSet::parameters, WindowChoice::all, states).windows.size(), 100u);
  EXPECT_EQ(make_features(fits, FeatureSet::parameters, WindowChoice::all, states, StraddlingWindows::leave_out)
                .windows.size(),
            79u);
}

/// One run of windows of 25 transitions at step 1 with these labels, so many of each in a row.
struct LabelledRun {
  WindowFits fits;
  Eigen::VectorXi labels;

  explicit LabelledRun(const std::vector<std::pair<int, int>>& rows) {
    fits.length = 25;
    std::vector<int> all;
    for (const auto& [label, count] : rows) all.insert(all.end(), static_cast<std::size_t>(count), label);
    labels = Eigen::Map<const Eigen::VectorXi>(all.data(), static_cast<Index>(all.size()));
    for (Index i = 0; i < labels.size(); ++i) fits.windows.push_back({0, i});
  }
  /// First and last flagged window and how many there are.
  std::array<Index, 3> flagged() const {
    const std::vector<bool> flags = windows_at_switches(fits, labels);
    std::array<Index, 3> result{-1, -1, 0};
    for (Index i = 0; i < labels.size(); ++i) {
      if (!flags[static_cast<std::size_t>(i)]) continue;
      if (result[0] < 0) result[0] = i;
      result[1] = i;
      ++result[2];
    }
    return result;
  }
};

TEST(WindowsAtSwitches, AWindowsLengthAndAHalfAboutTheChange) {
  // A switch at transition 112: windows 88 to 111 hold both modes, and change label in the middle, at 99.5.
  using Range = std::array<Index, 3>;
  EXPECT_EQ(LabelledRun({{0, 100}, {1, 100}}).flagged(), (Range{81, 118, 38}));
  // The same with a label of their own.
  EXPECT_EQ(LabelledRun({{0, 94}, {2, 12}, {1, 94}}).flagged(), (Range{81, 118, 38}));
}

TEST(WindowsAtSwitches, LabelsThatDoNotChangeOrFlickerAreNoSwitches) {
  EXPECT_EQ(LabelledRun({{0, 200}}).flagged()[2], 0);
  EXPECT_EQ(LabelledRun({{0, 100}, {1, 5}, {0, 100}}).flagged()[2], 0);
  // Half a window and more is a visit.
  EXPECT_EQ(LabelledRun({{0, 100}, {1, 20}, {0, 100}}).flagged()[0], 91);
}

TEST(WindowsAtSwitches, InTransitAtTheEndsOfARun) {
  EXPECT_EQ(LabelledRun({{2, 10}, {0, 190}}).flagged(), (std::array<Index, 3>{0, 28, 29}));
  EXPECT_EQ(LabelledRun({{0, 190}, {2, 10}}).flagged(), (std::array<Index, 3>{171, 199, 29}));
}

TEST(WindowsAtSwitches, LabelsThatNeverLastSayNothing) {
  std::vector<std::pair<int, int>> rows{{0, 30}};
  for (int i = 0; i < 8; ++i) rows.emplace_back(1 + i % 2, 15);
  rows.emplace_back(0, 30);
  EXPECT_EQ(LabelledRun(rows).flagged()[2], 0);
}

TEST(WindowsAtSwitches, RunsAreApart) {
  LabelledRun two({{0, 100}, {1, 100}});
  for (std::size_t i = 100; i < 200; ++i) two.fits.windows[i] = {1, static_cast<Index>(i) - 100};
  EXPECT_EQ(two.flagged()[2], 0);
}

}  // namespace
}  // namespace modebank
