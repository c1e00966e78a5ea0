#include "filter/judge/look_ahead.hpp"

#include <cmath>
#include <stdexcept>

#include "filter/judge/evaluate.hpp"
#include "filter/judge/forecast.hpp"
#include "filter/step/feed/run_samples.hpp"
#include "ident/base/not_a_number.hpp"

namespace modebank {
namespace {

using Eigen::Index;

/// Adds log densities 2 to h samples ahead of one origin after another, to a sum over horizons for every sample.
template <int N, int NY>
class FarDensities {
 public:
  FarDensities(const FilterModel<N, NY>& model, const RunInstants& instants, const Trajectory& run, Index h,
               Eigen::VectorXd& sums)
      : instants_(instants),
        run_(run),
        h_(h),
        weight_(static_cast<double>(look_ahead_stride(h))),
        sums_(sums),
        forecast_(model),
        error_(run.state.rows()) {}

  void from(Index t, const FilterState<N>& state) {
    forecast_.start(state);
    for (Index ahead = 0; ahead < h_ && instants_.continues(t);) {
      forecast_.step(instants_.inputs.col(++t));
      const Index k = instants_.instants[static_cast<std::size_t>(t)].sample;
      if (k < 0 || ++ahead == 1) continue;
      const auto y = run_.state.col(k);
      if (missing_entries(y) == 0) sums_(k) += weight_ * forecast_.observe(y, error_);
    }
  }

 private:
  const RunInstants& instants_;
  const Trajectory& run_;
  Index h_;
  double weight_;
  Eigen::VectorXd& sums_;
  BankForecast<N, NY> forecast_;
  Eigen::VectorXd error_;
};

template <int N, int NY>
Eigen::VectorXd sums_over_horizons(const Bank& bank, const Trajectory& run, const FilterOptions& options, Index h) {
  const FilterModel<N, NY> model(bank, options);
  const RunInstants instants(bank, run, options.time_steps);
  FilterStep<N, NY> step(model);
  FilterState<N> state = initial_state(model);
  Eigen::VectorXd sums = log_densities(bank, run, options);
  FarDensities<N, NY> far(model, instants, run, h, sums);
  for (Index t = 0; t < instants.count(); ++t) {
    step_to(model, instants, t, run, state, step);
    const Index k = instants.instants[static_cast<std::size_t>(t)].sample;
    if (k >= 0 && k % look_ahead_stride(h) == 0) far.from(t, state);
  }
  return sums;
}

}  // namespace

Eigen::VectorXd look_ahead_densities(const Bank& bank, const Trajectory& run, const FilterOptions& options, Index h) {
  if (h < 1) throw std::invalid_argument("learning looks at least one sample ahead");
  if (h == 1) return log_densities(bank, run, options);
  check_run(bank, run);
  Eigen::VectorXd sums;
  with_sizes(bank.structure.dimension(), bank.C.rows(),
             [&]<int N, int NY>() { sums = sums_over_horizons<N, NY>(bank, run, options, h); });
  return sums / static_cast<double>(h);
}

double look_ahead_likelihood(const Bank& bank, const Trajectory& run, const FilterOptions& options, Index h) {
  if (h == 1) return log_likelihood(bank, run, options);
  double total = 0.0;
  for (const double value : look_ahead_densities(bank, run, options, h)) total += std::isnan(value) ? 0.0 : value;
  return total;
}

}  // namespace modebank
