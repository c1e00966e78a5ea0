#include "filter/learn/refine/split_fits.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstddef>
#include <utility>

#include "filter/learn/competitors/competitors.hpp"
#include "filter/learn/switching/starts.hpp"
#include "filter/learn/tuning.hpp"
#include "ident/fit/global_model.hpp"

namespace modebank {

std::vector<SplitData> split_data(const RefineInput& in) {
  std::vector<SplitData> splits;
  for (ValidationSplit& split : validation_splits(in.recording, in.options.folds, refine_tuning)) {
    Bank frame = in.frame;
    if (in.options.noise_by_input && !frame.noise_factor.empty())
      frame.noise_factor = fit_noise_factor(split.training, frame.structure);
    TrainingTransitions transitions = gather_training_transitions(split.training, frame.structure, frame.noise_factor);
    GlobalModel global = fit_global(split.training, in.frame.structure);
    splits.push_back({std::move(split), std::move(frame), std::move(transitions), std::move(global)});
  }
  return splits;
}

SwitchingPrior prior_of_split(const RefineInput& in, const SplitData& split, double noise_transitions) {
  return switching_prior(split.transitions, split.global, in.fits.prior_sd, noise_transitions, refine_tuning);
}

SwitchingPrior prior_of_split(const RefineInput& in, const SplitData& split, const RefineStart& start) {
  return towards_one_motion(prior_of_split(in, split, start.noise_transitions), split.transitions, start.model,
                            start.theta_transitions, refine_tuning);
}

namespace {

std::vector<SwitchingPrior> priors_of(const RefineInput& in, const std::vector<SplitData>& splits,
                                      const RefineStart& start) {
  std::vector<SwitchingPrior> priors;
  for (const SplitData& split : splits) priors.push_back(prior_of_split(in, split, start));
  return priors;
}

}  // namespace

SplitFits::SplitFits(const RefineInput& in, const std::vector<SplitData>& splits, const RefineStart& start)
    : SplitFits(in, splits, priors_of(in, splits, start),
                std::vector<SwitchingRegression>(splits.size(), start.model)) {}

SplitFits::SplitFits(const RefineInput& in, const std::vector<SplitData>& splits, std::vector<SwitchingPrior> priors,
                     std::vector<SwitchingRegression> starts)
    : splits_(splits), priors_(std::move(priors)), fits_(splits.size()) {
  tbb::parallel_for(std::size_t{0}, splits.size(), [&](std::size_t s) {
    fits_[s] = std::make_unique<ExpectationMaximisation>(splits[s].transitions, priors_[s], em_options(in.options),
                                                         std::move(starts[s]));
  });
}

void SplitFits::advance_to(Index iterations) {
  tbb::parallel_for(std::size_t{0}, fits_.size(), [&](std::size_t s) {
    for (Index i = done_; i < iterations && !fits_[s]->converged(); ++i) fits_[s]->step();
  });
  done_ = iterations;
}

bool SplitFits::converged() const {
  return std::all_of(fits_.begin(), fits_.end(), [](const auto& fit) { return fit->converged(); });
}

std::vector<Bank> SplitFits::banks() const {
  std::vector<Bank> banks;
  for (std::size_t s = 0; s < fits_.size(); ++s) banks.push_back(with_modes(splits_[s].frame, fits_[s]->model()));
  return banks;
}

}  // namespace modebank
