#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "app/study/answers/study_table.hpp"

namespace modebank::app {

/// Finished trials with one value of a varied key. For a key with many numbers, the trials with a range of values.
struct ValueGroup {
  std::string label;
  std::vector<std::size_t> rows;
};

/// Groups in the order of the plan. A key gets `value_range_count` ranges if it has more than `value_group_limit`
/// different numbers. It also gets ranges if it has fewer than two settings per number while other keys vary, as in
/// sampled plans.
/// The ranges increase, contain about equal numbers of trials, and have labels "lowest..highest". If a key does not
/// apply to a trial, the trial has the configured value of this key.
inline constexpr std::size_t value_group_limit = 30, value_range_count = 5;
std::vector<ValueGroup> value_groups(const StudyTable& table, std::size_t key);

}  // namespace modebank::app
