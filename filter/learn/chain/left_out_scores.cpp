// Forecasts of training runs by filters that were learned without them.
#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>

#include "filter/judge/combination.hpp"
#include "filter/judge/horizon.hpp"
#include "filter/learn/chain/stages.hpp"
#include "filter/learn/competitors/competitors.hpp"
#include "filter/learn/from_mixture/bank.hpp"
#include "filter/learn/left_out/folds.hpp"
#include "filter/learn/tuning.hpp"
#include "ident/fit/global_model.hpp"
#include "ident/terms/find_terms.hpp"

namespace modebank {
namespace {

/// Chooses the terms again from the runs of the split, because terms score too well on the runs that chose them. If
/// these runs give no terms, the terms of all training runs are fitted to them.
Bank relearn_nonlinear(const CompetitorsPart& learned, const Recording& training, const BankInputs& inputs) {
  FoundTerms found;
  LinearStructure structure = learned.baseline->structure;
  structure.intercept = inputs.window.intercept;  // a model of differences has none
  structure.centre.clear();                       // terms are functions of the values themselves
  if (!inputs.terms_stated) found = find_terms(training, structure, inputs.window);
  if (found.terms.empty()) {
    found.structure = learned.nonlinear->structure;
    found.terms = learned.nonlinear->terms;
  }
  return learn_nonlinear(training, found.structure, found.terms, inputs.bank.em);
}

/// The filters learned without the left-out runs of a split. Some come from refinement; the other filters get new
/// coefficients. A few numbers are not learned again: Q and R of a baseline that is not of the linear stage, and the
/// rates of `drifting`.
Learning learned_on(const Learning& learned, const Recording& training, const BankInputs& inputs, const Bank& bank,
                    const Bank& one_motion) {
  Learning anew;
  anew.bank = bank;
  anew.one_motion = one_motion;
  if (inputs.lags.armax) anew.baseline = learn_armax(training, *inputs.lags.armax, inputs.bank.measurement_variance);
  if (!anew.baseline && learned.baseline) {
    anew.baseline = learned.baseline;
    const LinearStructure& structure = anew.baseline->structure;
    anew.baseline->modes.front().model = unpack(structure, fit_global(training, structure).theta);
  }
  if (learned.noise_only) {
    const LinearStructure& structure = learned.noise_only->structure;
    const NoiseFactor factor =
        learned.noise_only->noise_factor.empty() ? NoiseFactor() : fit_noise_factor(training, structure);
    anew.noise_only = noise_only_beside(*anew.baseline, inputs.lags.armax.has_value(), training, structure, factor);
  }
  if (learned.drifting)
    anew.drifting = relearn_drifting(*learned.drifting, training, fit_global(training, learned.drifting->structure));
  if (learned.nonlinear) anew.nonlinear = relearn_nonlinear(learned, training, inputs);
  return anew;
}

}  // namespace

std::vector<LeftOutRow> score_left_out(const StageData& data, const Learning& learned, const BankInputs& inputs,
                                       const std::vector<Bank>& banks, const std::vector<Bank>& one_motions) {
  if (!inputs.filter) return {};
  const Stopwatch watch;
  const std::vector<ValidationSplit> splits = validation_splits(data.part, inputs.bank.em.folds);
  if (splits.empty() || banks.size() != splits.size() || one_motions.size() != splits.size()) return {};
  std::vector<Index> horizons = inputs.horizon;
  horizons.push_back(1);
  std::vector<std::string> names;
  std::vector<std::vector<HorizonEvaluation>> forecasts;
  std::vector<std::vector<LearnedFilter>> filters(splits.size());
  tbb::parallel_for(std::size_t{0}, splits.size(), [&](std::size_t s) {
    filters[s] =
        learned_filters(learned_on(learned, splits[s].training, inputs, banks[s], one_motions[s]), *inputs.filter);
  });
  for (const LearnedFilter& one : filters.front()) names.push_back(one.name);
  forecasts.resize(names.size());
  for (std::size_t s = 0; s < splits.size(); ++s)
    for (std::size_t f = 0; f < names.size(); ++f) {
      const std::vector<Trajectory>& runs = splits[s].left_out.runs;
      const std::size_t first = forecasts[f].size();
      forecasts[f].resize(first + runs.size());
      tbb::parallel_for(std::size_t{0}, runs.size(), [&](std::size_t r) {
        const LearnedFilter& one = filters[s][f];
        forecasts[f][first + r] = evaluate_horizons(one.bank, runs[r], one.options, horizons);
      });
    }
  data.tell(
      Level::progress,
      fmt::format("left out: scored {} filters on training runs, each learned without the scored run, in {:.2f} s",
                  names.size(), watch.seconds()));
  return left_out_rows(names, forecasts);
}

}  // namespace modebank
