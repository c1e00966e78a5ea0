#include <array>
#include <cmath>
#include <optional>

#include "filter/judge/run/free_run.hpp"
#include "filter/judge/score/squared_distances.hpp"
#include "ident/base/not_a_number.hpp"

namespace modebank {

using Eigen::Index;

namespace {

/// Sums over the scored samples of one or more runs. The first measurement is subtracted from all measurements. This
/// limits rounding errors if measurements are large compared with their standard deviation.
class FreeRunSums {
 public:
  FreeRunSums(Index n_y)
      : squared_error_(Eigen::ArrayXd::Zero(n_y)), y_(squared_error_), y_squared_(squared_error_), inside_{} {
    inside_.fill(squared_error_);
  }

  void add(const Trajectory& run, const FreeRun& predicted) {
    lost_ += predicted.lost_paths;
    for (Index k = 0; k < run.samples(); ++k)
      if (!std::isnan(predicted.log_density(k))) add_sample(run.state.col(k), predicted, k);
  }

  FreeRunRow row() const {
    FreeRunRow row;
    const double N = samples_ > 0 ? static_cast<double>(samples_) : not_a_number;
    row.samples = samples_;
    row.lost_paths = lost_;
    row.log_score = log_density_ / N;
    row.rmse = (squared_error_ / N).sqrt();
    const Eigen::ArrayXd variance = (y_squared_ / N - (y_ / N).square()).max(0.0);
    row.nrmse = (variance > 0.0).select(row.rmse.array() / variance.sqrt(), not_a_number);
    row.fit = 100.0 * (1.0 - row.nrmse.array());
    row.coverage_50 = inside_[0] / N;
    row.coverage_90 = inside_[1] / N;
    row.coverage_95 = inside_[2] / N;
    row.coverage_99 = inside_[3] / N;
    return row;
  }

 private:
  Index samples_ = 0, lost_ = 0;
  double log_density_ = 0.0;
  Eigen::ArrayXd squared_error_, y_, y_squared_, origin_;
  std::array<Eigen::ArrayXd, coverage_levels.size()> inside_;

  void add_sample(const Eigen::Ref<const Eigen::VectorXd>& y, const FreeRun& predicted, Index k) {
    if (samples_++ == 0) origin_ = y.array();
    log_density_ += predicted.log_density(k);
    squared_error_ += (y - predicted.mean.col(k)).array().square();
    y_ += y.array() - origin_;
    y_squared_ += (y.array() - origin_).square();
    for (std::size_t b = 0; b < inside_.size(); ++b)
      inside_[b] += ((predicted.pit.col(k).array() - 0.5).abs() <= 0.5 * coverage_levels[b]).cast<double>();
  }
};

}  // namespace

std::vector<FreeRunRow> summarize_free_runs(const std::string& filter, const std::vector<Trajectory>& runs,
                                            const std::vector<FreeRun>& free_runs, const FreeRunOptions& options) {
  std::vector<FreeRunRow> rows;
  const auto add_row = [&](const FreeRunSums& sums, Role role, const std::string& run) {
    FreeRunRow& row = rows.emplace_back(sums.row());
    row.filter = filter;
    row.role = role;
    row.run = run;
    row.method = free_runs.front().method;
    row.start = options.samples;
  };
  for (const Role role : {Role::train, Role::test}) {
    std::optional<FreeRunSums> pooled;
    for (std::size_t i = 0; i < runs.size(); ++i) {
      if (runs[i].role != role) continue;
      FreeRunSums single(runs[i].state.rows());
      single.add(runs[i], free_runs.at(i));
      add_row(single, role, runs[i].run);
      if (!pooled) pooled.emplace(runs[i].state.rows());
      pooled->add(runs[i], free_runs[i]);
    }
    if (pooled) add_row(*pooled, role, "*");
  }
  return rows;
}

}  // namespace modebank
