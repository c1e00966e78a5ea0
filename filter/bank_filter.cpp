#include "filter/bank_filter.hpp"

#include <stdexcept>
#include <string>

#include "filter/combined.hpp"
#include "filter/filter_step.hpp"
#include "filter/run_samples.hpp"
#include "filter/vector_imm.hpp"
#include "ident/not_a_number.hpp"

namespace modebank {

using Eigen::Index;
using Vector = Eigen::Ref<const Eigen::VectorXd>;

namespace {

FilterEstimate empty_estimate(const Bank& bank) {
  const Index n = bank.structure.dimension(), n_y = bank.C.rows(), K = bank.mode_count();
  FilterEstimate e;
  e.prediction.setConstant(n, not_a_number);
  e.innovation.setConstant(n_y, not_a_number);
  e.innovation_covariance.setConstant(n_y, n_y, not_a_number);
  e.state.setConstant(n, not_a_number);
  e.covariance.setConstant(n, n, not_a_number);
  e.pit.setConstant(n_y, not_a_number);
  e.mode_probability_predicted.setZero(K);
  e.mode_probability.setZero(K);
  e.nis = e.log_density = e.spread_share = not_a_number;
  return e;
}

void check_snapshot(const FilterSnapshot& snapshot, Index n, Index K) {
  if (snapshot.means.rows() != n || snapshot.means.cols() != K || snapshot.covariances.rows() != n * n ||
      snapshot.covariances.cols() != K || snapshot.mode_probability.size() != K)
    throw std::invalid_argument("the snapshot is not of a filter of " + std::to_string(K) + " modes and " +
                                std::to_string(n) + " states");
  if (!snapshot.means.allFinite() || !snapshot.covariances.allFinite() || !snapshot.mode_probability.allFinite() ||
      snapshot.mode_probability.minCoeff() < 0.0 || !(snapshot.mode_probability.sum() > 0.0) ||
      !(snapshot.noise_scale > 0.0) || !(snapshot.noise_samples >= 0.0))
    throw std::invalid_argument("the snapshot holds numbers that no filter has");
}

}  // namespace

/// The steps behind their sizes.
struct BankFilter::Steps {
  FilterEstimate estimate;
  bool started = false;
  SampleFeed feed;

  Steps(const Bank& bank, const FilterOptions& options)
      : estimate(empty_estimate(bank)), feed(bank, options.time_steps) {}
  virtual ~Steps() = default;
  Steps(const Steps&) = delete;
  Steps& operator=(const Steps&) = delete;
  virtual void start() = 0;
  virtual void wait() = 0;
  virtual void step(const Vector& measurement) = 0;
  virtual void save(FilterSnapshot& snapshot) const = 0;
  virtual void restore(const FilterSnapshot& snapshot) = 0;

  /// Nothing is said yet about this sample.
  void clear_estimate() {
    FilterEstimate& e = estimate;
    e.prediction.setConstant(not_a_number);
    e.innovation_covariance.setConstant(not_a_number);
    e.spread_share = not_a_number;
    e.steps = 0;
    clear_scores();
  }
  void clear_scores() {
    estimate.innovation.setConstant(not_a_number);
    estimate.pit.setConstant(not_a_number);
    estimate.nis = estimate.log_density = not_a_number;
  }
};

template <int N, int NY>
struct BankFilter::SizedSteps final : BankFilter::Steps {
  FilterModel<N, NY> model;
  FilterStep<N, NY> work;
  FilterState<N> state;
  CombinedPrediction<N, NY> combined;
  Gaussian<N> moments;
  Eigen::VectorXd weights;

  SizedSteps(const Bank& bank, const FilterOptions& options)
      : Steps(bank, options),
        model(bank, options),
        work(model),
        state(initial_state(model)),
        combined(model.structure.dimension(), model.C.rows()),
        moments(model.structure.dimension()),
        weights(work.hypothesis_probability().size()) {}

