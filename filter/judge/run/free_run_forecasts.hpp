#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <numeric>
#include <vector>

#include "filter/judge/run/drifting.hpp"
#include "filter/judge/run/forecast.hpp"
#include "filter/judge/run/sample_paths.hpp"
#include "filter/step/drifting_forecast.hpp"
#include "filter/step/drifting_recursion.hpp"
#include "filter/step/forecast.hpp"
#include "filter/step/student_noise.hpp"
#include "ident/base/distributions.hpp"

/// Forecasts of each kind of model for free runs.
namespace modebank {

/// Forecast of a bank by the moments of its modes.
template <int N, int NY>
class MomentForecast final : public Forecast {
 public:
  using Vector = Eigen::Ref<const Eigen::VectorXd>;

  explicit MomentForecast(const FilterModel<N, NY>& model) : bank_(model), signals_(model.C.rows()) {}
  void start(const FilterState<N>& origin) { bank_.start(origin); }
  void step(const Vector& inputs) override { bank_.step(inputs); }

  void arrive(Eigen::Index) override {
    for (Eigen::Index i = 0; i < std::ssize(signals_); ++i) signals_[static_cast<std::size_t>(i)] = bank_.signal(i);
  }

  Eigen::VectorXd mean() const override {
    Eigen::VectorXd result(std::ssize(signals_));
    for (Eigen::Index i = 0; i < result.size(); ++i) result(i) = of(i).weight.dot(of(i).mean);
    return result;
  }
  Eigen::VectorXd standard_deviation() const override {
    Eigen::VectorXd result = mean();
    for (Eigen::Index i = 0; i < result.size(); ++i) {
      const auto variance = of(i).deviation.array().square() + (of(i).mean.array() - result(i)).square();
      result(i) = std::sqrt((of(i).weight.array() * variance).sum());
    }
    return result;
  }
  double probability(Eigen::Index i, double y) const override { return of(i).probability(y); }
  double quantile(Eigen::Index i, double p) const override { return of(i).quantile(p, normal_quantile(p)); }
  double log_density(const Vector& y) override {
    Eigen::VectorXd error(y.size());
    return bank_.observe(y, error);
  }
  Eigen::VectorXd mode_probability() const override { return bank_.predicted().predicted_probability; }

 private:
  BankForecast<N, NY> bank_;
  std::vector<NormalMixture> signals_;  ///< n_y, mixtures for the present sample

  const NormalMixture& of(Eigen::Index i) const { return signals_[static_cast<std::size_t>(i)]; }
};

/// Forecast of a bank by sample paths. Bands are quantiles of the paths with measurement noise. The joint density has
/// one Gaussian per mode, with the moments of the mode's paths. The noise of the last step is not sampled; its known
/// covariance is added.
class PathForecast final : public Forecast {
 public:
  using Vector = Eigen::Ref<const Eigen::VectorXd>;

  /// `row`: as in SamplePaths.
  PathForecast(const Bank& bank, Eigen::Index paths, std::uint64_t seed, TransitionRow row = {});
  void start(const FilterMemory& origin) { paths_.start(origin); }
  void step(const Vector& inputs) override { paths_.step(inputs); }
  void arrive(Eigen::Index) override;
  Eigen::Index lost() const { return paths_.lost(); }

  Eigen::VectorXd mean() const override;
  Eigen::VectorXd standard_deviation() const override;
  double probability(Eigen::Index i, double y) const override;
  double quantile(Eigen::Index i, double p) const override;
  double log_density(const Vector& y) override;
  Eigen::VectorXd mode_probability() const override { return share_; }

 private:
  Eigen::MatrixXd C_, R_, R_root_;
  Eigen::VectorXd quantum_;  ///< n_y; empty if no signal is rounded
  SamplePaths paths_;
  Eigen::MatrixXd sorted_;  ///< count x n_y, of the present sample
  Eigen::VectorXd share_;   ///< K

  double log_density_of_mode(Eigen::VectorXd error, const Eigen::MatrixXd& S) const;
};

/// Forecast of a bank with running noise.
class DriftingFreeForecast final : public Forecast {
 public:
  using Vector = Eigen::Ref<const Eigen::VectorXd>;

  explicit DriftingFreeForecast(const Bank& bank)
      : running_(bank.running_noise), noise_(running_.nu), forecast_(bank) {}
  void start(const DriftingRecursion& origin) { forecast_.start(origin.z(), origin.save()); }
  void step(const Vector& inputs) override { forecast_.step(inputs); }
  void arrive(Eigen::Index samples) override { covariance_ = running_.factor_at(samples) * forecast_.covariance(); }

  Eigen::VectorXd mean() const override { return forecast_.prediction(); }
  Eigen::VectorXd standard_deviation() const override {
    return covariance_.diagonal().array().max(least_variance).sqrt();
  }
  double probability(Eigen::Index i, double y) const override {
    return noise_.probability((y - forecast_.prediction()(i)) / standard_deviation()(i));
  }
  double quantile(Eigen::Index i, double p) const override {
    const double nu = running_.nu,
                 units = nu == 0.0 ? normal_quantile(p) : student_quantile(p, nu) * std::sqrt((nu - 2.0) / nu);
    return forecast_.prediction()(i) + units * standard_deviation()(i);
  }
  double log_density(const Vector& y) override {
    return modebank::log_density(noise_, y - forecast_.prediction(), covariance_);
  }
  Eigen::VectorXd mode_probability() const override { return Eigen::VectorXd::Ones(1); }

 private:
  RunningNoise running_;
  StudentNoise noise_;
  DriftingForecast forecast_;
  Eigen::MatrixXd covariance_;
};

}  // namespace modebank
