#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "app/study/answers/study_table.hpp"

namespace modebank::app {

/// Finished trials with one value of a varied key, or with neighbouring values where a key has many numbers.
struct ValueGroup {
  std::string label;
  std::vector<std::size_t> rows;
};

/// Groups in the order of the plan. A key gets `value_range_count` ranges if it has more than `value_group_limit`
/// different numbers, or fewer than two settings per number while other keys vary (as in sampled plans). Ranges hold
/// about equally many trials, rise, and are labelled "lowest..highest". Trials to which the key does not apply have its
/// configured value.
inline constexpr std::size_t value_group_limit = 30, value_range_count = 5;
std::vector<ValueGroup> value_groups(const StudyTable& table, std::size_t key);

}  // namespace modebank::app
