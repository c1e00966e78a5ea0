#pragma once

#include <vector>

#include "filter/step/bank_filter.hpp"

namespace modebank {

/// A snapshot as a list of numbers that a program can store. The conversion back gives the same bits.
std::vector<double> to_numbers(const FilterSnapshot& snapshot);

/// Throws std::invalid_argument for numbers that to_numbers cannot have produced. BankFilter::restore checks whether
/// they fit a filter.
FilterSnapshot snapshot_of(const std::vector<double>& numbers);

}  // namespace modebank
