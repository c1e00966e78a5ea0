#include "filter/diagnostics_flags.hpp"

namespace modebank {

namespace {

constexpr double takes_all = 0.99;         // usage of one mode
constexpr double unused = 1e-3;            // usage
constexpr double flat_entropy = 0.95;      // of log K
constexpr double dominating_spread = 0.5;  // share of trace S
constexpr double coloured = 0.01;          // whiteness p

void add_flag(std::string& flags, const std::string& flag) { flags += (flags.empty() ? "" : "; ") + flag; }

/// "mode 3 unused", "modes 1, 3 unused"; empty without any.
std::string unused_modes(const std::vector<DiagnosticsRow>& modes) {
  std::string list;
  int count = 0;
  for (const DiagnosticsRow& mode : modes)
    if (mode.usage < unused) list += (count++ > 0 ? ", " : " ") + std::to_string(mode.mode);
  return count == 0 ? "" : (count > 1 ? "modes" : "mode") + list + " unused";
}

}  // namespace

std::string flags_of(const DiagnosticsRow& all, const std::vector<DiagnosticsRow>& modes, Eigen::Index nees_states) {
  std::string flags;
  for (const DiagnosticsRow& mode : modes)
    if (mode.usage > takes_all) add_flag(flags, "one mode takes all (" + std::to_string(mode.mode) + ")");
  if (const std::string list = unused_modes(modes); !list.empty()) add_flag(flags, list);
  if (!modes.empty() && all.entropy > flat_entropy) add_flag(flags, "probabilities flat");
  if (all.spread_share > dominating_spread) add_flag(flags, "spread dominates S");
  if (all.tail_above_lower > largest_tail && all.tail_below_lower > largest_tail) add_flag(flags, "heavy tails");
  if (all.nis_mean > all.nis_upper) add_flag(flags, "mean NIS above a true filter's");
  if (all.nis_mean < all.nis_lower) add_flag(flags, "mean NIS below a true filter's");
  if (all.nees_mean > all.nees_upper)
    add_flag(flags, "NEES above a true filter's: the state's covariance is too small");
  if (all.nees_mean < all.nees_lower)
    add_flag(flags, "NEES below a true filter's: the state's covariance is too large");
  if (all.whiteness_p < coloured) add_flag(flags, "innovations not white");
  if (all.verdict == Verdict::undecided) add_flag(flags, "too few samples for a verdict");
  if (nees_states < all.state_rmse.size() && all.state_rmse.allFinite())
    add_flag(flags, nees_states == 0 ? "R is as good as zero, so the state is the measurement: no NEES"
                                     : "R of some states is as good as zero, so they are the measurement: NEES of the "
                                       "others alone");
  return flags;
}

}  // namespace modebank
