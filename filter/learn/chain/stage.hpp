#pragma once

#include <cstddef>

#include "modebank/base/names.hpp"

namespace modebank {

/// The stages from data to scores, in order. Learning comprises structure to bank.
enum class Stage { data, structure, windows, mixture, competitors, bank, competitor_scores, bank_scores };
inline constexpr std::size_t stage_count = 8;

template <>
struct EnumNames<Stage> {
  static constexpr Names<stage_count> values{"data",        "structure", "windows",           "mixture",
                                             "competitors", "bank",      "competitor_scores", "bank_scores"};
};

constexpr std::size_t index_of(Stage stage) { return static_cast<std::size_t>(stage); }

}  // namespace modebank
