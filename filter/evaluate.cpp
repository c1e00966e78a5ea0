#include "filter/evaluate.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "filter/combined.hpp"
#include "filter/filter_step.hpp"
#include "ident/error.hpp"
#include "ident/lagged_samples.hpp"
#include "ident/not_a_number.hpp"

namespace modebank {

namespace {

using Eigen::Index;

void check_run(const Bank& bank, const Trajectory& run) {
  check_sizes(bank);
  const auto mismatch = [&](const std::string& what, Index is, Index expected) {
    if (is != expected)
      throw std::invalid_argument("run " + run.run + " has " + std::to_string(is) + " " + what + ", the bank needs " +
                                  std::to_string(expected));
  };
  mismatch("measured signals", run.state.rows(), bank.C.rows());
  mismatch("inputs", run.input.rows(), bank.structure.inputs);
  mismatch("input samples", run.input.cols(), run.samples());
  if (bank.structure.state_lags > 1 && bank.C.rows() != bank.structure.states)
    throw std::invalid_argument("a bank with lagged states must measure each of its " +
                                std::to_string(bank.structure.states) + " states");
  for (Index k = 0; k < run.transitions(); ++k)
    if (!run.input.col(k).allFinite())
      throw DataError("run " + run.run + ": the input of sample " + std::to_string(k) + " is not a finite number");
}

/// A run as the filter takes it: inputs that act on each transition, and where it starts from.
class FilterInput {
 public:
  FilterInput(const LinearStructure& s, const Trajectory& run)
      : run_(run), acting_(s.lagged() ? acting_inputs(s, run) : Eigen::MatrixXd()), lagged_(s.lagged()) {
    if (s.state_lags > 1) stacked_ = stacked_states(s, run);
    first_ = s.first_transition();
    while (first_ < run.samples() && is_missing(measurements().col(first_))) ++first_;
    first_ = std::min(first_, run.samples());
  }
  /// The first sample with a whole measurement (of every lagged sample); N when there is none.
  Index first() const { return first_; }
  auto start() const { return measurements().col(first_); }
  auto inputs(Index transition) const { return (lagged_ ? acting_ : run_.input).col(transition); }

 private:
  const Eigen::MatrixXd& measurements() const { return stacked_.size() > 0 ? stacked_ : run_.state; }

  const Trajectory& run_;
  Eigen::MatrixXd acting_, stacked_;
  bool lagged_;
  Index first_ = 0;
};

RunEvaluation empty_evaluation(const Bank& bank, Index samples) {
  const Index n = bank.structure.dimension(), n_y = bank.C.rows(), K = bank.mode_count();
  RunEvaluation e;
  e.prediction.setConstant(n, samples, not_a_number);
  e.innovation.setConstant(n_y, samples, not_a_number);
  e.innovation_covariance.setConstant(n_y * n_y, samples, not_a_number);
  e.state.setConstant(n, samples, not_a_number);
  e.covariance.setConstant(n * n, samples, not_a_number);
  e.nis.setConstant(samples, not_a_number);
  e.pit.setConstant(n_y, samples, not_a_number);
  e.log_density.setConstant(samples, not_a_number);
  e.mode_probability_predicted.setZero(K, samples);
  e.mode_probability.setZero(K, samples);
  return e;
}

/// Steps through one run and writes down what the filter said. Modes that the variant leaves out keep probability zero.
template <int N, int NY>
class RunRecorder {
 public:
  RunRecorder(const FilterModel<N, NY>& model, RunEvaluation& evaluation)
      : model_(model),
        out_(evaluation),
        combined_(model.structure.dimension(), model.C.rows()),
        moments_(model.structure.dimension()),
        weights_(model.mode_count()) {}

  void not_started(Index k) {
    out_.mode_probability_predicted.col(k).head(model_.mode_count()) = model_.initial_probability;
    out_.mode_probability.col(k).head(model_.mode_count()) = model_.initial_probability;
  }

  void start(Index k, const FilterState<N>& state) {
    out_.mode_probability_predicted.col(k).head(model_.mode_count()) = state.mode_probability;
    posterior(k, state);
  }

  void prediction(Index k, FilterStep<N, NY>& step) {
    combined_.expect(model_, step);
    out_.prediction.col(k) = combined_.state;
    out_.innovation_covariance.col(k) = combined_.innovation_covariance.reshaped();
    out_.mode_probability_predicted.col(k).head(model_.mode_count()) = step.predicted_probability;
  }

  template <class Y>
  void measurement(Index k, const Y& y, double log_density, FilterStep<N, NY>& step) {
    combined_.observe(model_, y, step);
    out_.innovation.col(k) = combined_.innovation;
    out_.nis(k) = combined_.nis;
    out_.log_density(k) = log_density;
    probability_transform(step, weights_, out_.pit.col(k));
  }

  void posterior(Index k, const FilterState<N>& state) {
    merge(state.modes, state.mode_probability, moments_);
    out_.state.col(k) = moments_.mean;
    out_.covariance.col(k) = moments_.covariance.reshaped();
    out_.mode_probability.col(k).head(model_.mode_count()) = state.mode_probability;
  }

 private:
  const FilterModel<N, NY>& model_;
  RunEvaluation& out_;
  CombinedPrediction<N, NY> combined_;
  Gaussian<N> moments_;
  Eigen::VectorXd weights_;
};

template <int N, int NY>
RunEvaluation evaluate(const Bank& bank, const Trajectory& run, const FilterOptions& options) {
  const FilterModel<N, NY> model(bank, options);
  RunEvaluation evaluation = empty_evaluation(bank, run.samples());
  RunRecorder<N, NY> record(model, evaluation);
  const FilterInput input(bank.structure, run);
  const Index first = input.first();
  for (Index k = 0; k < first; ++k) record.not_started(k);
  if (first == run.samples()) return evaluation;

  FilterStep<N, NY> step(model);
  FilterState<N> state = start(model, input.start());
  record.start(first, state);
  for (Index k = first + 1; k < run.samples(); ++k) {
    const auto y = run.state.col(k);
    predict(model, state, input.inputs(k - 1), step);
    record.prediction(k, step);
    if (is_missing(y))
      skip_measurement(step, state);
    else
      record.measurement(k, y, update(model, y, step, state), step);
    record.posterior(k, state);
  }
  return evaluation;
}

template <int N, int NY>
double sum_log_density(const Bank& bank, const Trajectory& run, const FilterOptions& options) {
  const FilterInput input(bank.structure, run);
  const Index first = input.first();
  if (first == run.samples()) return 0.0;
  const FilterModel<N, NY> model(bank, options);
  FilterStep<N, NY> step(model);
  FilterState<N> state = start(model, input.start());
  double sum = 0.0;
  for (Index k = first + 1; k < run.samples(); ++k) {
    const auto y = run.state.col(k);
    predict(model, state, input.inputs(k - 1), step);
    if (is_missing(y))
      skip_measurement(step, state);
    else
      sum += update(model, y, step, state);
  }
  return sum;
}

}  // namespace

RunEvaluation evaluate_run(const Bank& bank, const Trajectory& run, const FilterOptions& options) {
  check_run(bank, run);
  return with_sizes(bank.structure.dimension(), bank.C.rows(),
                    [&]<int N, int NY>() { return evaluate<N, NY>(bank, run, options); });
}

double log_likelihood(const Bank& bank, const Trajectory& run, const FilterOptions& options) {
  check_run(bank, run);
  return with_sizes(bank.structure.dimension(), bank.C.rows(),
                    [&]<int N, int NY>() { return sum_log_density<N, NY>(bank, run, options); });
}

}  // namespace modebank
