#include "filter/judge/run/look_ahead.hpp"

#include <cmath>
#include <stdexcept>

#include "filter/judge/run/evaluate.hpp"
#include "filter/step/feed/run_samples.hpp"
#include "filter/step/forecast.hpp"
#include "ident/base/not_a_number.hpp"

namespace modebank {
namespace {

using Eigen::Index;

/// Sums the scores of predictions over the horizons, for every sample. Processes one origin after the other.
template <int N, int NY>
class FarScores {
 public:
  FarScores(const FilterModel<N, NY>& model, const RunInstants& instants, const Trajectory& run, const LookAhead& look,
            Eigen::VectorXd& sums)
      : instants_(instants),
        run_(run),
        look_(look),
        weight_(static_cast<double>(look_ahead_stride(look.samples))),
        sums_(sums),
        forecast_(model),
        error_(run.state.rows()) {}

  void from(Index t, const FilterState<N>& state) {
    forecast_.start(state);
    look_ahead(forecast_, instants_, t, [&](Index ahead, Index k) {
      // One sample ahead, the filter itself has already computed the density of every sample.
      if (ahead > 1 || look_.counts_errors()) count(k);
      return ahead < look_.samples;
    });
  }

 private:
  const RunInstants& instants_;
  const Trajectory& run_;
  const LookAhead& look_;
  double weight_;
  Eigen::VectorXd& sums_;
  BankForecast<N, NY> forecast_;
  Eigen::VectorXd error_;

  void count(Index k) {
    const auto y = run_.state.col(k);
    if (missing_entries(y) > 0) return;
    const double density = forecast_.observe(y, error_);
    sums_(k) +=
        weight_ * (look_.counts_errors() ? -0.5 * error_.cwiseQuotient(look_.error_unit).squaredNorm() : density);
  }
};

template <int N, int NY>
Eigen::VectorXd sums_over_horizons(const Bank& bank, const Trajectory& run, const FilterOptions& options,
                                   const LookAhead& look) {
  const FilterModel<N, NY> model(bank, options);
  const RunInstants instants(bank, run);
  FilterStep<N, NY> step(model);
  FilterState<N> state = initial_state(model);
  Eigen::VectorXd sums =
      look.counts_errors() ? Eigen::VectorXd::Zero(run.samples()) : log_densities(bank, run, options);
  FarScores<N, NY> far(model, instants, run, look, sums);
  Index first = 0;
  for (Index t = 0; t < instants.count(); ++t) {
    step_to(model, instants, t, run, state, step);
    const auto& [k, starts, start] = instants.instants[static_cast<std::size_t>(t)];
    if (starts) first = k;
    if (k >= 0 && (k - first) % look_ahead_stride(look.samples) == 0) far.from(t, state);
  }
  return sums;
}

}  // namespace

Eigen::VectorXd look_ahead_scores(const Bank& bank, const Trajectory& run, const FilterOptions& options,
                                  const LookAhead& look) {
  if (look.samples < 1) throw std::invalid_argument("look-ahead learning needs a horizon of at least one sample");
  if (look.is_likelihood()) return log_densities(bank, run, options);
  check_run(bank, run);
  Eigen::VectorXd sums;
  with_sizes(bank.structure.dimension(), bank.C.rows(),
             [&]<int N, int NY>() { sums = sums_over_horizons<N, NY>(bank, run, options, look); });
  return sums / static_cast<double>(look.samples);
}

double look_ahead_score(const Bank& bank, const Trajectory& run, const FilterOptions& options, const LookAhead& look) {
  if (look.is_likelihood()) return log_likelihood(bank, run, options);
  double total = 0.0;
  for (const double value : look_ahead_scores(bank, run, options, look)) total += std::isnan(value) ? 0.0 : value;
  return total;
}

}  // namespace modebank
