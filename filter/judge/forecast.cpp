#include "filter/judge/forecast.hpp"

#include <cmath>

#include "filter/judge/sample_paths.hpp"
#include "filter/step/drifting.hpp"
#include "filter/step/gaussian.hpp"
#include "filter/step/imm_filter.hpp"
#include "ident/base/distributions.hpp"
#include "ident/base/linalg.hpp"
#include "ident/base/not_a_number.hpp"

namespace modebank {

namespace {

using Eigen::Index;

/// Forecast of a bank by the moments of its modes.
template <int N, int NY>
class MomentForecast final : public Forecast {
 public:
  explicit MomentForecast(const ImmFilter<N, NY>& bank) : bank_(bank) {}
  void start(const ImmFilter<N, NY>& origin) { bank_.start(origin); }
  void step(const Vector& inputs) override { bank_.step(inputs); }

  Eigen::VectorXd mean() const override {
    return of_signals([](const NormalMixture& signal) { return signal.mixture_mean(); });
  }
  Eigen::VectorXd standard_deviation() const override {
    return of_signals([](const NormalMixture& signal) {
      const auto variance = signal.deviation.array().square() + (signal.mean.array() - signal.mixture_mean()).square();
      return std::sqrt((signal.weight.array() * variance).sum());
    });
  }
  double probability(Index i, double y) const override { return bank_.signal(i).probability(y); }
  double quantile(Index i, double p) const override { return bank_.signal(i).quantile(p, normal_quantile(p)); }
  double observe(const Vector& y, Eigen::Ref<Eigen::VectorXd> error) override { return bank_.observe(y, error); }
  Eigen::VectorXd mode_probability() const override { return bank_.predicted_probability(); }

 private:
  ImmFilter<N, NY> bank_;

  template <class F>
  Eigen::VectorXd of_signals(F f) const {
    Eigen::VectorXd result(bank_.model().C.rows());
    for (Index i = 0; i < result.size(); ++i) result(i) = f(bank_.signal(i));
    return result;
  }
};

/// Log density of a mixture of levels whose variances are multiplied by `factor`. `whitened`, `log_weight`: of one
/// sample (LevelErrors).
double log_density(const StudentNoise& noise, const Eigen::Ref<const Eigen::VectorXd>& whitened,
                   const Eigen::Ref<const Eigen::VectorXd>& log_weight, double factor) {
  const Index n = whitened.size() / log_weight.size();
  Eigen::VectorXd each = log_weight.array() - 0.5 * static_cast<double>(n) * std::log(factor);
  for (Index j = 0; j < each.size(); ++j)
    for (const double u : whitened.segment(j * n, n)) each(j) += noise.log_density(u * u / factor);
  const double highest = each.maxCoeff();
  return highest + std::log((each.array() - highest).exp().sum());
}

/// Forecast of a bank with running noise.
class RunningNoiseForecast final : public Forecast {
 public:
  /// `merged`: whether all noise levels are one Gaussian.
  RunningNoiseForecast(const Bank& bank, bool merged)
      : merged_(merged), running_(bank.running_noise), noise_(running_.nu), forecast_(bank) {}
  void start(const DriftingFilter& origin) { forecast_.start(origin); }
  void step(const Vector& inputs) override { forecast_.step(inputs); }
  void arrive(Index samples) override {
    factor_ = running_.factor_at(samples);
    if (merged_) covariance_ = forecast_.covariance();
  }

  Eigen::VectorXd mean() const override { return forecast_.prediction(); }
  Eigen::VectorXd standard_deviation() const override { return deviation_of(covariance_); }
  double probability(Index i, double y) const override {
    double sum = 0.0;
    for (Index j = 0; j < levels(); ++j)
      sum += weight(j) * noise_.probability((y - forecast_.prediction()(i)) / deviation_of(covariance(j))(i));
    return std::isnan(sum) ? 1.0 : sum;  // NaN: a failed prediction
  }
  double quantile(Index i, double p) const override {
    const double nu = running_.nu,
                 units = nu == 0.0 ? normal_quantile(p) : student_quantile(p, nu) * std::sqrt((nu - 2.0) / nu);
    return forecast_.prediction()(i) + units * standard_deviation()(i);
  }
  double observe(const Vector& y, Eigen::Ref<Eigen::VectorXd> error) override {
    error = y - forecast_.prediction();
    Eigen::VectorXd whitened(levels() * error.size()), log_weight(levels());
    whiten(y, whitened, log_weight);
    return measured_density(log_density(noise_, whitened, log_weight, factor_));
  }
  Eigen::VectorXd mode_probability() const override { return Eigen::VectorXd::Ones(1); }

