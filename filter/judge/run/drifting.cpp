#include "filter/judge/run/drifting.hpp"

#include <cmath>
#include <utility>

#include "filter/step/equations/bounds.hpp"
#include "filter/step/feed/run_samples.hpp"
#include "filter/step/forecast.hpp"
#include "ident/base/linalg.hpp"
#include "ident/base/not_a_number.hpp"

namespace modebank {

namespace {

using Eigen::Index;

/// Errors divided by their standard deviations and decorrelated in order, with the log determinant of this map.
struct WhitenedError {
  Eigen::VectorXd error;
  double log_scale = 0.0;
};

WhitenedError whiten(const Eigen::VectorXd& error, const Eigen::MatrixXd& covariance) {
  const Cholesky factor(covariance);
  if (factor.definite()) return {factor.whiten(error), factor.L().diagonal().array().log().sum()};
  // a variance below the limit can only come from rounding
  const Eigen::ArrayXd deviation = covariance.diagonal().array().max(least_variance).sqrt();
  return {error.array() / deviation, deviation.log().sum()};
}

double log_density(const StudentNoise& noise, const Eigen::Ref<const Eigen::VectorXd>& whitened) {
  double sum = 0.0;
  for (const double u : whitened) sum += noise.log_density(u * u);
  return sum;
}

}  // namespace

double log_density(const StudentNoise& noise, const Eigen::VectorXd& error, const Eigen::MatrixXd& covariance) {
  const WhitenedError white = whiten(error, covariance);
  return log_density(noise, white.error) - white.log_scale;
}

namespace {

/// Predicts ahead from the filter's state at one moment of a run.
class DriftingLookAhead {
 public:
  DriftingLookAhead(const Bank& bank, const RunInstants& instants, const Trajectory& run, DriftingForecasts& out)
      : instants_(instants), run_(run), out_(out), running_(bank.running_noise), noise_(running_.nu), forecast_(bank) {}

  void from(Index t, const DriftingRecursion& origin) {
    forecast_.start(origin.z(), origin.save());
    look_ahead(forecast_, instants_, t, out_.predictions.horizons,
               [&](std::size_t horizon, Index k) { score(horizon, k); });
  }

 private:
  const RunInstants& instants_;
  const Trajectory& run_;
  DriftingForecasts& out_;
  RunningNoise running_;
  StudentNoise noise_;
  DriftingForecast forecast_;

  void score(std::size_t horizon, Index k) {
    const auto y = run_.state.col(k);
    if (missing_entries(y) > 0) return;
    const Eigen::VectorXd error = y - forecast_.prediction();
    const WhitenedError white = whiten(error, forecast_.covariance());
    const double factor = running_.factor_at(out_.predictions.horizons[horizon]);
    const Eigen::ArrayXd deviation = (factor * forecast_.covariance().diagonal().array()).max(least_variance).sqrt();
    for (Index i = 0; i < error.size(); ++i)
      out_.predictions.pit[horizon](i, k) = noise_.probability(error(i) / deviation(i));
    out_.predictions.error[horizon].col(k) = error;
    out_.whitened[horizon].col(k) = white.error;
    out_.predictions.log_density(static_cast<Index>(horizon), k) = log_density(noise_, white.error) - white.log_scale;
  }
};

}  // namespace

void follow(const RunInstants& instants, Index t, const Trajectory& run, DriftingRecursion& recursion) {
  const Instant& instant = instants.instants[static_cast<std::size_t>(t)];
  if (instant.starts) return recursion.start(instant.start);
  recursion.predict(instants.inputs.col(t));
  if (instant.sample < 0) return recursion.skip();
  recursion.update(run.state.col(instant.sample));
}

DriftingForecasts drifting_forecasts(const Bank& bank, const Trajectory& run, std::vector<Index> horizons) {
  validate(bank);
  check_run(bank, run);
  DriftingForecasts out{empty_horizons(std::move(horizons), bank.C.rows(), run.samples()), {}};
  out.whitened = out.predictions.error;
  const RunInstants instants(bank, run);
  DriftingRecursion recursion(bank);
  DriftingLookAhead look(bank, instants, run, out);
  for (Index t = 0; t < instants.count(); ++t) {
    follow(instants, t, run, recursion);
    if (instants.instants[static_cast<std::size_t>(t)].sample >= 0) look.from(t, recursion);
  }
  return out;
}

double widening_gain(const StudentNoise& noise, const Eigen::Ref<const Eigen::VectorXd>& whitened, double factor) {
  double gain = -0.5 * static_cast<double>(whitened.size()) * std::log(factor);
  for (const double u : whitened) gain += noise.log_density(u * u / factor) - noise.log_density(u * u);
  return gain;
}

HorizonEvaluation drifting_horizons(const Bank& bank, const Trajectory& run, std::vector<Index> horizons) {
  DriftingForecasts forecasts = drifting_forecasts(bank, run, std::move(horizons));
  HorizonEvaluation& out = forecasts.predictions;
  const StudentNoise noise(bank.running_noise.nu);
  for (std::size_t h = 0; h < out.horizons.size(); ++h) {
    const double factor = bank.running_noise.factor_at(out.horizons[h]);
    if (factor == 1.0) continue;
    for (Index k = 0; k < run.samples(); ++k)
      if (double& value = out.log_density(static_cast<Index>(h), k); !std::isnan(value))
        value += widening_gain(noise, forecasts.whitened[h].col(k), factor);
  }
  return std::move(out);
}

}  // namespace modebank
