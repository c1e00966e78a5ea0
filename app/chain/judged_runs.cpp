#include "app/chain/judged_runs.hpp"

#include <fmt/format.h>

namespace modebank {

const SummaryRow* pooled_row(const Archive& archive, const std::string& filter, Role role) {
  return modebank::pooled_row(archive.summary, filter, role);
}

const DiagnosticsRow* diagnosis(const Archive& archive, const std::string& filter, Role role, Eigen::Index mode) {
  for (const DiagnosticsRow& row : archive.diagnostics)
    if (row.filter == filter && row.role == role && row.mode == mode) return &row;
  return nullptr;
}

Role judged_role(const Archive& archive) { return modebank::judged_role(archive.summary); }

std::vector<std::size_t> positions_of(const Recording& recording, Role role) {
  std::vector<std::size_t> positions;
  for (std::size_t i = 0; i < recording.runs.size(); ++i)
    if (recording.runs[i].role == role) positions.push_back(i);
  return positions;
}

const char* words_for(Role role) { return role == Role::test ? "held-out" : "training"; }

namespace {

/// In groups of three digits.
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
      "{} mode{} drawn {:.1f} % of the way to the model of all runs: predictions many samples ahead would have grown "
      "without limit (their mean square {:.4g} times a sample)",
      shrinking.modes, shrinking.modes == 1 ? "" : "s", 100.0 * shrinking.share, shrinking.growth);
}

}  // namespace modebank
