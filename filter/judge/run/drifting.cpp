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

double log_density(const StudentNoise& noise, const Eigen::Ref<const Eigen::VectorXd>& whitened, double factor) {
  double sum = -0.5 * static_cast<double>(whitened.size()) * std::log(factor);
  for (const double u : whitened) sum += noise.log_density(u * u / factor);
  return sum;
}

/// Log density of a mixture of the levels. `whitened`, `log_weight`: a column of DriftingForecasts.
double log_density(const StudentNoise& noise, const Eigen::Ref<const Eigen::VectorXd>& whitened,
                   const Eigen::Ref<const Eigen::VectorXd>& log_weight, double factor) {
  const Index n = whitened.size() / log_weight.size();
  Eigen::VectorXd each = log_weight;
  for (Index j = 0; j < each.size(); ++j) each(j) += log_density(noise, whitened.segment(j * n, n), factor);
  const double highest = each.maxCoeff();
  return highest + std::log((each.array() - highest).exp().sum());
}

}  // namespace

double log_density(const StudentNoise& noise, const Eigen::VectorXd& error, const Eigen::MatrixXd& covariance) {
  const WhitenedError white = whiten(error, covariance);
  return log_density(noise, white.error, 1.0) - white.log_scale;
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
    const Eigen::VectorXd error = y - forecast_.prediction(), &level = forecast_.level_probability();
    const double factor = running_.factor_at(out_.predictions.horizons[horizon]);
    const Index n = error.size();
    Eigen::VectorXd pit = Eigen::VectorXd::Zero(n);
    for (Index j = 0; j < level.size(); ++j) {
      const Eigen::MatrixXd covariance = forecast_.covariance(j);
      const WhitenedError white = whiten(error, covariance);
      out_.whitened[horizon].col(k).segment(j * n, n) = white.error;
      out_.log_weight[horizon](j, k) = std::log(level(j)) - white.log_scale;
      const Eigen::ArrayXd deviation = (factor * covariance.diagonal().array()).max(least_variance).sqrt();
      for (Index i = 0; i < n; ++i) pit(i) += level(j) * noise_.probability(error(i) / deviation(i));
    }
    out_.predictions.pit[horizon].col(k) = pit.array().isNaN().select(1.0, pit);  // a failed prediction
    out_.predictions.error[horizon].col(k) = error;
    out_.predictions.log_density(static_cast<Index>(horizon), k) =
        measured_density(log_density(noise_, out_.whitened[horizon].col(k), out_.log_weight[horizon].col(k), 1.0));
  }
};

}  // namespace

double follow(const RunInstants& instants, Index t, const Trajectory& run, DriftingRecursion& recursion) {
  const Instant& instant = instants.instants[static_cast<std::size_t>(t)];
  if (instant.starts) {
    recursion.start(instant.start);
    return not_a_number;
  }
  recursion.predict(instants.inputs.col(t));
  if (instant.sample >= 0) return recursion.update(run.state.col(instant.sample));
  recursion.skip();
  return not_a_number;
}

namespace {

/// One sample ahead the prediction is the filter's own: its levels have different means.
void take_from_filter(const DriftingRecursion& recursion, Index k, double log_density, HorizonEvaluation& out) {
  if (out.horizons.empty() || out.horizons.front() != 1 || std::isnan(out.log_density(0, k))) return;
  Eigen::VectorXd weight;
  recursion.weigh_levels(0, weight);
  for (Index i = 0; i < out.error[0].rows(); ++i) out.pit[0](i, k) = recursion.probability(i, 0.0, weight);
  out.error[0].col(k) = recursion.innovation();
  out.log_density(0, k) = log_density;
}

}  // namespace

DriftingForecasts drifting_forecasts(const Bank& bank, const Trajectory& run, std::vector<Index> horizons) {
  validate(bank);
  check_run(bank, run);
  const Index n = bank.C.rows(), levels = bank.running_noise.levels();
  DriftingForecasts out{empty_horizons(std::move(horizons), n, run.samples()), {}, {}};
  out.whitened.assign(out.predictions.horizons.size(),
                      Eigen::MatrixXd::Constant(levels * n, run.samples(), not_a_number));
  out.log_weight.assign(out.predictions.horizons.size(),
                        Eigen::MatrixXd::Constant(levels, run.samples(), not_a_number));
  const RunInstants instants(bank, run);
  DriftingRecursion recursion(bank);
  DriftingLookAhead look(bank, instants, run, out);
  for (Index t = 0; t < instants.count(); ++t) {
    const double log_density = follow(instants, t, run, recursion);
    const Index sample = instants.instants[static_cast<std::size_t>(t)].sample;
    if (sample < 0) continue;
    take_from_filter(recursion, sample, log_density, out.predictions);
    look.from(t, recursion);
  }
  return out;
}

double widening_gain(const StudentNoise& noise, const DriftingForecasts& forecasts, std::size_t horizon, Index k,
                     double factor) {
  const auto whitened = forecasts.whitened[horizon].col(k), log_weight = forecasts.log_weight[horizon].col(k);
  return log_density(noise, whitened, log_weight, factor) - log_density(noise, whitened, log_weight, 1.0);
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
        value += widening_gain(noise, forecasts, h, k, factor);
  }
  return std::move(out);
}

}  // namespace modebank
