#include "filter/evaluate.hpp"

#include <stdexcept>

#include "filter/bank_filter.hpp"
#include "filter/filter_step.hpp"
#include "filter/run_samples.hpp"
#include "filter/scalar_imm.hpp"
#include "filter/vector_imm.hpp"
#include "ident/not_a_number.hpp"

namespace modebank {

namespace {

using Eigen::Index;

RunEvaluation sized_evaluation(const Bank& bank, Index samples) {
  const Index n = bank.structure.dimension(), n_y = bank.C.rows(), K = bank.mode_count();
  RunEvaluation e;
  e.prediction.resize(n, samples);
  e.innovation.resize(n_y, samples);
  e.innovation_covariance.resize(n_y * n_y, samples);
  e.state.resize(n, samples);
  e.covariance.resize(n * n, samples);
  e.nis.resize(samples);
  e.pit.resize(n_y, samples);
  e.log_density.resize(samples);
  e.mode_probability_predicted.resize(K, samples);
  e.mode_probability.resize(K, samples);
  e.spread_share.resize(samples);
  return e;
}

void record(const FilterEstimate& estimate, Index k, RunEvaluation& e) {
  e.prediction.col(k) = estimate.prediction;
  e.innovation.col(k) = estimate.innovation;
  e.innovation_covariance.col(k) = estimate.innovation_covariance.reshaped();
  e.state.col(k) = estimate.state;
  e.covariance.col(k) = estimate.covariance.reshaped();
  e.nis(k) = estimate.nis;
  e.pit.col(k) = estimate.pit;
  e.log_density(k) = estimate.log_density;
  e.mode_probability_predicted.col(k) = estimate.mode_probability_predicted;
  e.mode_probability.col(k) = estimate.mode_probability;
  e.spread_share(k) = estimate.spread_share;
}

/// Filter alone: calls take(k, log density) for every sample it scores.
template <int N, int NY, class Take>
void score_samples(const Bank& bank, const Trajectory& run, const FilterOptions& options, Take take) {
  const FilterModel<N, NY> model(bank, options);
  FilterStep<N, NY> step(model);
  FilterState<N> state = initial_state(model);
  RunSamples(bank, run, options.time_steps).for_each([&](const SampleFeed& feed, Index k, bool starts) {
    if (starts) return start(model, feed.start(), state);
    advance(model, feed, state, step);
    const double log_density = update(model, run.state.col(k), step, state);
    if (!std::isnan(log_density)) take(k, log_density);
  });
}

template <class Take>
void score_by_vectors(const Bank& bank, const Trajectory& run, const FilterOptions& options, Take take) {
  VectorImm imm(bank, options);
  RunSamples(bank, run, options.time_steps).for_each([&](const SampleFeed& feed, Index k, bool starts) {
    if (starts) return imm.start(feed.start());
    for (Index i = 1; i < feed.steps(); ++i) imm.skip(feed.inputs());
    imm.predict(feed.inputs());
    const double log_density = imm.update(run.state.col(k));
    if (!std::isnan(log_density)) take(k, log_density);
  });
}

template <class Take>
void score_samples(const Bank& bank, const Trajectory& run, const FilterOptions& options, Take take) {
  if (VectorImm::can_step(bank, options)) return score_by_vectors(bank, run, options, take);
  with_sizes(bank.structure.dimension(), bank.C.rows(),
             [&]<int N, int NY>() { score_samples<N, NY>(bank, run, options, take); });
}

}  // namespace

RunEvaluation evaluate_run(const Bank& bank, const Trajectory& run, const FilterOptions& options) {
  check_run(bank, run);
  BankFilter filter(bank, options);
  RunEvaluation evaluation = sized_evaluation(bank, run.samples());
  for (Index k = 0; k < run.samples(); ++k)
    record(filter.step(sample_time_s(run, k), run.input.col(k), run.state.col(k)), k, evaluation);
  return evaluation;
}

std::vector<double> log_likelihoods(const std::vector<const Bank*>& banks, const std::vector<const Trajectory*>& runs,
                                    const FilterOptions& options) {
  if (banks.size() != runs.size()) throw std::invalid_argument("as many banks as runs are needed");
  std::vector<double> result(runs.size());
  std::vector<std::size_t> in_lanes, bank_of;
  std::vector<scalar_imm::Parameters> parameters;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    check_run(*banks[i], *runs[i]);
    const bool fits = scalar_imm::can_step(*banks[i], options) && scalar_imm::can_take(*banks[i], *runs[i], options) &&
                      banks[i]->mode_count() == banks[0]->mode_count() &&
                      runs[i]->input.rows() == runs[0]->input.rows();
    if (!fits) {
      result[i] = log_likelihood(*banks[i], *runs[i], options);
      continue;
    }
    if (in_lanes.empty() || banks[i] != banks[in_lanes.back()]) parameters.emplace_back(*banks[i]);
    in_lanes.push_back(i);
    bank_of.push_back(parameters.size() - 1);
  }
  std::vector<scalar_imm::Job> jobs;
  for (std::size_t j = 0; j < in_lanes.size(); ++j) {
    const Trajectory& run = *runs[in_lanes[j]];
    jobs.push_back({&parameters[bank_of[j]], {run.state.data(), run.input.data(), run.samples()}});
  }
  const std::vector<double> values = scalar_imm::log_likelihoods(jobs);
  for (std::size_t j = 0; j < in_lanes.size(); ++j) result[in_lanes[j]] = values[j];
  return result;
}

double log_likelihood(const Bank& bank, const Trajectory& run, const FilterOptions& options) {
  check_run(bank, run);
  if (scalar_imm::can_step(bank, options) && scalar_imm::can_take(bank, run, options))
    return scalar_imm::log_likelihood(scalar_imm::Parameters(bank),
                                      {run.state.data(), run.input.data(), run.samples()});
  double sum = 0.0;
  score_samples(bank, run, options, [&](Index, double log_density) { sum += log_density; });
  return sum;
}

Eigen::VectorXd log_densities(const Bank& bank, const Trajectory& run, const FilterOptions& options) {
  check_run(bank, run);
  Eigen::VectorXd result = Eigen::VectorXd::Constant(run.samples(), not_a_number);
  score_samples(bank, run, options, [&](Index k, double log_density) { result(k) = log_density; });
  return result;
}

}  // namespace modebank
