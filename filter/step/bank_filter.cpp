#include "filter/step/bank_filter.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "filter/step/equations/predicted_mixture.hpp"
#include "filter/step/filter_shell.hpp"
#include "filter/step/stepper.hpp"
#include "ident/base/covariance.hpp"

namespace modebank {

using Eigen::Index;
using Vector = Eigen::Ref<const Eigen::VectorXd>;

namespace {

const Bank& validated(const Bank& bank) {
  validate(bank);
  return bank;
}

/// Throws std::invalid_argument if the memory does not fit a filter of n states and K modes.
void check_memory(const FilterMemory& memory, Index n, Index K) {
  if (memory.means.rows() != n || memory.means.cols() != K || memory.covariances.rows() != n * n ||
      memory.covariances.cols() != K || memory.mode_probability.size() != K)
    throw std::invalid_argument("the snapshot does not fit a filter of " + std::to_string(K) + " modes and " +
                                std::to_string(n) + " states");
  const auto is_positive = [](double value) { return value > 0.0 && std::isfinite(value); };
  if (!memory.means.allFinite() || !memory.covariances.allFinite() || !memory.mode_probability.allFinite() ||
      memory.mode_probability.minCoeff() < 0.0 || !is_positive(memory.mode_probability.sum()))
    throw std::invalid_argument("the snapshot has a number that is not finite or out of range");
  for (Index k = 0; k < K; ++k)
    if (!is_covariance(memory.covariances.col(k).reshaped(n, n)))
      throw std::invalid_argument("the snapshot has a matrix that is not a covariance");
}

/// The same check for drifting coefficients. `own`: state of this filter.
void check_memory(const DriftState& drift, const DriftState& own) {
  const auto same = [](const std::vector<Eigen::MatrixXd>& a, const std::vector<Eigen::MatrixXd>& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const Eigen::MatrixXd& x, const Eigen::MatrixXd& y) {
      return x.rows() == y.rows() && x.cols() == y.cols();
    });
  };
  if (drift.theta.rows() != own.theta.rows() || drift.theta.cols() != own.theta.cols() || !same(drift.P, own.P) ||
      drift.variance.size() != own.variance.size() || drift.level.size() != own.level.size())
    throw std::invalid_argument("the snapshot is from a filter with other drifting coefficients");
  const auto variances = [](const Eigen::MatrixXd& P) { return P.allFinite() && (P.diagonal().array() >= 0.0).all(); };
  if (!drift.theta.allFinite() || !std::all_of(drift.P.begin(), drift.P.end(), variances) ||
      !drift.variance.allFinite() || (drift.variance.array() <= 0.0).any() || !drift.level.allFinite() ||
      (drift.level.array() < 0.0).any() || (drift.level.size() > 0 && drift.level.sum() <= 0.0))
    throw std::invalid_argument("the snapshot has drift values that are not finite or out of range");
}

}  // namespace

struct BankFilter::Parts : FilterShell {
  std::unique_ptr<Stepper> stepper;
  Eigen::MatrixXd C;
  CombinedInnovation combined;

  Parts(const Bank& bank, const FilterOptions& options)
      : FilterShell(bank), stepper(make_stepper(bank, options)), C(bank.C), combined(C.rows()) {}

  void start() {
    stepper->start(feed.start());
    estimate.mode_probability_predicted = stepper->mode_probability();
    record_posterior();
  }

  void step(const Vector& measurement) {
    stepper->advance(feed.inputs(), feed.steps());
    stepper->combine(estimate.prediction, estimate.innovation_covariance);
    estimate.mode_probability_predicted = stepper->predicted_probability();
    estimate.steps = feed.steps();
    estimate.log_density = stepper->update(measurement);
    if (std::isnan(estimate.log_density))
      clear_scores();
    else
      record_scores(measurement);
    record_posterior();
  }

 private:
  void record_scores(const Vector& measurement) {
    combined.observe(C, estimate.prediction, estimate.innovation_covariance, measurement);
    estimate.innovation = combined.innovation;
    estimate.nis = combined.nis;
    const double of_intervals = stepper->transform(measurement, estimate.pit, estimate.pit_width);
    if (!std::isnan(of_intervals)) estimate.log_density = of_intervals;
  }

  void record_posterior() {
    stepper->merge(estimate.state, estimate.covariance);
    estimate.mode_probability = stepper->mode_probability();
  }
};

BankFilter::BankFilter(const Bank& bank, const FilterOptions& options)
    : parts_(std::make_unique<Parts>(validated(bank), options)) {}

BankFilter::~BankFilter() = default;
BankFilter::BankFilter(BankFilter&&) noexcept = default;
BankFilter& BankFilter::operator=(BankFilter&&) noexcept = default;

const FilterEstimate& BankFilter::step(double time_s, const Vector& input, const Vector& measurement) {
  return take_sample(*parts_, time_s, input, measurement);
}

const FilterEstimate& BankFilter::estimate() const { return parts_->estimate; }
bool BankFilter::started() const { return parts_->started; }

void BankFilter::restart() { parts_->restart(); }

FilterSnapshot BankFilter::snapshot() const {
  FilterSnapshot snapshot;
  parts_->stepper->save(snapshot);
  snapshot.started = parts_->started;
  snapshot.samples = parts_->feed.memory();
  return snapshot;
}

void BankFilter::restore(const FilterSnapshot& snapshot) {
  check_memory(snapshot, parts_->estimate.state.size(), parts_->initial_probability.size());
  FilterMemory own;
  parts_->stepper->save(own);
  check_memory(snapshot.drift, own.drift);
  parts_->feed.restore(snapshot.samples);  // throws before any change, like the check above
  parts_->stepper->restore(snapshot);
  parts_->started = snapshot.started;
}

}  // namespace modebank
