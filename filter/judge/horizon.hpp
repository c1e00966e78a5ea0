#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "filter/judge/evaluate.hpp"
#include "filter/step/bank.hpp"
#include "filter/step/drifting.hpp"
#include "filter/step/noise_density.hpp"
#include "filter/step/samples.hpp"
#include "ident/base/not_a_number.hpp"
#include "ident/data/trajectory.hpp"
#include "modebank/filter/options.hpp"

/// Predictions some samples ahead along a recorded run. Horizons and free runs make them here.
namespace modebank {

/// A prediction of the n_y measured signals some steps ahead, with known inputs and no further measurements.
class Forecast {
 public:
  using Vector = Eigen::Ref<const Eigen::VectorXd>;

  virtual ~Forecast() = default;
  /// Advances by one model step under these acting inputs.
  virtual void step(const Vector& inputs) = 0;
  /// Precedes the questions below. `samples`: number of samples ahead, at least 1.
  virtual void arrive(Eigen::Index /*samples*/) {}

  virtual double mean(Eigen::Index i) const { return signal(i).centre(); }
  virtual double standard_deviation(Eigen::Index i) const { return signal(i).standard_deviation(); }
  /// P(y_i <= y), and its inverse: the y with that probability.
  virtual double probability(Eigen::Index i, double y) const { return signal(i).probability(y); }
  virtual double quantile(Eigen::Index i, double probability) const { return signal(i).quantile(probability); }
  /// Joint log density of a complete measurement [nats]. `error`: measurement minus mean, n_y.
  virtual double observe(const Vector& y, Eigen::Ref<Eigen::VectorXd> error) = 0;
  virtual Eigen::VectorXd mode_probability() const = 0;  ///< K
  /// Number of sample paths that diverged and were removed.
  virtual Eigen::Index lost_paths() const { return 0; }

 protected:
  Forecast() = default;
  Forecast(const Forecast&) = default;
  Forecast& operator=(const Forecast&) = default;
  /// Distribution of signal i, whatever the other signals are. A forecast without one overrides the questions.
  virtual SignalMixture signal(Eigen::Index /*i*/) const { return {}; }
};

/// A filter that goes through the moments of a run and can predict from each.
class ForecastingFilter {
 public:
  virtual ~ForecastingFilter() = default;
  ForecastingFilter(const ForecastingFilter&) = delete;
  ForecastingFilter& operator=(const ForecastingFilter&) = delete;

  const RunInstants& moments() const { return moments_; }
  /// Advances from the previous moment to moment t.
  virtual void step_to(Eigen::Index t) = 0;

  /// Predicts from the present moment t. Calls arrive(forecast, ahead, k) at each sample k, which is the `ahead`-th
  /// sample after t. Ends if `arrive` returns false or the stretch ends.
  template <class Arrive>
  void look_ahead(Eigen::Index t, Arrive arrive) {
    Forecast& forecast = start_forecast();
    Eigen::Index ahead = 0;
    while (moments_.continues(t)) {
      forecast.step(moments_.inputs.col(++t));
      const Eigen::Index k = moments_.instants[static_cast<std::size_t>(t)].sample;
      if (k < 0) continue;
      forecast.arrive(++ahead);
      if (!arrive(forecast, ahead, k)) return;
    }
  }

  /// Filters the run and predicts from every sample. Calls arrive(forecast, h, k) for every complete measurement k at
  /// the h-th horizon. `horizons`: samples ahead, at least one of them, ascending.
  template <class Arrive>
  void predict_run(const std::vector<Eigen::Index>& horizons, Arrive arrive) {
    for (Eigen::Index t = 0; t < moments_.count(); ++t) {
      step_to(t);
      if (moments_.instants[static_cast<std::size_t>(t)].sample < 0) continue;
      std::size_t next = 0;
      look_ahead(t, [&](Forecast& forecast, Eigen::Index ahead, Eigen::Index k) {
        if (ahead != horizons[next]) return true;
        if (missing_entries(run_.state.col(k)) == 0) arrive(forecast, next, k);
        return ++next < horizons.size();
      });
    }
  }

 protected:
  ForecastingFilter(const Bank& bank, const Trajectory& run) : run_(run), moments_(bank, run) {}
  const Trajectory& run_;

  /// The forecast of the present state.
  virtual Forecast& start_forecast() = 0;

