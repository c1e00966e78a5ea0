#include "filter/learn/chain/progress.hpp"

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

}  // namespace modebank
