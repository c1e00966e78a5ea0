#pragma once

#include <vector>

#include "filter/step/bank_filter.hpp"
#include "modebank/filter/forecast_weights.hpp"

namespace modebank {

/// Name of the combination of several filters in archives.
inline constexpr const char* combined_name = "combined";

/// The bank of the first filter with only its measured states, because other filters may have other lags. For scores.
Bank combined_frame(const Bank& bank);

/// Combines several filters of the same measurements into one, by ForecastWeights. Prediction, state and covariances
/// are those of the mixture, for the measured states. With several signals the transform is mixed by the joint weights,
/// which is exact for the first signal. Modes are those of the first filter.
class CombinedFilter {
 public:
  /// `start`: weights at the start and after every gap.
  CombinedFilter(std::vector<BankFilter> filters, const std::vector<double>& start);
  /// A single filter keeps its own estimates, with its lagged states.
  explicit CombinedFilter(BankFilter alone);

  /// As BankFilter::step.
  const FilterEstimate& step(double time_s, const Eigen::Ref<const Eigen::VectorXd>& input,
                             const Eigen::Ref<const Eigen::VectorXd>& measurement);
  /// The result of the last step.
  const FilterEstimate& estimate() const { return combines_ ? estimate_ : filters_.front().estimate(); }
  bool started() const { return filters_.front().started(); }
  void restart();

  struct Snapshot {
    std::vector<std::vector<double>> filters;
    filter::ForecastWeights weights;
  };
  Snapshot snapshot() const;
  /// Continues from a snapshot of this filter.
  void restore(const Snapshot& snapshot);

 private:
  std::vector<BankFilter> filters_;
  bool combines_;
  filter::ForecastWeights weights_;
  std::vector<double> log_densities_, shares_;
  FilterEstimate estimate_;
  CombinedInnovation innovation_;

  void mix(const Eigen::Ref<const Eigen::VectorXd>& measurement);
};

}  // namespace modebank
