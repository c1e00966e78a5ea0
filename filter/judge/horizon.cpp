#include "filter/judge/horizon.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "filter/judge/sample_paths.hpp"
#include "filter/step/drifting.hpp"
#include "filter/step/gaussian.hpp"
#include "filter/step/imm.hpp"
#include "filter/step/samples.hpp"
#include "ident/base/interruption.hpp"
#include "ident/base/linalg.hpp"
#include "ident/base/not_a_number.hpp"
#include "ident/base/seed.hpp"

namespace modebank {
namespace {

using Eigen::Index;
using ConstVector = Eigen::Ref<const Eigen::VectorXd>;

/// Log density of one sample's LevelErrors if the variances are multiplied by `factor`.
double log_density(const StudentNoise& noise, const ConstVector& whitened, const ConstVector& log_weight,
                   double factor) {
  const Index n = whitened.size() / log_weight.size();
  Eigen::VectorXd each = log_weight.array() - 0.5 * static_cast<double>(n) * std::log(factor);
  for (Index j = 0; j < each.size(); ++j)
    for (const double u : whitened.segment(j * n, n)) each(j) += noise.log_density(u * u / factor);
  const double highest = each.maxCoeff();
  return highest + std::log((each.array() - highest).exp().sum());
}

/// Forecast of a bank with running noise. `merged`: whether all noise levels are one Gaussian.
class RunningNoiseForecast {
 public:
  RunningNoiseForecast(const Bank& bank, bool merged)
      : merged_(merged), running_(bank.running_noise), noise_(running_.nu), forecast_(bank) {}

  void start(const DriftingFilter& origin) { forecast_.start(origin); }
  void step(const ConstVector& inputs) { forecast_.step(inputs); }
  void arrive(Index samples) {
    factor_ = running_.factor_at(samples);
    weight_ = merged_ ? predicted_probability() : forecast_.level_probability();
    covariance_.resize(weight_.size());
    for (Index j = 0; j < weight_.size(); ++j)
      covariance_[j] = merged_ ? forecast_.covariance() : forecast_.covariance(j).eval();
  }

  Eigen::VectorXd predicted_probability() const { return Eigen::VectorXd::Ones(1); }
  SignalMixture signal(Index i) const {
    SignalMixture result{weight_, Eigen::VectorXd::Constant(weight_.size(), forecast_.prediction()(i)), weight_,
                         noise_};
    for (Index j = 0; j < weight_.size(); ++j)
      result.deviation(j) = std::sqrt(std::max(factor_ * covariance_[j](i, i), least_variance));
    return result;
  }
  double observe(const ConstVector& y, Eigen::Ref<Eigen::VectorXd> error) const {
    error = y - forecast_.prediction();
    Eigen::VectorXd whitened(weight_.size() * error.size()), log_weight(weight_.size());
    whiten(y, whitened, log_weight);
    return measured_density(log_density(noise_, whitened, log_weight, factor_));
  }
  /// A column of LevelErrors.
  void whiten(const ConstVector& y, Eigen::Ref<Eigen::VectorXd> whitened,
              Eigen::Ref<Eigen::VectorXd> log_weight) const {
    const Eigen::VectorXd error = y - forecast_.prediction();
    for (Index j = 0; j < weight_.size(); ++j) {
      const Eigen::MatrixXd& S = covariance_[j];
      const Cholesky root(S);
      // a variance below the limit can only come from rounding
      const Eigen::ArrayXd deviation =
          root.definite() ? Eigen::ArrayXd(root.L().diagonal()) : S.diagonal().array().max(least_variance).sqrt();
      whitened.segment(j * error.size(), error.size()) =
          root.definite() ? root.whiten(error) : Eigen::VectorXd(error.array() / deviation);
      log_weight(j) = std::log(weight_(j)) - deviation.log().sum();
    }
  }

 private:
  bool merged_;
  RunningNoise running_;
  StudentNoise noise_;
  DriftingForecast forecast_;
  double factor_ = 1.0;
  Eigen::VectorXd weight_;                   ///< probabilities of the levels; one element if they are merged
  std::vector<Eigen::MatrixXd> covariance_;  ///< of each level
};

/// A filter that goes through the instants of a run, and the forecast that starts from it: start(filter), step(inputs),
/// arrive(samples) if it has this; then signal(i), the distribution of signal i by itself, observe(y, error), the joint
/// log density of a complete measurement, and predicted_probability() of the modes.
template <class Filter, class Forecast>
struct Forecaster {
  const Trajectory& run;
  RunInstants instants;
  Filter filter;
  Forecast forecast;

  Forecaster(const Bank& bank, const Trajectory& of_run, Filter of_filter, Forecast ahead)
      : run(of_run), instants(bank, of_run), filter(std::move(of_filter)), forecast(std::move(ahead)) {}

  Index sample(Index t) const { return instants.instants[t].sample; }

