#include "filter/judge/horizon.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "filter/judge/sample_paths.hpp"
#include "filter/judge/statistics.hpp"
#include "filter/step/gaussian.hpp"
#include "filter/step/imm_filter.hpp"
#include "ident/base/distributions.hpp"
#include "ident/base/linalg.hpp"

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

  double observe(const Vector& y, Eigen::Ref<Eigen::VectorXd> error) override { return bank_.observe(y, error); }
  Eigen::VectorXd mode_probability() const override { return bank_.predicted_probability(); }

 private:
  ImmFilter<N, NY> bank_;

  SignalMixture signal(Index i) const override { return bank_.signal(i); }
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
  SignalMixture signal(Index i) const override {
    SignalMixture result{Eigen::VectorXd(levels()), Eigen::VectorXd::Constant(levels(), forecast_.prediction()(i)),
                         Eigen::VectorXd(levels()), noise_};
    for (Index j = 0; j < levels(); ++j) {
      result.weight(j) = weight(j);
      result.deviation(j) = std::sqrt(std::max(factor_ * covariance(j)(i, i), least_variance));
    }
    return result;
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

namespace {

/// One sample ahead by running noise, the prediction is the filter's own: its levels have different means.
void take_from_filter(const Bank& bank, const Trajectory& run, HorizonEvaluation& out) {
  const RunInstants instants(bank, run);
  DriftingFilter filter(bank);
  Eigen::VectorXd weight;
  for (Index t = 0; t < instants.count(); ++t) {
    const double log_density = follow(instants, t, run, filter);
    const Index k = instants.instants[static_cast<std::size_t>(t)].sample;
    if (k < 0 || std::isnan(out.log_density(0, k))) continue;
    filter.weigh_levels(0, weight);
    for (Index i = 0; i < out.error[0].rows(); ++i) out.pit[0](i, k) = filter.probability(i, 0.0, weight);
    out.error[0].col(k) = filter.innovation();
    out.log_density(0, k) = log_density;
  }
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
  const std::unique_ptr<ForecastingFilter> filter = forecasting_filter(bank, run, options);
  HorizonEvaluation out = empty_horizons(std::move(horizons), bank.C.rows(), run.samples());
  if (out.horizons.empty()) return out;
  filter->predict_run(out.horizons, [&](Forecast& forecast, std::size_t h, Index k) {
    const auto y = run.state.col(k);
    out.log_density(static_cast<Index>(h), k) = forecast.observe(y, out.error[h].col(k));
    for (Index i = 0; i < y.size(); ++i) out.pit[h](i, k) = forecast.probability(i, y(i));
  });
  if (!bank.running_noise.empty() && out.horizons.front() == 1) take_from_filter(bank, run, out);
  return out;
}

std::vector<HorizonSums> sum_horizons(const HorizonEvaluation& run) {
  std::vector<HorizonSums> sums;
  for (std::size_t h = 0; h < run.horizons.size(); ++h) {
    const Eigen::MatrixXd& error = run.error[h];
    HorizonSums& sum = sums.emplace_back(HorizonSums{run.horizons[h], 0, 0.0, Eigen::ArrayXd::Zero(error.rows())});
    for (Index k = 0; k < error.cols(); ++k) {
      const double value = run.log_density(static_cast<Index>(h), k);
      if (std::isnan(value)) continue;
      ++sum.samples;
      sum.log_density += value;
      sum.squared_error += error.col(k).array().square();
      sum.inside += static_cast<double>(((run.pit[h].col(k).array() - 0.5).abs() <= 0.475).count());
    }
  }
  return sums;
}

void pool(const std::vector<HorizonSums>& run, std::vector<HorizonSums>& all) {
  if (all.empty()) {
    all = run;
    return;
  }
  for (std::size_t h = 0; h < all.size(); ++h) {
    const HorizonSums& of = run.at(h);
    all[h].samples += of.samples;
    all[h].log_density += of.log_density;
    all[h].squared_error += of.squared_error;
    all[h].inside += of.inside;
  }
}

std::vector<HorizonRow> summarize_horizons(const std::string& filter, const std::vector<Trajectory>& runs,
                                           const std::vector<std::vector<HorizonSums>>& sums) {
  std::vector<HorizonRow> rows;
  const auto add_row = [&](Role role, const std::string& run, const HorizonSums& of) {
    const double N = of.samples > 0 ? static_cast<double>(of.samples) : not_a_number;
    const double inside = of.inside / (N * static_cast<double>(of.squared_error.size()));
    rows.push_back(
        {filter, role, run, of.horizon, of.samples, of.log_density / N, (of.squared_error / N).sqrt(), inside});
  };
  using Sums = std::vector<HorizonSums>;
  for (const Role role : {Role::train, Role::test})
    sum_runs<Sums>(
        runs, role, [&](std::size_t i, Sums& all) { pool(sums.at(i), all); },
        [&](const Sums& all, const std::string& run) {
          for (const HorizonSums& of : all) add_row(role, run, of);
        });
  return rows;
}

}  // namespace modebank
