#pragma once

#include <gtest/gtest.h>

#include "io/archive/archive.hpp"

namespace modebank::test {

/// An Archive in which every field is filled: three runs, K = 3 modes, M = 9 windows. Entry i of sample (or window or
/// mode) s of an array is base + 100 s + i + 1/3, as in tests/golden/generate/check_archive.py. A third has no finite
/// binary expansion, so a lost bit is detected.
Archive full_archive(Index states, Index inputs);

/// Adds evaluations for the archive's runs and bank. Every field is filled.
void add_evaluation(Archive& archive);

/// A rows x cols matrix of base + 100 col + row + 1/3.
Eigen::MatrixXd pattern(Index rows, Index cols, double base);

/// The same matrix divided by 10^4, for values between 0 and 1.
Eigen::MatrixXd share_pattern(Index rows, Index cols, double base);
/// The same values between 0 and 1, but the last row makes each column sum to 1.
Eigen::MatrixXd probability_pattern(Index rows, Index cols, double base);
/// A side^2 x count matrix with the entries of `pattern`, but each column is a symmetric matrix. Its lower half mirrors
/// the upper half.
Eigen::MatrixXd spread_pattern(Index side, Index count, double base);

/// Expects that all fields of both archives have the same bits, including NaN.
void expect_same(const Archive& actual, const Archive& expected);
::testing::AssertionResult same_bits(const Eigen::MatrixXd& actual, const Eigen::MatrixXd& expected);
void expect_same(const RunEvaluation& actual, const RunEvaluation& expected);

}  // namespace modebank::test
