// The live filter's steps for any bank and variant.
#include "filter/bank_filter_steps.hpp"
#include "filter/combined.hpp"
#include "filter/filter_step.hpp"
#include "filter/run_samples.hpp"

namespace modebank {

using Eigen::Index;

namespace {

template <int N, int NY>
struct GeneralSteps final : BankFilterSteps {
  FilterModel<N, NY> model;
  FilterStep<N, NY> work;
  FilterState<N> state;
  CombinedPrediction<N, NY> combined;
  Gaussian<N> moments;
  Eigen::VectorXd weights;

  GeneralSteps(const Bank& bank, const FilterOptions& options)
      : BankFilterSteps(bank, options),
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

}  // namespace

std::unique_ptr<BankFilterSteps> make_general_steps(const Bank& bank, const FilterOptions& options) {
  return with_sizes(bank.structure.dimension(), bank.C.rows(),
                    [&]<int N, int NY>() -> std::unique_ptr<BankFilterSteps> {
                      return std::make_unique<GeneralSteps<N, NY>>(bank, options);
                    });
}

}  // namespace modebank
