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

/// Groups in the order of the plan; of a key with more than `value_group_limit` different numbers, or with fewer than
/// two settings to a number while other keys vary (as sampled plans have), `value_range_count` ranges of about equally
/// many trials, in rising order, labelled "lowest..highest". Trials to which the key does not apply have its configured
/// value.
inline constexpr std::size_t value_group_limit = 30, value_range_count = 5;
std::vector<ValueGroup> value_groups(const StudyTable& table, std::size_t key);

}  // namespace modebank::app
