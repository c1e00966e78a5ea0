#include "filter/learn/chain/parts.hpp"

namespace modebank {

std::optional<Bank> Learning::bank_of(const std::string& filter) const {
  if (filter == "bank") return bank;
  if (filter == "baseline") return baseline;
  if (filter == "noise_only") return noise_only;
  if (filter == "one_motion") return one_motion;
  if (filter == "nonlinear") return nonlinear;
  if (filter == "drifting") return drifting;
  if (filter == combined_name && bank) return combined_frame(*bank);
  return {};
}

}  // namespace modebank