 private:
  RunInstants moments_;
};

/// A filter whose forecasts keep the levels of running noise apart. Conditions are those of evaluate_run.
std::unique_ptr<ForecastingFilter> forecasting_filter(const Bank& bank, const Trajectory& run,
                                                      const FilterOptions& options);
/// A filter for free runs: levels of running noise are one Gaussian. `paths`: number of sample paths, if the bank's
/// transitions depend on the state.
std::unique_ptr<ForecastingFilter> free_running_filter(const Bank& bank, const Trajectory& run,
                                                       const FilterOptions& options, Eigen::Index paths,
                                                       std::uint64_t seed);

/// Errors of predictions at one horizon by a bank with running noise of J levels, for choosing a factor on the
/// variance. NaN where no complete measurement was predicted.
struct LevelErrors {
  Eigen::MatrixXd whitened;    ///< J n x N: L^-1 error in each level, with L L' = cov(error)
  Eigen::MatrixXd log_weight;  ///< J x N: log of the level's probability divided by the determinant of L

  /// Change of the log density of sample k if the variance is multiplied by `factor`.
  double widening_gain(const StudentNoise& noise, Eigen::Index k, double factor) const;
};
/// One element per horizon (samples ahead, ascending).
std::vector<LevelErrors> level_errors(const Bank& bank, const Trajectory& run,
                                      const std::vector<Eigen::Index>& horizons);

/// Predictions of a run's measurements. A prediction is made some samples earlier, from the measurements up to that
/// time and the inputs recorded since. Column k belongs to sample k. NaN if no filter was running at that time, or if
/// the measurement is incomplete.
struct HorizonEvaluation {
  std::vector<Eigen::Index> horizons;  ///< samples ahead, ascending
  std::vector<Eigen::MatrixXd> error;  ///< per horizon n_y x N: measurement minus combined prediction
  std::vector<Eigen::MatrixXd> pit;    ///< per horizon n_y x N: P(y_i <= measurement) of each signal by itself
  Eigen::MatrixXd log_density;         ///< horizons x N: log predictive density of the measurement [nats]
};

/// An empty evaluation for a run of n_y signals. `horizons`: ascending, without duplicates. Throws
/// std::invalid_argument for a horizon below 1.
HorizonEvaluation empty_horizons(std::vector<Eigen::Index> horizons, Eigen::Index n_y, Eigen::Index samples);

/// Evaluates predictions at several horizons, each at least 1; horizon 1 equals evaluate_run. Conditions are those of
/// evaluate_run. The cost per sample is one step per sample of the longest horizon.
HorizonEvaluation evaluate_horizons(const Bank& bank, const Trajectory& run, const FilterOptions& options,
                                    std::vector<Eigen::Index> horizons);

/// One row of /evaluation/horizon.
struct HorizonRow {
  std::string filter;  ///< bank or a competitor
  Role role = Role::train;
  std::string run;                    ///< name of the run; "*": all runs of the role pooled
  Eigen::Index horizon = 1;           ///< samples ahead
  Eigen::Index samples = 0;           ///< scored samples
  double log_score = 0.0;             ///< mean log predictive density [nats/sample]
  Eigen::VectorXd rmse;               ///< n_y [state unit]
  double coverage_95 = not_a_number;  ///< share of the signals inside the central 95 % band
};

/// Sums over the scored samples of one or more runs at one horizon.
struct HorizonSums {
  Eigen::Index horizon = 1;  ///< samples ahead
  Eigen::Index samples = 0;
  double log_density = 0.0;
  Eigen::ArrayXd squared_error;  ///< n_y
  double inside = 0.0;           ///< number of signals inside the central 95 % band
};
/// The sums of a run, one element per horizon.
std::vector<HorizonSums> sum_horizons(const HorizonEvaluation& run);
/// Adds the sums of a run to those of all runs, which are empty at first.
void pool(const std::vector<HorizonSums>& run, std::vector<HorizonSums>& all);

/// Rows of one filter in the order of summarize_free_runs(), each with all horizons. `sums`: the sums of every run.
std::vector<HorizonRow> summarize_horizons(const std::string& filter, const std::vector<Trajectory>& runs,
                                           const std::vector<std::vector<HorizonSums>>& sums);

}  // namespace modebank
