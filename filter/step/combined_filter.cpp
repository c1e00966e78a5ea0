#include "filter/step/combined_filter.hpp"

#include <utility>

#include "filter/step/gaussian.hpp"

namespace modebank {

using Eigen::Index;

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

namespace {

/// Mean and covariance of the mixture of part(0), part(1), ..., each a mean and a covariance.
template <class Part>
void merge(const std::vector<double>& shares, Part part, Eigen::VectorXd& mean, Eigen::MatrixXd& covariance) {
  mean.setZero(part(0).first.size());
  covariance.setZero(mean.size(), mean.size());
  for (std::size_t i = 0; i < shares.size(); ++i)
    if (shares[i] != 0.0) mean += shares[i] * part(i).first;
  for (std::size_t i = 0; i < shares.size(); ++i)
    if (shares[i] != 0.0) small::add_about_mean(covariance, shares[i], part(i).second, part(i).first - mean);
}

}  // namespace

CombinedFilter::CombinedFilter(std::vector<BankFilter> filters, const std::vector<double>& start)
    : filters_(std::move(filters)),
      combines_(true),
      weights_(start, 1),
      log_densities_(filters_.size()),
      shares_(filters_.size()),
      estimate_(filters_.front().estimate()),
      innovation_(estimate_.innovation.size()) {
  const Index n = estimate_.innovation.size();
  estimate_.prediction.conservativeResize(n);
  estimate_.state.conservativeResize(n);
  estimate_.covariance.conservativeResize(n, n);
}

CombinedFilter::CombinedFilter(BankFilter alone) : combines_(false), weights_(1), innovation_(0) {
  filters_.push_back(std::move(alone));
}

const FilterEstimate& CombinedFilter::step(double time_s, const Eigen::Ref<const Eigen::VectorXd>& input,
                                           const Eigen::Ref<const Eigen::VectorXd>& measurement) {
  if (!combines_) return filters_.front().step(time_s, input, measurement);
  for (std::size_t i = 0; i < filters_.size(); ++i)
    log_densities_[i] = filters_[i].step(time_s, input, measurement).log_density;
  take_measured(filters_.front().estimate(), estimate_);  // as it is where this filter starts
  if (estimate_.steps == 0)
    weights_.restart();
  else
    mix(measurement);
  weights_.observe(log_densities_);
  return estimate_;
}

/// Combines the filters with their weights before this sample.
void CombinedFilter::mix(const Eigen::Ref<const Eigen::VectorXd>& measurement) {
  FilterEstimate& mixed = estimate_;
  const Index n = mixed.innovation.size();
  const auto said = [&](std::size_t i) -> const FilterEstimate& { return filters_[i].estimate(); };
  mixed.log_density = filter::ForecastWeights::mixed_log_density(weights_.weights(), log_densities_);
  double spoken = 0.0;  // weight of the filters that have started and did not fail
  for (std::size_t i = 0; i < shares_.size(); ++i)
    spoken += shares_[i] = said(i).prediction.allFinite() ? weights_.weights()[i] : 0.0;
  for (double& share : shares_) share /= spoken;
  for (Eigen::VectorXd FilterEstimate::*transform : {&FilterEstimate::pit, &FilterEstimate::pit_width}) {
    (mixed.*transform).setZero();
    for (std::size_t i = 0; i < shares_.size(); ++i)
      if (shares_[i] != 0.0) mixed.*transform += shares_[i] * (said(i).*transform);
  }
  merge(
      shares_, [&](std::size_t i) { return std::pair(said(i).state.head(n), said(i).covariance.topLeftCorner(n, n)); },
      mixed.state, mixed.covariance);
  merge(
      shares_,
      [&](std::size_t i) {
        return std::pair(said(i).prediction.head(n), said(i).innovation_covariance.topLeftCorner(n, n));
      },
      mixed.prediction, mixed.innovation_covariance);
  innovation_.observe(mixed.prediction, measurement, mixed);
}

CombinedFilter::Snapshot CombinedFilter::snapshot() const {
  Snapshot snapshot{{}, weights_};
  for (const BankFilter& filter : filters_) snapshot.filters.push_back(filter.snapshot());
  return snapshot;
}

void CombinedFilter::restore(const Snapshot& snapshot) {
  for (std::size_t i = 0; i < filters_.size(); ++i) filters_[i].restore(snapshot.filters[i]);
  weights_ = snapshot.weights;
}

void CombinedFilter::restart() {
  for (BankFilter& filter : filters_) filter.restart();
  weights_.restart();
}

}  // namespace modebank