  void wait() override {
    clear_estimate();
    estimate.state.setConstant(not_a_number);
    estimate.covariance.setConstant(not_a_number);
    estimate.mode_probability_predicted.head(model.mode_count()) = model.initial_probability;
    estimate.mode_probability.head(model.mode_count()) = model.initial_probability;
  }

  void start() override {
    clear_estimate();
    modebank::start(model, feed.start(), state);
    estimate.mode_probability_predicted.head(model.mode_count()) = state.mode_probability;
    record_posterior();
  }

  void step(const Vector& measurement) override {
    advance(model, feed, state, work);
    record_prediction();
    const double log_density = update(model, measurement, work, state);
    if (work.partial.missing == measurement.size())
      clear_scores();
    else
      record_scores(measurement, log_density);
    record_posterior();
  }

  void record_prediction() {
    combined.expect(model, work);
    estimate.prediction = combined.state;
    estimate.innovation_covariance = combined.innovation_covariance;
    estimate.spread_share = combined.spread_share;
    estimate.mode_probability_predicted.head(model.mode_count()) = work.predicted_probability;
    estimate.steps = feed.steps();
  }

  void record_scores(const Vector& measurement, double log_density) {
    combined.observe(model.C, measurement);
    estimate.innovation = combined.innovation;
    estimate.nis = combined.nis;
    estimate.log_density = log_density;
    probability_transform(measurement, work, weights, estimate.pit);
  }

  void record_posterior() {
    merge(state.modes, state.mode_probability, moments);
    estimate.state = moments.mean;
    estimate.covariance = moments.covariance;
    estimate.mode_probability.head(model.mode_count()) = state.mode_probability;
  }

  void save(FilterSnapshot& snapshot) const override {
    const Index n = model.structure.dimension(), K = model.mode_count();
    snapshot.means.resize(n, K);
    snapshot.covariances.resize(n * n, K);
    for (Index j = 0; j < K; ++j) {
      snapshot.means.col(j) = state.modes[static_cast<std::size_t>(j)].mean;
      snapshot.covariances.col(j) = state.modes[static_cast<std::size_t>(j)].covariance.reshaped();
    }
    snapshot.mode_probability = state.mode_probability;
    snapshot.noise_scale = state.noise_scale;
    snapshot.noise_samples = state.noise_samples;
  }

  void restore(const FilterSnapshot& snapshot) override {
    const Index n = model.structure.dimension(), K = model.mode_count();
    check_snapshot(snapshot, n, K);
    for (Index j = 0; j < K; ++j) {
      Gaussian<N>& mode = state.modes[static_cast<std::size_t>(j)];
      mode.mean = snapshot.means.col(j);
      mode.covariance = snapshot.covariances.col(j).reshaped(n, n);
    }
    state.mode_probability = snapshot.mode_probability;
    state.noise_scale = snapshot.noise_scale;
    state.noise_samples = snapshot.noise_samples;
  }
};

/// The same by vector kernels, where there are some for the bank.
struct BankFilter::VectorSteps final : BankFilter::Steps {
  VectorImm imm;
  Eigen::MatrixXd C;
  CombinedPrediction<Eigen::Dynamic, Eigen::Dynamic> combined;
  Eigen::VectorXd initial_probability, weights, log_likelihood;

  VectorSteps(const Bank& bank, const FilterOptions& options)
      : Steps(bank, options),
        imm(bank, options),
        C(bank.C),
        combined(imm.states(), C.rows()),
        initial_probability(bank.initial_probability),
        weights(imm.modes()),
        log_likelihood(imm.modes()) {}

  void wait() override {
    clear_estimate();
    estimate.state.setConstant(not_a_number);
    estimate.covariance.setConstant(not_a_number);
    estimate.mode_probability_predicted = initial_probability;
    estimate.mode_probability = initial_probability;
  }

