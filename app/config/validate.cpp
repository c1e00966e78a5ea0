#include <fmt/format.h>

#include "app/chain/section.hpp"
#include "app/chain/stages.hpp"
#include "app/config/config.hpp"
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
          fmt::format("window.prior_sd has {} values: give one, or one per parameter ({}), or none", sds, parameters));
}

/// bank.transition = logit has no meaning where no bank is refined, and none in filters that know a constant T alone.
void check_logit(const Config& config) {
  if (config.bank.transition != TransitionSource::logit) return;
  require(config.bank.refine != Refine::none && is_linear(config.window),
          "bank.transition = logit is learned by refinement: it needs bank.refine = auto or em, and window.model = "
          "linear or varx");
  require(config.bank.em.members == 1,
          fmt::format("bank.transition = logit needs bank.members = 1, not {}: fits that switch by state and input are "
                      "not averaged",
                      config.bank.em.members));
  require(config.filter.variant != FilterVariant::salvi2025,
          "bank.transition = logit needs another filter.variant than salvi2025, whose equations know a constant "
          "transition matrix alone");
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
  in_section("window", [&] { check_model(config.window, states, inputs); });
  check_free_run(linear_structure(states, inputs, config.window), config.scoring.free_run);
  check_prior(config.window, parameter_count(config.window, states, inputs));
  require(config.window.scale != ScaleSource::fixed || config.window.sigma > 0.0,
          "window.scale = fixed needs window.sigma, the residual standard deviation, above 0");
  require(
      !config.mixture.error_aware || config.window.covariance != CovarianceKind::sandwich,
      "mixture.error_aware = true needs window.covariance = model: a sandwich covariance does not say how much of a "
      "window's theta is the prior's, so that cannot be taken off");
  require(config.bank.refine != Refine::em || is_linear(config.window),
          fmt::format("bank.refine = em needs window.model = linear or varx, not {}: it fits linear modes",
                      config.window.model));
  check_logit(config);
}

}  // namespace modebank::app
