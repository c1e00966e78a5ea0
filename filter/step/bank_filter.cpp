#include "filter/step/bank_filter.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "filter/step/equations/predicted_mixture.hpp"
#include "filter/step/stepper.hpp"
#include "ident/base/covariance.hpp"
#include "ident/base/not_a_number.hpp"

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

/// Decides whether the filter starts at a sample, makes a step, or waits, and clears old values of the estimate.
struct BankFilter::Parts {
  FilterEstimate estimate;
  bool started = false;
  SampleFeed feed;
  Eigen::VectorXd initial_probability;
  std::unique_ptr<Stepper> stepper;
  Eigen::MatrixXd C;
  CombinedInnovation combined;

  Parts(const Bank& bank, const FilterOptions& options)
      : feed(bank),
        initial_probability(bank.initial_probability),
        stepper(make_stepper(bank, options)),
        C(bank.C),
        combined(C.rows()) {
    const Index n = bank.structure.dimension(), n_y = bank.C.rows();
    estimate.prediction.resize(n);
    estimate.innovation.resize(n_y);
    estimate.innovation_covariance.resize(n_y, n_y);
    estimate.state.resize(n);
    estimate.covariance.resize(n, n);
    estimate.pit.resize(n_y);
    estimate.pit_width.setZero(n_y);
    wait();
  }

  void take(double time_s, const Vector& input, const Vector& measurement) {
    feed.push(time_s, input, measurement);
    if (started && feed.steps() > longest_gap_steps) started = false;
    if (started) {
      step(measurement);
    } else if (feed.can_start()) {
      start();
      started = true;
    } else {
      wait();
    }
  }

 private:
  void start() {
    clear_prediction();
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

  void record_scores(const Vector& measurement) {
    combined.observe(C, estimate.prediction, estimate.innovation_covariance, measurement);
    estimate.innovation = combined.innovation;
    estimate.nis = combined.nis;
    stepper->transform(measurement, estimate.pit, estimate.pit_width, estimate.log_density);
  }

  void record_posterior() {
    stepper->merge(estimate.state, estimate.covariance);
    estimate.mode_probability = stepper->mode_probability();
  }

  /// No prediction was made for this sample.
  void clear_prediction() {
    estimate.prediction.setConstant(not_a_number);
    estimate.innovation_covariance.setConstant(not_a_number);
    estimate.steps = 0;
    clear_scores();
  }

  void clear_scores() {
    estimate.innovation.setConstant(not_a_number);
    estimate.pit.setConstant(not_a_number);
    estimate.pit_width.setZero();
    estimate.nis = estimate.log_density = not_a_number;
  }

  /// Clears all values before a start.
  void wait() {
    clear_prediction();
    estimate.state.setConstant(not_a_number);
    estimate.covariance.setConstant(not_a_number);
    estimate.mode_probability_predicted = initial_probability;
    estimate.mode_probability = initial_probability;
  }
};

BankFilter::BankFilter(const Bank& bank, const FilterOptions& options)
    : parts_(std::make_unique<Parts>(validated(bank), options)) {}

BankFilter::~BankFilter() = default;
BankFilter::BankFilter(BankFilter&&) noexcept = default;
BankFilter& BankFilter::operator=(BankFilter&&) noexcept = default;

const FilterEstimate& BankFilter::step(double time_s, const Vector& input, const Vector& measurement) {
  parts_->take(time_s, input, measurement);
  return parts_->estimate;
}

const FilterEstimate& BankFilter::estimate() const { return parts_->estimate; }
bool BankFilter::started() const { return parts_->started; }

void BankFilter::restart() {
  parts_->started = false;
  parts_->feed.clear();
}

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
