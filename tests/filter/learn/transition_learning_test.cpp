#include "filter/learn/from_mixture/transition_learning.hpp"

#include <gtest/gtest.h>

#include "tests/support/matrix_compare.hpp"

namespace modebank {
namespace {

using test::near;

/// Rounding error of a few divisions.
constexpr double row_rounding = 1e-14;

WindowFits windows(std::initializer_list<Window> list, Index step) {
  WindowFits fits;
  fits.step = step;
  fits.windows = list;
  return fits;
}

TEST(LabelTransitions, CountsNeighboursWithinRuns) {
  const WindowFits fits = windows({{0, 0}, {0, 2}, {0, 4}, {0, 8}, {1, 0}, {1, 2}, {1, 4}, {1, 6}}, 2);
  Eigen::VectorXi labels(8);
  labels << 0, 0, 1, 1, 1, -1, 1, 0;
  // Counts: 0->0 and 0->1. Windows 4 and 8 have a gap between them. Then a new run begins. The window without a mode
  // counts as the previous mode: 1->1 twice; 1->0.
  Eigen::MatrixXd expected(2, 2);
  expected << 1, 1, 1, 2;
  EXPECT_TRUE(near(count_label_transitions(fits, labels, {0, 1}), expected, 0.0));
}

TEST(LabelTransitions, AScreenedModeCountsAsTheModeBefore) {
  const WindowFits fits = windows({{0, 0}, {0, 1}, {0, 2}, {0, 3}, {0, 4}}, 1);
  Eigen::VectorXi labels(5);
  labels << 0, 1, 2, 2, 0;
  Eigen::MatrixXd expected(2, 2);  // components 0 and 2 are kept
  expected << 1, 1, 1, 1;
  EXPECT_TRUE(near(count_label_transitions(fits, labels, {0, 2}), expected, 0.0));
}

TEST(TransitionFromCounts, SmoothsByATenth) {
  Eigen::MatrixXd counts(2, 2);
  counts << 9, 1, 0, 0;
  Eigen::MatrixXd expected(2, 2);
  expected << 9.1 / 10.2, 1.1 / 10.2, 0.5, 0.5;
  EXPECT_TRUE(near(transition_from_counts(counts, 1).matrix(), expected, row_rounding));
}

TEST(TransitionFromCounts, LongerStepsTakeTheRootOfTheDiagonal) {
  Eigen::MatrixXd counts(3, 3);
  counts << 7.9, 0.9, 0.9, 0.4, 3.9, 1.4, 0, 0, 0;
  const double stay0 = std::cbrt(0.8), stay1 = std::cbrt(4.0 / 6.0), stay2 = std::cbrt(1.0 / 3.0);
  Eigen::MatrixXd expected(3, 3);
  expected << stay0, (1 - stay0) / 2, (1 - stay0) / 2,  //
      (1 - stay1) / 4, stay1, (1 - stay1) * 3 / 4,      //
      (1 - stay2) / 2, (1 - stay2) / 2, stay2;
  EXPECT_TRUE(near(transition_from_counts(counts, 3).matrix(), expected, row_rounding));
}

TEST(TransitionFromCounts, OneModeStays) {
  EXPECT_TRUE(
      near(transition_from_counts(Eigen::MatrixXd::Constant(1, 1, 5.0), 4).matrix(), Eigen::MatrixXd::Ones(1, 1), 0.0));
}

}  // namespace
}  // namespace modebank
