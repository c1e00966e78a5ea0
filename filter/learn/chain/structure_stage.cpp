#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <optional>
#include <utility>

#include "filter/learn/chain/armax_bank.hpp"
#include "filter/learn/chain/stage_structures.hpp"
#include "filter/learn/chain/stages.hpp"
#include "ident/base/clustered_error.hpp"
#include "ident/lag/structure_search.hpp"

namespace modebank {

namespace {

constexpr double most_repeated = 0.1;  // share of samples that equal the one before, as for comparing densities

/// Whether samples repeat too often for a density of noise. A rest, where inputs are zero, does not count.
bool is_repeated(const Recording& recording) {
  Index repeated = 0, samples = 0;
  for (const Trajectory& run : recording.runs)
    for (Index k = 1; k < run.samples() && run.role == Role::train; ++k) {
      const auto same = run.states().col(k).array() == run.states().col(k - 1).array();
      if (recording.input_count() > 0 && same.all() && run.inputs().col(k).isZero(0.0)) continue;
      ++samples;
      repeated += same.any();
    }
  return static_cast<double>(repeated) > most_repeated * static_cast<double>(samples);
}

StructureScore row_of(const ArmaxCandidate& one, const ArmaxCandidate& best, const Eigen::VectorXd& rows) {
  const ArmaxOrder& order = one.fit.order;
  StructureScore row;
  row.state_lags = order.state_lags;
  row.input_lags = std::max<Index>(1, order.input_lags);
  row.input_delay = InputDelays(one.fit.delays).latest();
  row.noise_lags = order.noise_lags;
  row.differences = order.differences;
  row.log_score = one.left_out.sum() / rows.sum();
  row.loss = one.lost / rows.sum();
  row.loss_standard_error = clustered_error(best.left_out - one.left_out, rows);
  row.rmse = one.fit.S.diagonal().cwiseSqrt();
  return row;
}

/// Whether the lags of a fit leave three quarters of the training transitions, and at most `most` samples (0: any)
/// before the first prediction of a run. Of few runs, folds are stretches.
bool leaves_enough(const Recording& recording, const ArmaxFit& fit, Index most) {
  const Index more = fit.order.differences ? 1 : 0;
  const Index delay = InputDelays(fit.delays).latest();
  const Index memory = std::max(fit.order.state_lags, fit.order.input_lags + delay - 1) + more;
  Index lost = 0, runs = 0;
  for (const Trajectory& run : recording.runs)
    if (run.role == Role::train) lost += std::min(run.transitions(), memory - 1), ++runs;
  if (runs < refine_tuning.fewest_whole_runs) lost *= 5;  // the stretches of a run
  return 4 * lost <= recording.transitions(Role::train) && (most == 0 || memory <= most);
}

/// States the answer of the linear stage before stages choose among few lags, which takes most of the time.
void tell_of(const ArmaxFit& fit, const Recording& recording, const Progress& progress) {
  const StepResponse response = bank_of(recording, fit, std::nullopt).modes.front().response.value;
  const auto list = [](const Eigen::MatrixXd& of) { return fmt::join(of.data(), of.data() + of.size(), ", "); };
  progress.progress(fmt::format("linear model: {} state and {} noise lags{}; gain {:.4g}, 63 % after {:.4g} s",
                                fit.order.state_lags, fit.order.noise_lags,
                                fit.order.differences ? ", in differences" : "", list(response.gain),
                                list(response.response_s)));
}

/// The linear stage (ident/lag/armax.hpp) on recordings whose structure is searched as a whole. Empty where it does not
/// apply, and where more than one lag of an ARX explain the runs best: then lags are searched by least squares.
std::optional<FoundStructure> linear_structure_of(const Recording& recording, const StructureInputs& inputs,
                                                  const Progress& progress) {
  constexpr Index few_lags = 2;
  const SearchedLags& searched = inputs.searched;
  const bool acted_on = recording.input_count() > 0;
  if (!searched.state || (acted_on && !(searched.input && searched.delay)) || is_repeated(recording)) return {};
  LinearStageOptions options;
  options.intercept = inputs.window.intercept;
  options.least_delay = least_delays(recording);
  const LinearStage stage = find_linear_stage(recording, options);
  if (stage.candidates.empty()) return {};
  const ArmaxFit& fit = stage.fit();
  if (fit.order.noise_lags == 0 && fit.order.state_lags > few_lags) return {};
  const double rounding = std::numeric_limits<double>::epsilon() * recording.runs.front().states().norm();
  if (!leaves_enough(recording, fit, searched.most_samples) || fit.S.trace() < rounding * rounding) return {};
  tell_of(fit, recording, progress);
  const auto best = std::ranges::min_element(stage.candidates, {}, &ArmaxCandidate::lost);
  FoundStructure found;
  for (const ArmaxCandidate& one : stage.candidates) found.scores.push_back(row_of(one, *best, stage.rows));
  found.scores[stage.chosen].chosen = true;
  std::ranges::stable_sort(found.scores, std::greater(), &StructureScore::log_score);
  found.input_delay = InputDelays(fit.delays);
  found.samples = static_cast<Index>(stage.rows.sum());
  found.parts = stage.rows.size();
  found.by_runs = stage.by_runs;
  found.structures = std::ssize(stage.candidates);
  found.noise_lags = fit.order.noise_lags;
  found.differences = fit.order.differences;
  return found;
}

}  // namespace

FoundStructure search_structure(const Recording& recording, const StructureInputs& inputs, const Progress& progress) {
  const Stopwatch watch;
  std::optional<FoundStructure> linear = linear_structure_of(recording, inputs, progress);
  FoundStructure found = linear ? std::move(*linear) : find_structure(recording, inputs.window, inputs.searched);
  if (found.remark.empty() && is_repeated(recording))
    found.remark = "no sensor noise was looked for, because over 10 % of the samples repeat the one before";
  StructureInputs of_stages = inputs;
  of_stages.window.input_delay = found.input_delay;
  choose_for_stages(recording, of_stages, found);
  progress.progress(fmt::format("structure: {} structures compared in {:.2f} s", found.structures, watch.seconds()));
  if (!found.remark.empty()) progress.warning("structure: " + found.remark);
  return found;
}

LearningOptions with_structure(const LearningOptions& of, const FoundStructure& found, Index inputs) {
  LearningOptions options = of;
  FitOptions& window = options.window;
  window.state_lags = found.state_lags;
  window.input_lags = found.input_lags;
  window.input_delay = found.delays_of_modes();
  if (has_lags(window)) window.model = "varx";
  for (const StructureScore& s : found.scores) {
    const StageLags lags{s.state_lags, s.input_lags, found.delays_of(s)};
    if (s.linear) options.other_lags.linear = lags;
    if (s.linear && (s.noise_lags > 0 || s.differences)) {
      const Index more = s.differences ? 1 : 0, of_inputs = inputs > 0 ? more : 0;
      options.other_lags.linear = StageLags{s.state_lags + more, s.input_lags + of_inputs, lags.input_delay};
      options.other_lags.armax = armax_of(s, found, inputs, window.intercept);
    }
    if (s.one_motion) options.other_lags.one_motion = lags;
    if (s.drifting) options.other_lags.drifting = lags;
  }
  return options;
}

}  // namespace modebank
