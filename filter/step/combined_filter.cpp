#include "filter/step/combined_filter.hpp"

#include <cmath>
#include <utility>

#include "filter/step/equations/arithmetic.hpp"
#include "ident/base/linalg.hpp"
#include "ident/base/not_a_number.hpp"

namespace modebank {

using Eigen::Index;

namespace {

/// Normalised square of the available signals.
double normalised_square(const Eigen::VectorXd& innovation, const Eigen::MatrixXd& covariance) {
  std::vector<Index> there;
  for (Index i = 0; i < innovation.size(); ++i)
    if (!std::isnan(innovation(i))) there.push_back(i);
  if (there.empty()) return not_a_number;
  const Cholesky factor(covariance(there, there));
  return factor.definite() ? factor.whiten(Eigen::VectorXd(innovation(there))).squaredNorm() : not_a_number;
}

/// Copies the measured states of a filter's estimate.
void take_measured(const FilterEstimate& said, FilterEstimate& measured) {
  const Index n = said.innovation.size();
  measured = said;
  measured.prediction = said.prediction.head(n);
  measured.state = said.state.head(n);
  measured.covariance = said.covariance.topLeftCorner(n, n);
}

}  // namespace

Bank combined_frame(const Bank& bank) {
  const Index n = bank.C.rows();
  Bank frame = bank;
  frame.structure = {n, bank.structure.inputs, bank.structure.intercept};
  frame.state_names.resize(static_cast<std::size_t>(n));
  frame.input_names.resize(static_cast<std::size_t>(bank.structure.inputs));
  frame.C = Eigen::MatrixXd::Identity(n, n);
  frame.drift = {};
  frame.transition_logit = {};
  const Index p = frame.structure.parameters();
  for (Mode& mode : frame.modes)
    mode = {unpack(frame.structure, Eigen::VectorXd(Eigen::VectorXd::Zero(p))), mode.Q.topLeftCorner(n, n).eval(),
            Eigen::MatrixXd::Zero(p, p), Eigen::VectorXd::Zero(p), mode.weight};
  return frame;
}

CombinedFilter::CombinedFilter(std::vector<std::unique_ptr<AnyFilter>> filters, const std::vector<double>& start)
    : filters_(std::move(filters)),
      weights_(start, 1),
      remembered_(weights_),
      said_(filters_.size()),
      log_densities_(filters_.size()) {}

const FilterEstimate& CombinedFilter::step(double time_s, const Eigen::Ref<const Eigen::VectorXd>& input,
                                           const Eigen::Ref<const Eigen::VectorXd>& measurement) {
  for (std::size_t i = 0; i < filters_.size(); ++i) {
    said_[i] = &filters_[i]->step(time_s, input, measurement);
    log_densities_[i] = said_[i]->log_density;
  }
  if (said_.front()->steps == 0) weights_.restart();
  combine();
  weights_.observe(log_densities_);
  return estimate_;
}

/// Combines the filters with their weights before this sample. If the first filter has no score, its estimate is used
/// alone.
void CombinedFilter::combine() {
  take_measured(*said_.front(), estimate_);  // modes, steps and fields of a single filter
  if (std::isnan(estimate_.log_density)) return;
  estimate_.log_density = filter::ForecastWeights::mixed_log_density(weights_.weights(), log_densities_);
  mix(filter::ForecastWeights::spoken_weights(weights_.weights(), log_densities_), estimate_);
}

void CombinedFilter::mix(const std::vector<double>& share, FilterEstimate& mixed) const {
  const Index n = mixed.innovation.size();
  for (auto* vector : {&mixed.prediction, &mixed.innovation, &mixed.state, &mixed.pit, &mixed.pit_width})
    vector->setZero();
  for (auto* matrix : {&mixed.innovation_covariance, &mixed.covariance}) matrix->setZero();
  const auto each = [&](auto add) {
    for (std::size_t i = 0; i < share.size(); ++i)
      if (share[i] > 0.0) add(share[i], *said_[i]);
  };
  each([&](double weight, const FilterEstimate& said) {
    mixed.prediction += weight * said.prediction.head(n);
    mixed.innovation += weight * said.innovation;
    mixed.state += weight * said.state.head(n);
    mixed.pit += weight * said.pit;
    mixed.pit_width += weight * said.pit_width;
  });
  each([&](double weight, const FilterEstimate& said) {
    const Eigen::VectorXd apart = (said.innovation - mixed.innovation)
                                      .array()
                                      .isNaN()
                                      .select(Eigen::VectorXd::Zero(n), said.innovation - mixed.innovation);
    small::add_about_mean(mixed.innovation_covariance, weight, said.innovation_covariance, apart);
    small::add_about_mean(mixed.covariance, weight, said.covariance.topLeftCorner(n, n),
                          said.state.head(n) - mixed.state);
  });
  mixed.nis = normalised_square(mixed.innovation, mixed.innovation_covariance);
}

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

}  // namespace modebank
