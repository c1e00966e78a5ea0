#pragma once

#include <memory>
#include <vector>

#include "filter/step/any_filter.hpp"
#include "modebank/filter/forecast_weights.hpp"

namespace modebank {

/// Name of the combination of several filters in archives.
inline constexpr const char* combined_name = "combined";

/// A bank with the sizes of the combined estimates. It has the modes of `bank` (the first filter) and only its measured
/// states, because other filters may have other lags. It is used for scores and cannot be stepped.
Bank combined_frame(const Bank& bank);

/// Combines several filters of the same measurements into one filter. Predictions are weighted by past success within
/// the run. Prediction, state and covariances are those of the mixture, for the measured states. With one signal the
/// transform is that of the mixture. With several signals it is mixed by the joint weights, which is exact for the
/// first signal. Modes are those of the first filter.
class CombinedFilter final : public AnyFilter {
 public:
  /// `start`: weights at the start and after every gap.
  CombinedFilter(std::vector<std::unique_ptr<AnyFilter>> filters, const std::vector<double>& start);
  const FilterEstimate& step(double time_s, const Eigen::Ref<const Eigen::VectorXd>& input,
                             const Eigen::Ref<const Eigen::VectorXd>& measurement) override;
  bool started() const override { return filters_.front()->started(); }
  void restart() override;
  void remember() override;
  void go_back() override;

 private:
  std::vector<std::unique_ptr<AnyFilter>> filters_;
  filter::ForecastWeights weights_, remembered_;
  std::vector<const FilterEstimate*> said_;
  std::vector<double> log_densities_;
  FilterEstimate estimate_;

  void combine();
  void mix(const std::vector<double>& share, FilterEstimate& mixed) const;
};

}  // namespace modebank