  /// A column of LevelErrors: errors divided by their standard deviations and decorrelated in order.
  void whiten(const Vector& y, Eigen::Ref<Eigen::VectorXd> whitened, Eigen::Ref<Eigen::VectorXd> log_weight) const {
    const Eigen::VectorXd error = y - forecast_.prediction();
    for (Index j = 0; j < levels(); ++j) {
      auto white = whitened.segment(j * error.size(), error.size());
      const Eigen::MatrixXd S = covariance(j);
      const Cholesky root(S);
      // a variance below the limit can only come from rounding
      const Eigen::ArrayXd deviation =
          root.definite() ? Eigen::ArrayXd(root.L().diagonal()) : S.diagonal().array().max(least_variance).sqrt();
      white = root.definite() ? root.whiten(error) : Eigen::VectorXd(error.array() / deviation);
      log_weight(j) = std::log(weight(j)) - deviation.log().sum();
    }
  }

 private:
  bool merged_;
  RunningNoise running_;
  StudentNoise noise_;
  DriftingForecast forecast_;
  double factor_ = 1.0;
  Eigen::MatrixXd covariance_;  ///< of all levels; only if they are merged

  Index levels() const { return merged_ ? 1 : forecast_.level_probability().size(); }
  double weight(Index level) const { return merged_ ? 1.0 : forecast_.level_probability()(level); }
  Eigen::MatrixXd covariance(Index level) const {
    return merged_ ? covariance_ : Eigen::MatrixXd(forecast_.covariance(level));
  }
  Eigen::ArrayXd deviation_of(const Eigen::MatrixXd& covariance) const {
    return (factor_ * covariance.diagonal().array()).max(least_variance).sqrt();
  }
};

/// A filter, and the forecast that starts from it.
template <class Filter, class Ahead>
class FilterWithForecast final : public ForecastingFilter {
 public:
  FilterWithForecast(const Bank& bank, const Trajectory& run, Filter filter, Ahead ahead)
      : ForecastingFilter(bank, run), filter_(std::move(filter)), forecast_(std::move(ahead)) {}
  void step_to(Index t) override { follow(moments(), t, run_, filter_); }
  const Ahead& forecast() const { return forecast_; }

 protected:
  Forecast& start_forecast() override {
    forecast_.start(filter_);
    return forecast_;
  }

 private:
  Filter filter_;
  Ahead forecast_;
};

template <class Filter, class Ahead>
auto make_filter(const Bank& bank, const Trajectory& run, Filter filter, Ahead ahead) {
  return std::make_unique<FilterWithForecast<Filter, Ahead>>(bank, run, std::move(filter), std::move(ahead));
}

/// `merged`: see RunningNoiseForecast.
auto running_noise_filter(const Bank& bank, const Trajectory& run, bool merged) {
  validate(bank);
  return make_filter(bank, run, DriftingFilter(bank), RunningNoiseForecast(bank, merged));
}

using AnyFilter = std::unique_ptr<ForecastingFilter>;

AnyFilter moment_filter(const Bank& bank, const Trajectory& run, const FilterOptions& options) {
  return with_sizes(bank.structure.dimension(), bank.C.rows(), [&]<int N, int NY>() -> AnyFilter {
    const ImmFilter<N, NY> filter(bank, options);
    return make_filter(bank, run, filter, MomentForecast<N, NY>(filter));
  });
}

}  // namespace

AnyFilter forecasting_filter(const Bank& bank, const Trajectory& run, const FilterOptions& options) {
  check_run(bank, run);
  if (bank.running_noise.empty()) return moment_filter(bank, run, options);
  return running_noise_filter(bank, run, false);
}

AnyFilter free_running_filter(const Bank& bank, const Trajectory& run, const FilterOptions& options, Index paths,
                              std::uint64_t seed) {
  check_run(bank, run);
  if (!bank.running_noise.empty()) return running_noise_filter(bank, run, true);
  if (bank.transition_logit.empty()) return moment_filter(bank, run, options);
  return make_filter(bank, run, ImmFilter<Eigen::Dynamic, Eigen::Dynamic>(bank, options),
                     SamplePaths(bank, paths, seed));
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
  if (horizons.empty()) return out;
  check_run(bank, run);
  const auto filter = running_noise_filter(bank, run, false);
  filter->predict_run(horizons, [&](const Forecast&, std::size_t h, Index k) {
    filter->forecast().whiten(run.state.col(k), out[h].whitened.col(k), out[h].log_weight.col(k));
  });
  return out;
}

}  // namespace modebank
