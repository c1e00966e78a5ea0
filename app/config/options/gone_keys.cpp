// Keys and values of earlier versions. docs/results/gone.md has what each was worth.
#include "app/config/options/gone_keys.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

namespace modebank::app {
namespace {

struct Gone {
  std::string_view key;
  std::string_view value;  ///< empty: the key itself went
  std::string_view instead;
};

constexpr std::array gone{
    Gone{"bank.drift_rate", "", "bank.drift = auto chooses it"},
    Gone{"bank.drift_start", "", "bank.drift = auto chooses it"},
    Gone{"bank.drift_leak", "", "bank.drift = auto chooses it"},
    Gone{"bank.drift", "fixed", "auto chooses how fast"},
    Gone{"bank.members", "", "--track.filter combined predicts better than one bank"},
    Gone{"window.residual", "", "refinement learns the measurement noise, see help bank.measurement_variance"},
    Gone{"mixture.start", "kmeans++", "random"},
    Gone{"mixture.start_runs", "", "mixture.restarts sets the number of random starts"},
    Gone{"mixture.criterion", "aic", "bic"},
    Gone{"mixture.heldout", "", "mixture.criterion = heldout scores candidates of any number of windows"},
    Gone{"mixture.bootstrap", "", "banks state standard errors of their coefficients"},
    Gone{"report.figures", "", "python3 -m modebank.figures ARCHIVE -o FOLDER"},
    Gone{"report.png", "", "python3 -m modebank.figures ARCHIVE -o FOLDER --png"},
    Gone{"report.run", "", "python3 -m modebank.figures ARCHIVE -o FOLDER --run NAME"},
    Gone{"report.sources", "", "copy modebank/figures.py and change the copy"},
    Gone{"filter.parameter_noise", "", "refinement learns what it added to Q"},
    Gone{"filter.time_steps", "", "a longer time between samples is as many prediction steps as fit"},
    Gone{"filter.variant", "gpb1", "imm"},
    Gone{"filter.variant", "gpb2", "imm"},
    Gone{"filter.variant", "mmae", "imm with bank.transition = stay and bank.stay = 1"},
};

}  // namespace

std::string instead_of_gone(const std::string& key, const std::string& value) {
  const auto* const found =
      std::find_if(gone.begin(), gone.end(), [&](const Gone& g) { return g.key == key && g.value == value; });
  return found == gone.end() ? std::string() : fmt::format(", which went; instead: {}", found->instead);
}

}  // namespace modebank::app
