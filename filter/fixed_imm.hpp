#pragma once

#include <Eigen/Core>
#include <optional>
#include <stdexcept>
#include <string>

#include "filter/combined.hpp"
#include "filter/filter_step.hpp"
#include "filter/vector_imm.hpp"

namespace modebank {

/// A bank at work with sizes known to the compiler: N states, M inputs, K modes, NY measurements, each fixed or
/// Eigen::Dynamic; all forms give the same numbers to the bit. For loops that know their robot: one call per sample,
/// which allocates nothing. Lags, gaps and the clock are BankFilter's; here every sample is one step.
template <int N, int M, int K, int NY = N>
class Imm {
 public:
  using State = Eigen::Matrix<double, N, 1>;
  using Input = Eigen::Matrix<double, M, 1>;
  using Measurement = Eigen::Matrix<double, NY, 1>;
  using Modes = Eigen::Matrix<double, K, 1>;

  /// Throws std::invalid_argument when the bank has other sizes.
  explicit Imm(const Bank& bank, const FilterOptions& options = {})
      : model_(checked(bank), options),
        step_(model_),
        state_(initial_state(model_)),
        combined_(model_.structure.dimension(), model_.C.rows()),
        estimate_(model_.structure.dimension()) {
    if (VectorImm::can_step(bank, options)) vector_.emplace(bank, options);
  }

  /// Starts at the first measurement.
  void start(const Measurement& y) {
    if (vector_) return vector_->start(y), vector_->merge(estimate_.mean, estimate_.covariance);
    modebank::start(model_, y, state_);
    merge(state_.modes, state_.mode_probability, estimate_);
  }
  /// From the sample before, whose input was `u`, to this one, which measured `y` (NaN: not). Returns the measurement's
  /// log predictive density [nats], NaN when there was none.
  double step(const Input& u, const Measurement& y) {
    if (vector_) return vector_step(u, y);
    predict(model_, state_, u, step_);
    combined_.expect(model_, step_);
    const double log_density = update(model_, y, step_, state_);
    combined_.observe(model_.C, y);
    merge(state_.modes, state_.mode_probability, estimate_);
    return log_density;
  }

  const State& state() const { return estimate_.mean; }            ///< after the measurement
  const auto& covariance() const { return estimate_.covariance; }  ///< of state()
  const State& prediction() const { return combined_.state; }      ///< before the measurement
  const Measurement& innovation() const { return combined_.innovation; }
  const auto& innovation_covariance() const { return combined_.innovation_covariance; }
  double nis() const { return combined_.nis; }
  Modes mode_probability() const {
    return vector_ ? Modes(vector_->mode_probability()) : Modes(state_.mode_probability);
  }
  Modes mode_probability_predicted() const {
    return vector_ ? Modes(vector_->predicted_probability()) : Modes(step_.predicted_probability);
  }

 private:
  std::optional<VectorImm> vector_;  ///< takes the steps where it can
  FilterModel<N, NY> model_;
  FilterStep<N, NY> step_;
  FilterState<N> state_;
  CombinedPrediction<N, NY> combined_;
  Gaussian<N> estimate_;

  double vector_step(const Input& u, const Measurement& y) {
    vector_->predict(u);
    vector_->combine(combined_.state, combined_.innovation_covariance, combined_.spread_share);
    const double log_density = vector_->update(y);
    combined_.observe(model_.C, y);
    vector_->merge(estimate_.mean, estimate_.covariance);
    return log_density;
  }

  static const Bank& checked(const Bank& bank) {
    check_sizes(bank);
    const auto require = [](const char* what, int fixed, Eigen::Index is) {
      if (fixed != Eigen::Dynamic && fixed != is)
        throw std::invalid_argument("the bank has " + std::to_string(is) + " " + what + ", this filter is built for " +
                                    std::to_string(fixed));
    };
    require("states", N, bank.structure.dimension());
    require("inputs", M, bank.structure.acting_inputs());
    require("modes", K, bank.mode_count());
    require("measurements", NY, bank.C.rows());
    return bank;
  }
};

}  // namespace modebank
