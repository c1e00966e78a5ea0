#include "app/cli/combined_filter.hpp"

#include <cmath>
#include <utility>

#include "ident/base/linalg.hpp"
#include "ident/base/not_a_number.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app {

using Eigen::Index;

namespace {

/// Adds a part of a mixture: its weight times its covariance and the square of its mean's distance from the mixture's.
void add_spread(double weight, const Eigen::MatrixXd& covariance, const Eigen::VectorXd& distance,
                Eigen::MatrixXd& mixed) {
  mixed += weight * (covariance + distance * distance.transpose());
}

/// Of the signals that are there.
double normalised_square(const Eigen::VectorXd& innovation, const Eigen::MatrixXd& covariance) {
  std::vector<Index> there;
  for (Index i = 0; i < innovation.size(); ++i)
    if (!std::isnan(innovation(i))) there.push_back(i);
  if (there.empty()) return not_a_number;
  const Cholesky factor(covariance(there, there));
  return factor.definite() ? factor.whiten(Eigen::VectorXd(innovation(there))).squaredNorm() : not_a_number;
}

}  // namespace

CombinedFilter::CombinedFilter(std::vector<std::unique_ptr<LiveFilter>> filters, const std::vector<double>& start)
    : filters_(std::move(filters)),
      weights_(start, 1),
      remembered_(weights_),
      said_(filters_.size()),
      log_densities_(filters_.size()) {}

const FilterEstimate& CombinedFilter::step(double time_s, const Eigen::VectorXd& input,
                                           const Eigen::VectorXd& measurement) {
  for (std::size_t i = 0; i < filters_.size(); ++i) {
    said_[i] = &filters_[i]->step(time_s, input, measurement);
    log_densities_[i] = said_[i]->log_density;
  }
  if (said_.front()->steps == 0) weights_.restart();
  combine();
  weights_.observe(log_densities_);
  return estimate_;
}

/// With the weights from before this sample.
void CombinedFilter::combine() {
  estimate_ = *said_.front();  // modes, steps, and what one filter has alone
  estimate_.log_density = filter::ForecastWeights::mixed_log_density(weights_.weights(), log_densities_);
  if (std::isnan(estimate_.log_density)) return;
  mix(filter::ForecastWeights::spoken_weights(weights_.weights(), log_densities_), estimate_);
}

FilterEstimate CombinedFilter::forecast(double time_s, const Eigen::VectorXd& input) {
  std::vector<FilterEstimate> ahead;
  std::vector<double> known;
  for (const auto& filter : filters_) {
    FilterEstimate& one = ahead.emplace_back(filter->forecast(time_s, input));
    one.innovation = -one.prediction.head(one.innovation.size());  // of a measurement of zero: how far they lie apart
    known.push_back(one.prediction.array().isNaN().any() ? not_a_number : 0.0);
  }
  for (std::size_t i = 0; i < ahead.size(); ++i) said_[i] = &ahead[i];
  FilterEstimate mixed = ahead.front();
  mix(filter::ForecastWeights::spoken_weights(weights_.weights(), known), mixed);
  mixed.innovation.setConstant(not_a_number);
  mixed.nis = not_a_number;
  return mixed;
}

void CombinedFilter::mix(const std::vector<double>& share, FilterEstimate& mixed) const {
  for (auto* vector : {&mixed.prediction, &mixed.innovation, &mixed.state, &mixed.pit}) vector->setZero();
  for (auto* matrix : {&mixed.innovation_covariance, &mixed.covariance}) matrix->setZero();
  const auto each = [&](auto add) {
    for (std::size_t i = 0; i < share.size(); ++i)
      if (share[i] > 0.0) add(share[i], *said_[i]);
  };
  each([&](double weight, const FilterEstimate& said) {
    mixed.prediction += weight * said.prediction;
    mixed.innovation += weight * said.innovation;
    mixed.state += weight * said.state;
    mixed.pit += weight * said.pit;
  });
  each([&](double weight, const FilterEstimate& said) {
    const Eigen::VectorXd apart =
        (said.innovation - mixed.innovation)
            .array()
            .isNaN()
            .select(Eigen::VectorXd::Zero(mixed.innovation.size()), said.innovation - mixed.innovation);
    add_spread(weight, said.innovation_covariance, apart, mixed.innovation_covariance);
    add_spread(weight, said.covariance, said.state - mixed.state, mixed.covariance);
  });
  mixed.nis = normalised_square(mixed.innovation, mixed.innovation_covariance);
}

bool CombinedFilter::started() const { return filters_.front()->started(); }

void CombinedFilter::restart() {
  for (const auto& filter : filters_) filter->restart();
  weights_.restart();
}

void CombinedFilter::remember() {
  for (const auto& filter : filters_) filter->remember();
  remembered_ = weights_;
}

void CombinedFilter::go_back() {
  for (const auto& filter : filters_) filter->go_back();
  weights_ = remembered_;
}

void CombinedFilter::refuse() {
  throw ConfigurationError(
      "track.checkpoint and track.resume: what several filters together remember is not written; leave them out, or "
      "track one filter");
}

}  // namespace modebank::app
