#include "filter/step/stepper.hpp"

#include "filter/step/drifting_stepper.hpp"
#include "filter/step/equations/filter_memory.hpp"
#include "filter/step/equations/filter_step.hpp"
#include "filter/step/equations/predicted_mixture.hpp"

namespace modebank {

namespace {

/// A Stepper that uses the equations.
template <int N, int NY>
class EquationStepper final : public Stepper {
 public:
  EquationStepper(const Bank& bank, const FilterOptions& options)
      : model_(bank, options),
        step_(model_),
        state_(initial_state(model_)),
        moments_(model_.structure.dimension()),
        weights_(step_.predicted_probability.size()) {}

  void start(const Vector& y) override { modebank::start(model_, y, state_); }
  void predict(const Vector& v) override { modebank::predict(model_, state_, v, step_); }
  void skip(const Vector& v) override {
    modebank::predict(model_, state_, v, step_);
    skip_measurement(step_, state_);
  }
  double update(const Vector& y) override { return modebank::update(model_, y, step_, state_); }

  void combine(Eigen::Ref<Eigen::VectorXd> state, Eigen::Ref<Eigen::MatrixXd> innovation_covariance) override {
    modebank::combine(model_, step_, state, innovation_covariance);
  }
  void transform(const Vector& y, Eigen::Ref<Eigen::VectorXd> pit, Eigen::Ref<Eigen::VectorXd> width,
                 double& log_density) override {
    if (model_.quantum.size() > 0)
      log_density = interval_transform(model_, y, step_, weights_, pit, width);
    else
      probability_transform(y, step_, weights_, pit);
  }
  void merge(Eigen::Ref<Eigen::VectorXd> mean, Eigen::Ref<Eigen::MatrixXd> covariance) override {
    modebank::merge(state_.modes, state_.mode_probability, moments_);
    mean = moments_.mean;
    covariance = moments_.covariance;
  }
  Eigen::Map<const Eigen::VectorXd> predicted_probability() const override { return map(step_.predicted_probability); }
  Eigen::Map<const Eigen::VectorXd> mode_probability() const override { return map(state_.mode_probability); }

  void save(FilterMemory& memory) const override { modebank::save(state_, memory); }
  void restore(const FilterMemory& memory) override { modebank::restore(memory, model_.exact, state_); }

 private:
  FilterModel<N, NY> model_;
  FilterStep<N, NY> step_;
  FilterState<N> state_;
  Gaussian<N> moments_;
  Eigen::VectorXd weights_;

  static Eigen::Map<const Eigen::VectorXd> map(const Eigen::VectorXd& v) { return {v.data(), v.size()}; }
};

}  // namespace

std::unique_ptr<Stepper> make_stepper(const Bank& bank, const FilterOptions& options) {
  if (!bank.running_noise.empty()) return std::make_unique<DriftingStepper>(bank);
  return with_sizes(bank.structure.dimension(), bank.C.rows(), [&]<int N, int NY>() -> std::unique_ptr<Stepper> {
    return std::make_unique<EquationStepper<N, NY>>(bank, options);
  });
}

}  // namespace modebank
