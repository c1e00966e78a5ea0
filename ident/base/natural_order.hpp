#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace modebank {

/// Whether `a` comes before `b` in natural order, in which run_10 follows run_9.
bool natural_less(const std::string& a, const std::string& b);

/// The positions of the names when sorted in natural order.
std::vector<std::size_t> natural_order(const std::vector<std::string>& names);

}  // namespace modebank
