#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace modebank {

/// Whether `a` stands before `b` in the order in which run_10 follows run_9.
bool natural_less(const std::string& a, const std::string& b);

/// The positions of names in that order.
std::vector<std::size_t> natural_order(const std::vector<std::string>& names);

}  // namespace modebank
