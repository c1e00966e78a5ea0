// The live filter's steps by vector kernels.
#include "filter/bank_filter_steps.hpp"
#include "filter/combined.hpp"
#include "filter/vector_imm.hpp"
#include "ident/not_a_number.hpp"

namespace modebank {

using Eigen::Index;

namespace {

struct VectorSteps final : BankFilterSteps {
  VectorImm imm;
  Eigen::MatrixXd C;
  CombinedPrediction<Eigen::Dynamic, Eigen::Dynamic> combined;
  Eigen::VectorXd initial_probability;

  VectorSteps(const Bank& bank, const FilterOptions& options)
      : BankFilterSteps(bank, options),
        imm(bank, options),
        C(bank.C),
        combined(imm.states(), C.rows()),
        initial_probability(bank.initial_probability) {}

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
    imm.transform(measurement, estimate.pit);
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

}  // namespace

std::unique_ptr<BankFilterSteps> make_vector_steps(const Bank& bank, const FilterOptions& options) {
  return std::make_unique<VectorSteps>(bank, options);
}

}  // namespace modebank
