#pragma once

#include <vector>

#include "filter/step/bank_filter.hpp"

namespace modebank {

/// A snapshot as a row of numbers, which a program can keep or write without a look inside. The same bits come back.
std::vector<double> to_numbers(const FilterSnapshot& snapshot);

/// Throws std::invalid_argument for numbers that to_numbers cannot have made; whether they fit a filter is found by
/// BankFilter::restore.
FilterSnapshot snapshot_of(const std::vector<double>& numbers);

}  // namespace modebank
