#include "app/chain/expected_time.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "ident/fit/fit_windows.hpp"
#include "mixture/features.hpp"
#include "mixture/select.hpp"
#include "modebank/mixture/options.hpp"

namespace modebank {
namespace {

constexpr double worth_a_line_s = 30.0;
constexpr double second_per_minute = 60.0;

/// Rounds a time, for example to "45 s" or "3 min".
std::string rounded_time(double seconds) {
  return seconds < 2.0 * second_per_minute ? fmt::format("{:.0f} s", seconds)
                                           : fmt::format("{:.0f} min", seconds / second_per_minute);
}

}  // namespace

double expected_windows_s(const Recording& recording, const FitOptions& window) {
  constexpr double ceres_s = 7e-5, ceres_entry_s = 1.6e-8,
                   batch_entry_s = 5e-9;  // [s] per window (ceres_s), or per entry
                                          // of L matrices of q x q (the other two)
  const LinearStructure s = linear_structure(recording.state_count(), recording.input_count(), window);
  const Index count = count_windows(recording, window);
  const double q = static_cast<double>(s.regressors()), entries = q * q * static_cast<double>(window.length);
  const bool batch = window.solver == WindowSolver::batch ||
                     (window.solver == WindowSolver::automatic && s.states == 1 && count > most_ceres_windows);
  const double one_s =
      batch ? batch_entry_s * entries : static_cast<double>(s.states) * (ceres_s + ceres_entry_s * entries);
  return static_cast<double>(count) * one_s;
}

double expected_mixture_s(const WindowFits& windows, const ClusterOptions& options) {
  constexpr double number_s = 1.7e-8;  // [s] per point, restart and number of a component (mean, variances, weight)
  const Index all = windows.parameter_count() + windows.structure.states;
  const Index features = clusters_one_lag(windows, options.features)
                             ? windows.structure.with_one_lag().parameters() + windows.structure.states
                             : all;
  const auto F = static_cast<double>(
      options.features == FeatureSet::automatic ? std::min(features, Index{most_features}) : features);
  const bool diagonal = options.selection.em.covariance == CovarianceType::diagonal;
  const double numbers = diagonal ? 2.0 * F + 1.0 : 0.5 * (F + 1.0) * (F + 2.0);
  const std::vector<Index>& candidates = options.selection.components;
  const auto components = static_cast<double>(std::accumulate(candidates.begin(), candidates.end(), Index{0}));
  return number_s * numbers * components * static_cast<double>(options.selection.em.restarts) *
         static_cast<double>(std::min(windows.count(), most_compared));
}

double expected_learning_s(const Recording& recording, const LinearStructure& structure, const RefineOptions& options) {
  constexpr double coefficient_s = 4e-4;  // [s] per coefficient and transition, with the default number of starts and
                                          // folds
  const Index all = recording.transitions(Role::train);
  const Index learned = options.transitions > 0 ? std::min(all, options.transitions) : all;
  return coefficient_s * static_cast<double>(learned) * static_cast<double>(structure.parameters());
}

void tell_if_long(const Listener& listener, const std::string& stage, double seconds, const std::string& instead) {
  if (seconds > worth_a_line_s)
    listener.progress(
        fmt::format("{}: expected to take {} of processor time; {}", stage, rounded_time(seconds), instead));
}

}  // namespace modebank
