#include "filter/judge/free_run.hpp"

#include <array>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <utility>

#include "filter/judge/horizon.hpp"
#include "filter/judge/statistics.hpp"
#include "ident/base/interruption.hpp"
#include "ident/base/not_a_number.hpp"
#include "ident/base/seed.hpp"

namespace modebank {

namespace {

using Eigen::Index;

constexpr double band_level = 0.95;

FreeRun sized_free_run(Index n_y, Index samples) {
  FreeRun result;
  for (Eigen::MatrixXd* values : {&result.mean, &result.deviation, &result.lower, &result.upper, &result.pit})
    values->setConstant(n_y, samples, not_a_number);
  result.log_density.setConstant(samples, not_a_number);
  result.mode.setConstant(samples, -1);
  return result;
}

/// Samples [first, end) of a run between gaps at which filters restart.
struct SampleRange {
  Index first = 0, end = 0;
};

std::vector<SampleRange> stretches_of(const Trajectory& run, double dt_s) {
  std::vector<SampleRange> stretches;
  for (Index k = 0; k < run.samples(); ++k) {
    const bool gap =
        k > 0 && SampleFeed::steps_between(sample_time_s(run, k - 1), sample_time_s(run, k), dt_s) > longest_gap_steps;
    if (k == 0 || gap) stretches.push_back({k, k});
    stretches.back().end = k + 1;
  }
  return stretches;
}

/// Stores the prediction of sample k; `forecast` has been advanced to k.
void record(const Forecast& forecast, Index k, FreeRun& out) {
  forecast.mode_probability().maxCoeff(&out.mode(k));
  for (Index i = 0; i < out.mean.rows(); ++i) {
    out.deviation(i, k) = forecast.standard_deviation(i);
    out.lower(i, k) = forecast.quantile(i, 0.5 * (1.0 - band_level));
    out.upper(i, k) = forecast.quantile(i, 0.5 * (1.0 + band_level));
  }
}

/// Predicts from the filter's moment t to the sample before `end`.
void predict_on(ForecastingFilter& filter, const Trajectory& run, Index t, Index end, FreeRun& out) {
  Index lost = 0;
  filter.look_ahead(t, [&](Forecast& forecast, Index, Index k) {
    interruption_point();
    lost = forecast.lost_paths();
    if (k >= end) return false;
    Eigen::VectorXd mean(run.state.rows());
    for (Index i = 0; i < mean.size(); ++i) mean(i) = forecast.mean(i);
    if (!mean.allFinite()) {
      out.notes.push_back("is predicted up to sample " + std::to_string(k - 1) + "; later predictions are not finite");
      return false;
    }
    out.mean.col(k) = mean;
    record(forecast, k, out);
    const auto y = run.state.col(k);
    if (missing_entries(y) > 0) return true;
    for (Index i = 0; i < mean.size(); ++i) out.pit(i, k) = forecast.probability(i, y(i));
    Eigen::VectorXd error(mean.size());
    out.log_density(k) = forecast.observe(y, error);
    return true;
  });
  out.lost_paths += lost;
}

/// The moments of the filter's start and of sample `last`; -1 without a start between `first` and `last`.
std::pair<Index, Index> moments_before(const RunInstants& moments, Index first, Index last) {
  Index start = -1;
  for (Index t = 0; t < moments.count(); ++t) {
    const Instant& moment = moments.instants[static_cast<std::size_t>(t)];
    if (moment.starts && moment.sample >= first && moment.sample <= last) start = t;
    if (moment.sample == last) return {start, t};
  }
  return {-1, -1};
}

/// Filters the measured samples of a stretch and predicts the others, or says why it cannot.
void predict_stretch(ForecastingFilter& filter, const Trajectory& run, const SampleRange& stretch,
                     const std::string& where, const FreeRunOptions& options, FreeRun& out) {
  const Index last = stretch.first + options.samples - 1;
  const std::string measured = std::to_string(options.samples);
  if (last + 1 >= stretch.end) {
    out.notes.push_back("has " + std::to_string(stretch.end - stretch.first) + " samples" + where + ", of which " +
                        measured + " are used as measured: no sample is left to predict");
    return;
  }
  const auto [start, end] = moments_before(filter.moments(), stretch.first, last);
  if (start < 0) {
    out.notes.push_back("has too few complete measurements among its first " + measured + " samples" + where +
                        " for a filter to start");
    return;
  }
  for (Index t = start; t <= end; ++t) {
    interruption_point();
    filter.step_to(t);
  }
  predict_on(filter, run, end, stretch.end, out);
}

}  // namespace

FreeRun free_run(const Bank& bank, const Trajectory& run, const FilterOptions& filter, const FreeRunOptions& options) {
  const Index fewest = fewest_start_samples(bank.structure);
  if (options.samples < fewest)
    throw std::invalid_argument("a free run of this model starts from at least " + std::to_string(fewest) +
                                " measured samples, not " + std::to_string(options.samples));
  const std::unique_ptr<ForecastingFilter> predicting =
      free_running_filter(bank, run, filter, options.paths, derive_seed(options.seed, "free run " + run.run));
  FreeRun out = sized_free_run(bank.C.rows(), run.samples());
  const std::vector<SampleRange> stretches = stretches_of(run, bank.dt_s);
  for (const SampleRange& stretch : stretches) {
    const std::string where = stretches.size() > 1 ? " from sample " + std::to_string(stretch.first) + " on" : "";
    predict_stretch(*predicting, run, stretch, where, options, out);
  }
  return out;
}

namespace {

/// Sums over the scored samples of one or more runs. The first measurement is subtracted from all measurements. This
/// limits rounding errors if measurements are large compared with their standard deviation.
class FreeRunSums {
 public:
  void add(const Trajectory& run, const FreeRun& predicted) {
    if (y_.size() == 0) {
      squared_error_ = y_ = y_squared_ = Eigen::ArrayXd::Zero(run.state.rows());
      inside_.fill(y_);
    }
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
  for (const Role role : {Role::train, Role::test})
    sum_runs<FreeRunSums>(
        runs, role, [&](std::size_t i, FreeRunSums& sums) { sums.add(runs[i], free_runs.at(i)); },
        [&](const FreeRunSums& sums, const std::string& run) {
          rows.push_back(sums.row());
          rows.back().filter = filter;
          rows.back().role = role;
          rows.back().run = run;
          rows.back().start = options.samples;
        });
  return rows;
}

}  // namespace modebank
