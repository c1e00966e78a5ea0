#include "filter/learn/chain/progress.hpp"

#include <fmt/format.h>

namespace modebank {
namespace {

/// Formats a count with digits in groups of three.
std::string grouped(Eigen::Index count) {
  std::string digits = std::to_string(count);
  for (auto at = static_cast<std::ptrdiff_t>(digits.size()) - 3; at > 0; at -= 3)
    digits.insert(static_cast<std::size_t>(at), ",");
  return digits;
}

}  // namespace

std::string of_all(Eigen::Index part, Eigen::Index all) { return grouped(part) + " of " + grouped(all); }

std::string learned_words(Eigen::Index learned, Eigen::Index all) {
  return "from " + of_all(learned, all) + " training transitions";
}

std::string shrinking_words(const Shrinking& shrinking) {
  return fmt::format(
      "{} mode{} moved {:.1f} % of the way to the model of all runs. Otherwise predictions many samples ahead would "
      "grow without limit (their mean square by a factor of {:.4g} per sample)",
      shrinking.modes, shrinking.modes == 1 ? "" : "s", 100.0 * shrinking.share, shrinking.growth);
}

}  // namespace modebank
