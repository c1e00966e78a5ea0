#include "ident/check/advice.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "ident/check/run_check.hpp"
#include "ident/fit/robust_regression.hpp"
#include "ident/model/transitions.hpp"

namespace modebank {

namespace {

/// Rounds to four digits. The ratio of two rounded rates is then within a thousandth of a whole number.
double rounded(double value) {
  const double per_unit = std::pow(10.0, 3.0 - std::floor(std::log10(value)));
  return std::round(value * per_unit) / per_unit;  // this quotient prints as 0.4588; the product 4588 * 0.0001 does not
}

/// The rate nearest to `wanted_hz` among rate_hz / 2, rate_hz / 3, ...
double slower(double rate_hz, double wanted_hz) {
  return rounded(rate_hz / std::max(2.0, std::round(rate_hz / wanted_hz)));
}
double faster(double rate_hz, double wanted_hz, double most_hz) {
  const double times = std::min(std::round(wanted_hz / rate_hz), std::floor(most_hz / rate_hz));
  return rounded(rate_hz * std::max(2.0, times));
}

}  // namespace

TailCheck check_tails(const Recording& recording, const LinearStructure& structure) {
  TailCheck tails;
  const Transitions transitions = stack_training(recording, structure);
  if (transitions.count() <= structure.regressors()) return tails;
  const RobustRegression fit = huber_regression(transitions);
  const Eigen::MatrixXd error = transitions.increments - transitions.regressors * fit.coefficients;
  double four = 0.0, eight = 0.0;
  for (Index i = 0; i < error.cols(); ++i) {
    if (!(fit.scale(i) > 0.0)) continue;
    four += static_cast<double>((error.col(i).array().abs() > 4.0 * fit.scale(i)).count());
    eight += static_cast<double>((error.col(i).array().abs() > 8.0 * fit.scale(i)).count());
  }
  const auto values = static_cast<double>(error.size());
  return {transitions.count(), four / values, eight / values};
}

LengthAdvice advise_length(const std::vector<Trajectory>& runs, const LinearStructure& structure) {
  constexpr std::array<Index, 10> ladder{10, 15, 25, 40, 60, 100, 150, 250, 400, 600};
  constexpr double enough = 0.2, about_as_good = 0.1;
  constexpr Index windows_per_run = 100, transitions_per_regressor = 8;
  std::vector<LengthAdvice> candidates;
  for (const Index length : ladder) {
    const auto long_enough =
        std::count_if(runs.begin(), runs.end(), [&](const Trajectory& run) { return run.transitions() >= 2 * length; });
    if (length < transitions_per_regressor * structure.regressors()) continue;
    if (2 * static_cast<std::size_t>(long_enough) < runs.size() && !candidates.empty()) break;
    DeficientWindows sum;
    for (const Trajectory& run : runs) {
      const DeficientWindows one = count_deficient_windows(run, length, structure, windows_per_run);
      // Each run is weighted by its length, even if only few of its windows were examined.
      const double scale = one.windows > 0
                               ? static_cast<double>(run.transitions() - length + 1) / static_cast<double>(one.windows)
                               : 0.0;
      sum.windows += std::lround(scale * static_cast<double>(one.windows));
      sum.deficient += std::lround(scale * static_cast<double>(one.deficient));
    }
    if (sum.windows > 0) candidates.push_back({length, sum.share(), sum.share() <= enough});
  }
  if (candidates.empty()) return {};
  const auto good = std::find_if(candidates.begin(), candidates.end(), [](const auto& c) { return c.enough; });
  if (good != candidates.end()) return *good;
  const double least = std::min_element(candidates.begin(), candidates.end(), [](const auto& a, const auto& b) {
                         return a.deficient < b.deficient;
                       })->deficient;
  return *std::find_if(candidates.begin(), candidates.end(),
                       [&](const auto& c) { return c.deficient <= least + about_as_good; });
}

LossAdvice advise_loss(const Recording& recording, const LinearStructure& structure) {
  constexpr double few = 1e-3, gross = 1e-2;
  LossAdvice advice;
  advice.tails = check_tails(recording, structure);
  if (advice.tails.beyond_four < few) advice.loss = Loss::trivial;
  if (advice.tails.beyond_eight > gross) advice.loss = Loss::tukey;
  return advice;
}

RateAdvice advise_rate(const RateFacts& facts) {
  constexpr double least_samples = 2.0, most_samples = 30.0, wanted_fast = 10.0, wanted_slow = 5.0;
  constexpr double much_jitter = 0.2, many_repeats = 0.3;
  const double per_time_constant = facts.inputs_hz * facts.time_constant_s;
  if (facts.time_constant_s > 0.0 && per_time_constant > most_samples)
    return {slower(facts.inputs_hz, wanted_fast / facts.time_constant_s), RateReason::too_fast};
  if (facts.repeated >= many_repeats && facts.repeated < 1.0)
    return {slower(facts.inputs_hz, facts.inputs_hz * (1.0 - facts.repeated)), RateReason::repeats};
  const double slow_hz = wanted_slow / std::max(facts.time_constant_s, 1e-30);
  if (facts.time_constant_s > 0.0 && per_time_constant < least_samples && facts.states_hz >= slow_hz)
    return {faster(facts.inputs_hz, slow_hz, facts.states_hz), RateReason::too_slow};
  if (facts.jitter > much_jitter) return {rounded(facts.inputs_hz), RateReason::jitter};
  return {};
}

}  // namespace modebank
