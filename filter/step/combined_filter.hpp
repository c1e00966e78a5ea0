#pragma once

#include <memory>
#include <vector>

#include "filter/step/any_filter.hpp"
#include "modebank/filter/forecast_weights.hpp"

namespace modebank {

/// The name of several filters together as one of an archive's.
inline constexpr const char* combined_name = "combined";

/// The sizes of their estimates: the modes of `bank`, the first of them, and of its states the measured ones alone,
/// because others may have other lags. It is scored by and cannot be stepped.
Bank combined_frame(const Bank& bank);

/// Several filters of the same measurements as one: their predictions, weighted by how well each has predicted the run
/// so far. Prediction, state and their covariances are those of the mixture, of the measured states. The transform is
/// the mixture's for one signal; for several it is mixed by the joint weights, which is exact for the first of them.
/// spread_share is the filters' differences in the trace of innovation_covariance. Modes are the first filter's.
class CombinedFilter final : public AnyFilter {
 public:
  /// `start`: weights at the start and after every gap.
  CombinedFilter(std::vector<std::unique_ptr<AnyFilter>> filters, const std::vector<double>& start);
  const FilterEstimate& step(double time_s, const Eigen::Ref<const Eigen::VectorXd>& input,
                             const Eigen::Ref<const Eigen::VectorXd>& measurement) override;
  FilterEstimate forecast(double time_s, const Eigen::VectorXd& input) override;
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
