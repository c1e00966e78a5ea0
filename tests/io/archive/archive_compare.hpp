#pragma once

#include "tests/io/archive/archive_fixture.hpp"

namespace modebank::test {

/// Compares, field by field, the results of the stages that run before the bank is made.
void expect_same(const Recording& actual, const Recording& expected);
void expect_same(const LagReport& actual, const LagReport& expected);
void expect_same(const WindowFits& actual, const WindowFits& expected);
void expect_same(const ResidualTests& actual, const ResidualTests& expected);
void expect_same(const MixtureResult& actual, const MixtureResult& expected);

}  // namespace modebank::test