  /// Predicts from the present instant t. Calls arrive(samples, k) at the `samples`-th sample k after t, until this
  /// returns false or the stretch ends.
  template <class Arrive>
  void look_ahead(Index t, Arrive arrive) {
    forecast.start(filter);
    Index samples = 0;
    while (instants.continues(t)) {
      forecast.step(instants.inputs.col(++t));
      if (sample(t) < 0) continue;
      ++samples;
      if constexpr (requires { forecast.arrive(samples); }) forecast.arrive(samples);
      if (!arrive(samples, sample(t))) return;
    }
  }

  /// Filters the run and predicts from every sample. Calls filtered(k, log density) after each sample k, and
  /// arrive(h, k) for every complete measurement k at the h-th of the ascending horizons, at least one.
  template <class Filtered, class Arrive>
  void predict_run(const std::vector<Index>& horizons, Filtered filtered, Arrive arrive) {
    for (Index t = 0; t < instants.count(); ++t) {
      const double density = follow(instants, t, run, filter);
      if (sample(t) < 0) continue;
      filtered(sample(t), density);
      std::size_t next = 0;
      look_ahead(t, [&](Index samples, Index k) {
        if (samples != horizons[next]) return true;
        if (missing_entries(run.state.col(k)) == 0) arrive(next, k);
        return ++next < horizons.size();
      });
    }
  }
};

auto running_noise_forecaster(const Bank& bank, const Trajectory& run, bool merged) {
  return Forecaster(bank, run, DriftingFilter(bank), RunningNoiseForecast(bank, merged));
}

/// Calls use(forecaster) with that of the bank. The forecast of modes is by the moments of each (ImmFilter).
template <class Use>
void with_forecaster(const Bank& bank, const Trajectory& run, const FilterOptions& options, bool merged, Use use) {
  if (!bank.running_noise.empty()) {
    auto forecaster = running_noise_forecaster(bank, run, merged);
    use(forecaster);
    return;
  }
  with_sizes(bank.structure.dimension(), bank.C.rows(), [&]<int N, int NY>() {
    const ImmFilter<N, NY> filter(bank, options);
    Forecaster forecaster(bank, run, filter, filter);
    use(forecaster);
  });
}

/// One sample ahead by running noise, the prediction is the filter's own: its levels have different means.
void take_prediction(const DriftingFilter& filter, Index k, double log_density, HorizonEvaluation& out) {
  if (out.horizons.front() > 1 || std::isnan(out.log_density(0, k))) return;
  Eigen::VectorXd weight;
  filter.weigh_levels(0, weight);
  for (Index i = 0; i < out.error[0].rows(); ++i) out.pit[0](i, k) = filter.probability(i, 0.0, weight);
  out.error[0].col(k) = filter.innovation();
  out.log_density(0, k) = log_density;
}

constexpr double band_level = 0.95;

/// Stores what a forecast says of sample k, whose measurement is y. False if the mean is not finite.
template <class Forecast>
bool record(Forecast& forecast, const ConstVector& y, Index k, FreeRun& out) {
  const bool complete = missing_entries(y) == 0;
  Eigen::VectorXd mean(y.size());
  for (Index i = 0; i < y.size(); ++i) mean(i) = forecast.signal(i).centre();
  if (!mean.allFinite()) return false;
  out.mean.col(k) = mean;
  forecast.predicted_probability().maxCoeff(&out.mode(k));
  for (Index i = 0; i < y.size(); ++i) {
    const auto signal = forecast.signal(i);
    out.deviation(i, k) = signal.standard_deviation();
    out.lower(i, k) = signal.quantile(0.5 * (1.0 - band_level));
    out.upper(i, k) = signal.quantile(0.5 * (1.0 + band_level));
    if (complete) out.pit(i, k) = signal.probability(y(i));
  }
  if (complete) out.log_density(k) = forecast.observe(y, mean);  // `mean` becomes the error
  return true;
}

/// Filters the measured samples of a stretch and predicts the others, or says why it cannot. `where`: which stretch.
template <class Filter, class Forecast>
void predict_stretch(Forecaster<Filter, Forecast>& by, Index first, Index end, const std::string& where, Index samples,
                     FreeRun& out) {
  const std::vector<Instant>& instants = by.instants.instants;
  const std::string measured = std::to_string(samples);
  const Index last = first + samples - 1;
  if (last + 1 >= end) {
    out.notes.push_back("has " + std::to_string(end - first) + " samples" + where + ", of which " + measured +
                        " are used as measured: no sample is left to predict");
    return;
  }
  const Index origin = std::find_if(instants.begin(), instants.end(),
                                    [last](const Instant& instant) { return instant.sample == last; }) -
                       instants.begin();
  if (origin == by.instants.count()) {  // a run has no instants before a filter starts
    out.notes.push_back("has too few complete measurements among its first " + measured + " samples" + where +
                        " for a filter to start");
    return;
  }
  Index start = origin;
  while (!instants[start].starts) --start;
  for (Index t = start; t <= origin; ++t) {
    interruption_point();
    follow(by.instants, t, by.run, by.filter);
  }
  by.look_ahead(origin, [&](Index, Index k) {
    interruption_point();
    if (record(by.forecast, by.run.state.col(k), k, out)) return true;
    out.notes.push_back("is predicted up to sample " + std::to_string(k - 1) + "; later predictions are not finite");
    return false;
  });
  if constexpr (requires { by.forecast.lost(); }) out.lost_paths += by.forecast.lost();
}

}  // namespace

HorizonEvaluation empty_horizons(std::vector<Index> horizons, Index n_y, Index samples) {
  std::sort(horizons.begin(), horizons.end());
  horizons.erase(std::unique(horizons.begin(), horizons.end()), horizons.end());
  if (!horizons.empty() && horizons.front() < 1) throw std::invalid_argument("horizons must be at least 1");
  HorizonEvaluation out;
  out.error.assign(horizons.size(), Eigen::MatrixXd::Constant(n_y, samples, not_a_number));
  out.pit = out.error;
  out.log_density.setConstant(std::ssize(horizons), samples, not_a_number);
  out.horizons = std::move(horizons);
  return out;
}

HorizonEvaluation evaluate_horizons(const Bank& bank, const Trajectory& run, const FilterOptions& options,
                                    std::vector<Index> horizons) {
  check_run(bank, run);
  HorizonEvaluation out = empty_horizons(std::move(horizons), bank.C.rows(), run.samples());
  if (out.horizons.empty()) return out;
  with_forecaster(bank, run, options, false, [&](auto& by) {
    by.predict_run(
        out.horizons,
        [&](Index k, double log_density) {
          if constexpr (requires { take_prediction(by.filter, k, log_density, out); })
            take_prediction(by.filter, k, log_density, out);
        },
        [&](std::size_t h, Index k) {
          const auto y = run.state.col(k);
          out.log_density(h, k) = by.forecast.observe(y, out.error[h].col(k));
          for (Index i = 0; i < y.size(); ++i) out.pit[h](i, k) = by.forecast.signal(i).probability(y(i));
        });
  });
  return out;
}

double LevelErrors::widening_gain(const StudentNoise& noise, Index k, double factor) const {
  return log_density(noise, whitened.col(k), log_weight.col(k), factor) -
         log_density(noise, whitened.col(k), log_weight.col(k), 1.0);
}

std::vector<LevelErrors> level_errors(const Bank& bank, const Trajectory& run, const std::vector<Index>& horizons) {
  const Index J = bank.running_noise.levels();
  std::vector<LevelErrors> out(horizons.size(),
                               {Eigen::MatrixXd::Constant(J * bank.C.rows(), run.samples(), not_a_number),
                                Eigen::MatrixXd::Constant(J, run.samples(), not_a_number)});
  check_run(bank, run);
  auto by = running_noise_forecaster(bank, run, false);
  by.predict_run(
      horizons, [](Index, double) {},
      [&](std::size_t h, Index k) {
        by.forecast.whiten(run.state.col(k), out[h].whitened.col(k), out[h].log_weight.col(k));
      });
  return out;
}

FreeRun free_run(const Bank& bank, const Trajectory& run, const FilterOptions& filter, const FreeRunOptions& options) {
  const Index fewest = fewest_start_samples(bank.structure);
  if (options.samples < fewest)
    throw std::invalid_argument("a free run of this model starts from at least " + std::to_string(fewest) +
                                " measured samples, not " + std::to_string(options.samples));
  check_run(bank, run);
  FreeRun out;
  for (Eigen::MatrixXd* values : {&out.mean, &out.deviation, &out.lower, &out.upper, &out.pit})
    values->setConstant(bank.C.rows(), run.samples(), not_a_number);
  out.log_density.setConstant(run.samples(), not_a_number);
  out.mode.setConstant(run.samples(), -1);
  std::vector<Index> limits{0};  // the first samples of the stretches between gaps, and the number of samples
  for (Index k = 1; k < run.samples(); ++k)
    if (SampleFeed::steps_between(sample_time_s(run, k - 1), sample_time_s(run, k), bank.dt_s) > longest_gap_steps)
      limits.push_back(k);
  limits.push_back(run.samples());
  const auto predict = [&](auto& by) {
    for (std::size_t i = 0; i + 1 < limits.size(); ++i) {
      const std::string where = limits.size() > 2 ? " from sample " + std::to_string(limits[i]) + " on" : "";
      predict_stretch(by, limits[i], limits[i + 1], where, options.samples, out);
    }
  };
  if (bank.running_noise.empty() && !bank.transition_logit.empty()) {
    Forecaster by(bank, run, ImmFilter<Eigen::Dynamic, Eigen::Dynamic>(bank, filter),
                  SamplePaths(bank, options.paths, derive_seed(options.seed, "free run " + run.run)));
    predict(by);
  } else {
    with_forecaster(bank, run, filter, true, predict);
  }
  return out;
}

}  // namespace modebank
