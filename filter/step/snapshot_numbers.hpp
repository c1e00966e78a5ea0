#pragma once

#include <vector>

#include "filter/step/bank_filter.hpp"

namespace modebank {

/// Converts a snapshot to a list of numbers that a program can store, and back. The result has the same bits.
std::vector<double> to_numbers(const FilterSnapshot& snapshot);

/// Throws std::invalid_argument if to_numbers cannot have produced these numbers. BankFilter::restore checks whether
/// they fit a filter.
FilterSnapshot snapshot_of(const std::vector<double>& numbers);

}  // namespace modebank