  void start() override {
    clear_estimate();
    imm.start(feed.start());
    estimate.mode_probability_predicted = imm.mode_probability();
    record_posterior();
  }

  void step(const Vector& measurement) override {
    for (Index i = 1; i < feed.steps(); ++i) imm.skip(feed.inputs());
    imm.predict(feed.inputs());
    imm.combine(combined.state, combined.innovation_covariance, combined.spread_share);
    estimate.prediction = combined.state;
    estimate.innovation_covariance = combined.innovation_covariance;
    estimate.spread_share = combined.spread_share;
    estimate.mode_probability_predicted = imm.predicted_probability();
    estimate.steps = feed.steps();
    estimate.log_density = imm.update(measurement);
    if (std::isnan(estimate.log_density))
      clear_scores();
    else
      record_scores(measurement);
    record_posterior();
  }

  void record_scores(const Vector& measurement) {
    combined.observe(C, measurement);
    estimate.innovation = combined.innovation;
    estimate.nis = combined.nis;
    weights = imm.predicted_probability();
    probability_transform(
        measurement, [this](Index i, Index j) { return imm.decorrelated(i, j); },
        [this](Index i, Index j) { return imm.variance(i, j); }, weights, log_likelihood, estimate.pit);
  }

  void record_posterior() {
    imm.merge(estimate.state, estimate.covariance);
    estimate.mode_probability = imm.mode_probability();
  }

  void save(FilterSnapshot& snapshot) const override {
    imm.get(snapshot.means, snapshot.covariances, snapshot.mode_probability);
    snapshot.noise_scale = imm.noise_scale;
    snapshot.noise_samples = imm.noise_samples;
  }

  void restore(const FilterSnapshot& snapshot) override {
    check_snapshot(snapshot, imm.states(), imm.modes());
    imm.set(snapshot.means, snapshot.covariances, snapshot.mode_probability);
    imm.noise_scale = snapshot.noise_scale;
    imm.noise_samples = snapshot.noise_samples;
  }
};

std::unique_ptr<BankFilter::Steps> BankFilter::make_steps(const Bank& bank, const FilterOptions& options) {
  check_bank(bank);
  if (VectorImm::can_step(bank, options)) return std::make_unique<VectorSteps>(bank, options);
  return with_sizes(bank.structure.dimension(), bank.C.rows(), [&]<int N, int NY>() -> std::unique_ptr<Steps> {
    return std::make_unique<SizedSteps<N, NY>>(bank, options);
  });
}

BankFilter::BankFilter(const Bank& bank, const FilterOptions& options) : steps_(make_steps(bank, options)) {}

BankFilter::~BankFilter() = default;
BankFilter::BankFilter(BankFilter&&) noexcept = default;
BankFilter& BankFilter::operator=(BankFilter&&) noexcept = default;

const FilterEstimate& BankFilter::step(double time_s, const Vector& input, const Vector& measurement) {
  Steps& s = *steps_;
  s.feed.push(time_s, input, measurement);
  if (s.started && s.feed.steps() > longest_gap_steps) s.started = false;
  if (s.started) {
    s.step(measurement);
  } else if (s.feed.can_start()) {
    s.start();
    s.started = true;
  } else {
    s.wait();
  }
  return s.estimate;
}

const FilterEstimate& BankFilter::estimate() const { return steps_->estimate; }
bool BankFilter::started() const { return steps_->started; }

void BankFilter::restart() {
  steps_->started = false;
  steps_->feed.clear();
}

FilterSnapshot BankFilter::snapshot() const {
  FilterSnapshot snapshot;
  snapshot.started = steps_->started;
  steps_->save(snapshot);
  snapshot.samples = steps_->feed.memory();
  return snapshot;
}

void BankFilter::restore(const FilterSnapshot& snapshot) {
  steps_->feed.restore(snapshot.samples);
  steps_->restore(snapshot);
  steps_->started = snapshot.started;
}

}  // namespace modebank
