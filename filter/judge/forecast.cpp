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
  explicit MomentForecast(const ImmFilter<N, NY>& bank) : bank_(bank), outputs_(bank.model().C.rows()) {}
  void start(const ImmFilter<N, NY>& origin) { bank_.start(origin); }
  void step(const Vector& inputs) override { bank_.step(inputs); }

  Eigen::VectorXd mean() const override {
    Eigen::VectorXd result(outputs_);
    for (Index i = 0; i < outputs_; ++i) {
      const NormalMixture signal = bank_.signal(i);
      result(i) = signal.weight.dot(signal.mean);
    }
    return result;
  }
  Eigen::VectorXd standard_deviation() const override {
    Eigen::VectorXd result = mean();
    for (Index i = 0; i < outputs_; ++i) {
      const NormalMixture signal = bank_.signal(i);
      const auto variance = signal.deviation.array().square() + (signal.mean.array() - result(i)).square();
      result(i) = std::sqrt((signal.weight.array() * variance).sum());
    }
    return result;
  }
  double probability(Index i, double y) const override { return bank_.signal(i).probability(y); }
  double quantile(Index i, double p) const override { return bank_.signal(i).quantile(p, normal_quantile(p)); }
  double observe(const Vector& y, Eigen::Ref<Eigen::VectorXd> error) override { return bank_.observe(y, error); }
  Eigen::VectorXd mode_probability() const override { return bank_.predicted_probability(); }

 private:
  ImmFilter<N, NY> bank_;
  Index outputs_;
};

template <int N, int NY>
class MomentFilter final : public ForecastingFilter {
 public:
  MomentFilter(const Bank& bank, const Trajectory& run, const FilterOptions& options)
      : ForecastingFilter(bank, run), filter_(bank, options), forecast_(filter_) {}
  void step_to(Index t) override { follow(moments(), t, run_, filter_); }

 protected:
  Forecast& start_forecast() override {
    forecast_.start(filter_);
    return forecast_;
  }

 private:
  ImmFilter<N, NY> filter_;
  MomentForecast<N, NY> forecast_;
};

class PathFilter final : public ForecastingFilter {
 public:
  PathFilter(const Bank& bank, const Trajectory& run, const FilterOptions& options, Index paths, std::uint64_t seed)
      : ForecastingFilter(bank, run), filter_(bank, options), paths_(bank, paths, seed) {}
  void step_to(Index t) override { follow(moments(), t, run_, filter_); }

 protected:
  Forecast& start_forecast() override {
    paths_.start(filter_.state());
    return paths_;
  }

 private:
  ImmFilter<Eigen::Dynamic, Eigen::Dynamic> filter_;
  SamplePaths paths_;
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

class RunningNoiseFilter final : public ForecastingFilter {
 public:
  RunningNoiseFilter(const Bank& bank, const Trajectory& run, bool merged)
      : ForecastingFilter(bank, run), filter_(bank), forecast_(bank, merged) {}
  void step_to(Index t) override { follow(moments(), t, run_, filter_); }
  const RunningNoiseForecast& forecast() const { return forecast_; }

 protected:
  Forecast& start_forecast() override {
    forecast_.start(filter_);
    return forecast_;
  }

 private:
  DriftingFilter filter_;
  RunningNoiseForecast forecast_;
};

std::unique_ptr<ForecastingFilter> moment_filter(const Bank& bank, const Trajectory& run,
                                                 const FilterOptions& options) {
  return with_sizes(bank.structure.dimension(), bank.C.rows(),
                    [&]<int N, int NY>() -> std::unique_ptr<ForecastingFilter> {
                      return std::make_unique<MomentFilter<N, NY>>(bank, run, options);
                    });
}

}  // namespace

std::unique_ptr<ForecastingFilter> forecasting_filter(const Bank& bank, const Trajectory& run,
                                                      const FilterOptions& options) {
  check_run(bank, run);
  if (bank.running_noise.empty()) return moment_filter(bank, run, options);
  validate(bank);
  return std::make_unique<RunningNoiseFilter>(bank, run, false);
}

std::unique_ptr<ForecastingFilter> free_running_filter(const Bank& bank, const Trajectory& run,
                                                       const FilterOptions& options, Index paths, std::uint64_t seed) {
  check_run(bank, run);
  if (!bank.running_noise.empty()) return std::make_unique<RunningNoiseFilter>(bank, run, true);
  if (!bank.transition_logit.empty()) return std::make_unique<PathFilter>(bank, run, options, paths, seed);
  return moment_filter(bank, run, options);
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
  validate(bank);
  check_run(bank, run);
  RunningNoiseFilter filter(bank, run, false);
  filter.predict_run(horizons, [&](const Forecast&, std::size_t h, Index k) {
    filter.forecast().whiten(run.state.col(k), out[h].whitened.col(k), out[h].log_weight.col(k));
  });
  return out;
}

}  // namespace modebank
