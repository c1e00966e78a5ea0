#pragma once

#include <gtest/gtest.h>

#include "io/archive/archive.hpp"

namespace modebank::test {

/// An Archive with every field filled: three runs, K = 3 modes, M = 9 windows. Entry i of sample (window, mode) s of an
/// array is base + 100 s + i + 1/3, as in tests/golden/generate/check_archive.py. A third has no finite binary
/// expansion, so a lost bit shows.
Archive full_archive(Index states, Index inputs);

/// Adds evaluations, with every field filled, for the archive's runs and bank.
void add_evaluation(Archive& archive);

/// rows x cols of base + 100 col + row + 1/3.
Eigen::MatrixXd pattern(Index rows, Index cols, double base);

/// The same over 10^4, for values in 0 .. 1.
Eigen::MatrixXd share_pattern(Index rows, Index cols, double base);
/// The same, but the last row makes each column sum to 1.
Eigen::MatrixXd probability_pattern(Index rows, Index cols, double base);
/// side^2 x count: pattern, but each column is a symmetric matrix with mirrored lower half.
Eigen::MatrixXd spread_pattern(Index side, Index count, double base);

/// Expects all fields of both archives to have the same bits (NaN included).
void expect_same(const Archive& actual, const Archive& expected);
void expect_same(const Bank& actual, const Bank& expected);
::testing::AssertionResult same_bits(const Eigen::MatrixXd& actual, const Eigen::MatrixXd& expected);
void expect_same(const RunEvaluation& actual, const RunEvaluation& expected);

}  // namespace modebank::test
