#pragma once

#include <memory>
#include <string>
#include <vector>

#include "app/cli/live_filter.hpp"
#include "modebank/filter/forecast_weights.hpp"

namespace modebank::app {

/// Several filters of an archive at work, their predictions weighted by how well each has predicted so far, as
/// score_ahead has them one sample ahead. Means and covariances are those of the mixture of their predictions; the
/// transform is the mixture's for one signal, and of several its approximation by the joint weights. Modes are the
/// first filter's.
class CombinedFilter final : public LiveFilter {
 public:
  /// `start`: weights at the start and after every gap.
  CombinedFilter(std::vector<std::unique_ptr<LiveFilter>> filters, const std::vector<double>& start);
  const FilterEstimate& step(double time_s, const Eigen::VectorXd& input, const Eigen::VectorXd& measurement) override;
  FilterEstimate forecast(double time_s, const Eigen::VectorXd& input) override;
  bool started() const override;
  void restart() override;
  void remember() override;
  void go_back() override;
  void save(const std::string&, const std::string&) const override { refuse(); }
  Resumed resume(const std::string&, const std::string&) override { refuse(); }
  /// Said before the first sample is read (open_filter).
  [[noreturn]] static void refuse();

 private:
  std::vector<std::unique_ptr<LiveFilter>> filters_;
  filter::ForecastWeights weights_, remembered_;
  std::vector<const FilterEstimate*> said_;
  std::vector<double> log_densities_;
  FilterEstimate estimate_;

  void combine();
  /// Puts what was said together, each by its share.
  void mix(const std::vector<double>& share, FilterEstimate& mixed) const;
};

}  // namespace modebank::app
