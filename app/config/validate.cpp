#include <fmt/format.h>

#include "app/config/config.hpp"
#include "app/config/faults.hpp"
#include "app/config/free_run_check.hpp"
#include "app/config/section.hpp"
#include "ident/fit/fit_windows.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app {
namespace {

void require(bool condition, const std::string& message) {
  if (!condition) throw ConfigurationError(message);
}

void check_prior(const FitOptions& window, Index parameters) {
  const Index sds = std::ssize(window.prior_sd);
  require(sds <= 1 || sds == parameters,
          fmt::format("window.prior has {} standard deviations; give one, one per parameter ({}), or none", sds,
                      parameters));
}

/// bank.transition = logit needs a refined bank and a filter that supports state-dependent transition probabilities.
void check_logit(const Config& config) {
  if (config.bank.transition != TransitionSource::logit) return;
  require(config.bank.refine != Refine::none && is_linear(config.window),
          "bank.transition = logit is learned by refinement: it needs bank.refine = auto or em, and window.model = "
          "linear or varx");
  require(config.filter.variant != FilterVariant::salvi2025,
          "bank.transition = logit does not work with filter.variant = salvi2025, whose transition matrix is constant; "
          "use filter.variant = imm");
}

/// Motion models and window.model = linear have no lags to search for.
void check_searched(const Config& config) {
  const SearchedLags searched = searched_lags_of(config);
  if (!searched.any()) return;
  const StructureConfig& structure = config.structure;
  require(
      structure.automatic_model || config.window.model == "varx",
      fmt::format(
          "window.state_lags, window.input_lags and window.input_delay = auto need window.model = varx or auto, not {}",
          config.window.model));
  require(config.window.prior_sd.size() <= 1,
          "window.prior: the number of parameters is unknown while lags are searched for; give one value for all "
          "parameters, or none");
  const bool of_inputs = structure.input == LagChoice::automatic || structure.delay == LagChoice::automatic;
  require(!of_inputs || !config.data.input.empty(),
          "window.input_lags = auto and window.input_delay = auto need inputs; name them in data.input");
}

}  // namespace

void validate(const Config& config) {
  const DataOptions& data = config.data;
  Faults faults;
  if (data.inputs.empty()) faults.add("data.inputs is empty: it names the files to read, for example pro_*.csv");
  if (data.state.empty()) faults.add("data.state is empty: it names the columns of the measured states");
  faults.refuse();
  require(data.truth.empty() || data.truth.size() == data.state.size(),
          fmt::format("data.truth names {} columns, data.state {}; name as many in data.truth, or none",
                      data.truth.size(), data.state.size()));
  const Index states = std::ssize(data.state), inputs = std::ssize(data.input);
  check_searched(config);
  const FitOptions window = window_options_of(config);
  in_section("window", [&] { check_model(window, states, inputs); });
  check_free_run(linear_structure(states, inputs, window), config.scoring.free_run);
  check_prior(window, parameter_count(window, states, inputs));
  require(!config.mixture.error_aware || config.window.covariance != CovarianceKind::sandwich,
          "mixture.error_aware = true needs window.covariance = model: a sandwich covariance does not separate the "
          "prior's share of a window's parameters");
  require(config.bank.refine != Refine::em || is_linear(config.window),
          fmt::format("bank.refine = em needs window.model = linear or varx, not {}: it fits linear modes",
                      config.window.model));
  require(config.bank.refine != Refine::em || !config.bank.process_variance,
          "bank.process_variance does not work with bank.refine = em, which learns Q; give one of them");
  check_logit(config);
}

}  // namespace modebank::app
