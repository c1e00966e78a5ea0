// Keys and values that were removed since earlier versions. docs/results/gone.md lists what each of them gained.
#include "app/config/options/gone_keys.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "app/config/options/sections.hpp"

namespace modebank::app {
namespace {

struct Gone {
  std::string_view key;
  std::string_view value;  ///< empty if the whole key was removed
  std::string_view instead;
};

constexpr std::array gone{
    Gone{"bank.drift_rate", "", "bank.drift = auto chooses it"},
    Gone{"bank.drift_start", "", "bank.drift = auto chooses it"},
    Gone{"bank.drift_leak", "", "bank.drift = auto chooses it"},
    Gone{"bank.drift", "fixed", "auto chooses how fast"},
    Gone{"bank.members", "", "--track.filter combined predicts better than one bank"},
    Gone{"window.residual", "", "refinement learns the measurement noise, see help bank.measurement_variance"},
    Gone{"mixture.start_runs", "", "mixture.restarts sets the number of random starts"},
    Gone{"mixture.criterion", "aic", "bic"},
    Gone{"mixture.heldout", "", "mixture.criterion = heldout scores candidates of any number of windows"},
    Gone{"mixture.bootstrap", "", "banks state standard errors of their coefficients"},
    Gone{"study.sampling", "", "points of a Latin hypercube"},
    Gone{"study.retry", "", "runs that failed are tried again by the next study"},
    Gone{"study.cache_mb", "", "1000 MB"},
    Gone{"study.estimate", "", "a running study prints how long the rest takes, at its rate so far"},
    Gone{"study.page", "", "modebank report STUDY makes the page, also while the study runs"},
    Gone{"report.figures", "", "python3 -m modebank.figures ARCHIVE -o FOLDER"},
    Gone{"report.png", "", "python3 -m modebank.figures ARCHIVE -o FOLDER --png"},
    Gone{"report.run", "", "python3 -m modebank.figures ARCHIVE -o FOLDER --run NAME"},
    Gone{"report.sources", "", "copy modebank/figures.py and change the copy"},
    Gone{"filter.parameter_noise", "", "refinement learns what it added to Q"},
    Gone{"filter.time_steps", "", "a longer time between samples is as many prediction steps as fit"},
    Gone{"window.wheel_radius_m", "", "data.derive: vl = 0.165 * wl"},
    Gone{"window.loss_scale", "", "none: the scale of each loss is fixed (95 % efficiency under normal noise)"},
    Gone{"window.sigma", "", "window.scale = run"},
    Gone{"window.scale", "fixed", "run"},
    Gone{"window.prior_sd", "", "the numbers as window.prior"},
    Gone{"window.solver", "", "Ceres or the batch solver, by the number of windows"},
    Gone{"window.max_iterations", "", "100"},
    Gone{"mixture.start", "", "mixture.restarts sets the number of random starts"},
    Gone{"mixture.tolerance", "", "1e-7"},
    Gone{"mixture.max_iterations", "", "1000"},
    Gone{"mixture.covariance_floor", "", "1e-6 of the windows\' error variance"},
    Gone{"bank.screen", "", "bank.theta = mean keeps unstable modes"},
    Gone{"bank.restarts", "", "three for every ten of mixture.restarts"},
    Gone{"bank.look_ahead_score", "", "bank.look_ahead = 10 error"},
    Gone{"bank.folds", "", "six"},
    Gone{"bank.refine_transitions", "", "20,000 transitions teach at most"},
    Gone{"bank.max_iterations", "", "100"},
    Gone{"bank.tolerance", "", "1e-6 nats per transition"},
    Gone{"filter.paths", "", "400 sample paths"},
    Gone{"track.format", "", "JSON objects where lines in are, or with --json"},
    Gone{"track.level", "", "intervals hold 95 %"},
    Gone{"track.alarm", "", "one in 1000 samples of a true filter"},
    Gone{"filter.variant", "gpb1", "imm"},
    Gone{"filter.variant", "gpb2", "imm"},
    Gone{"float", "", "export --to c writes double"},
    Gone{"filter.variant", "mmae", "imm with bank.transition = stay and bank.stay = 1"},
};

}  // namespace

std::string instead_of_gone(const std::string& key, const std::string& value) {
  const auto* const found =
      std::find_if(gone.begin(), gone.end(), [&](const Gone& g) { return g.key == key && g.value == value; });
  if (found != gone.end()) return fmt::format(", which was removed; instead: {}", found->instead);
  constexpr std::string_view simulate = "simulate.";
  const bool of_a_system =
      value.empty() && key.starts_with(simulate) &&
      std::any_of(system_parameters().begin(), system_parameters().end(),
                  [&](const Option& option) { return option.name() == key.substr(simulate.size()); });
  return of_a_system ? fmt::format(", which was removed; set it in the system file, whose path is in simulate.system")
                     : "";
}

}  // namespace modebank::app
