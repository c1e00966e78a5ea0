#include <fmt/format.h>

#include "app/config/config.hpp"
#include "app/config/free_run_check.hpp"
#include "app/config/section.hpp"
#include "filter/learn/chain/stages.hpp"
#include "filter/learn/learn.hpp"
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
          fmt::format("window.prior has {} standard deviations: give one, or one per parameter ({}), or none", sds,
                      parameters));
}

/// bank.transition = logit has no meaning where no bank is refined, and none in filters that know a constant T alone.
void check_logit(const Config& config) {
  if (config.bank.transition != TransitionSource::logit) return;
  require(config.bank.refine != Refine::none && is_linear(config.window),
          "bank.transition = logit is learned by refinement: it needs bank.refine = auto or em, and window.model = "
          "linear or varx");
  require(config.filter.variant != FilterVariant::salvi2025,
          "bank.transition = logit needs another filter.variant than salvi2025, whose equations know a constant "
          "transition matrix alone");
}

/// Motion models and linear have no lags to find.
void check_searched(const Config& config) {
  const SearchedLags searched = searched_lags_of(config);
  if (!searched.any()) return;
  const StructureConfig& structure = config.structure;
  require(structure.automatic_model || config.window.model == "varx",
          fmt::format("window.state_lags, window.input_lags and window.input_delay = auto are those of model = varx or "
                      "auto, not of {}",
                      config.window.model));
  require(config.window.prior_sd.size() <= 1,
          "window.prior: where lags are found the number of parameters is not known beforehand; give one value for "
          "all, or none");
  const bool of_inputs = structure.input == LagChoice::automatic || structure.delay == LagChoice::automatic;
  require(!of_inputs || !config.data.input.empty(),
          "window.input_lags = auto and window.input_delay = auto need inputs: name them with data.input");
}

/// Modes that drift are learned by refinement, for states measured exactly and the one filter that knows them.
void check_drift(const Config& config) {
  if (config.bank.em.drift == Drift::none) return;
  const std::string drift = fmt::format("bank.drift = {}", name_of(config.bank.em.drift));
  require(is_linear(config.window),
          fmt::format("{} needs window.model = linear, varx or auto, not {}", drift, config.window.model));
  require(refinement_asked(config.bank, true) == Refine::em,
          drift + " is learned by refinement: it needs bank.refine = em, or auto with nothing that keeps it from em");
  require(!config.bank.measurement_variance,
          drift + " needs states measured exactly: leave bank.measurement_variance empty");
  require(config.data.quantum.empty() && !config.data.quantum_auto,
          drift + " needs states measured exactly: data.quantum = none");
  require(config.filter.variant == FilterVariant::imm,
          fmt::format("{} needs filter.variant = imm, not {}", drift, name_of(config.filter.variant)));
  const bool paths =
      config.scoring.free_run.method == FreeRunMethod::paths || config.bank.transition == TransitionSource::logit;
  require(config.scoring.free_run.samples == 0 || !paths,
          drift +
              " knows no free run by sample paths: it needs filter.simulate_method = moments and "
              "bank.transition = labels, or filter.simulate = 0");
}

}  // namespace

void validate(const Config& config) {
  const DataOptions& data = config.data;
  require(!data.inputs.empty(), "data.inputs is empty: it names the files to read, for example pro_*.csv");
  require(!data.state.empty(), "data.state is empty: it names the columns of the measured states");
  require(data.truth.empty() || data.truth.size() == data.state.size(),
          fmt::format("data.truth names {} columns, data.state {}: there must be as many, or none", data.truth.size(),
                      data.state.size()));
  const Index states = std::ssize(data.state), inputs = std::ssize(data.input);
  check_searched(config);
  const FitOptions window = window_options_of(config);
  in_section("window", [&] { check_model(window, states, inputs); });
  check_free_run(linear_structure(states, inputs, window), config.scoring.free_run);
  check_prior(window, parameter_count(window, states, inputs));
  require(
      !config.mixture.error_aware || config.window.covariance != CovarianceKind::sandwich,
      "mixture.error_aware = true needs window.covariance = model: a sandwich covariance does not say how much of a "
      "window's theta is the prior's, so that cannot be taken off");
  require(config.bank.refine != Refine::em || is_linear(config.window),
          fmt::format("bank.refine = em needs window.model = linear or varx, not {}: it fits linear modes",
                      config.window.model));
  check_logit(config);
  check_drift(config);
}

}  // namespace modebank::app
