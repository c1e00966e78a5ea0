// The structure of every stage: the linear stage first, then few lags for bank, one_motion and drifting.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstddef>
#include <functional>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "filter/learn/chain/stages.hpp"
#include "filter/learn/competitors/competitors.hpp"
#include "filter/learn/refine/structure_score.hpp"
#include "filter/learn/tuning.hpp"
#include "ident/base/not_a_number.hpp"
#include "ident/lag/structure_choice.hpp"
#include "ident/lag/structure_search.hpp"

namespace modebank {
namespace {

constexpr Index most_asked_transitions = 20000, most_equal_lags = 8, most_equal_lags_of_modes = 2;
constexpr double least_drifting_gain = 0.02;  // [nats/sample]

LinearStructure structure_of(const StructureScore& s, const Recording& recording, const FitOptions& window) {
  return {recording.state_count(),
          recording.input_count(),
          window.intercept,
          s.state_lags,
          s.input_lags,
          window.input_delay.with_latest(s.input_delay),
          window.centre};
}

using Rows = std::vector<StructureScore>;
using Flag = bool StructureScore::*;

StructureScore& marked(Rows& rows, Flag flag) {
  return *std::find_if(rows.begin(), rows.end(), [&](const StructureScore& s) { return s.*flag; });
}

void mark(Rows& rows, Flag flag, std::size_t at) {
  for (StructureScore& s : rows) s.*flag = false;
  rows[at].*flag = true;
}

/// Whether the model takes states as measured exactly, in levels.
bool is_exact(const StructureScore& s) { return s.noise_lags == 0 && !s.differences; }

/// Position of these lags in the table. Lags that are missing are added without a score.
std::size_t position_of(Rows& rows, Index state_lags, Index input_lags, Index delay) {
  const auto found = std::find_if(rows.begin(), rows.end(), [&](const StructureScore& s) {
    return is_exact(s) && s.state_lags == state_lags && s.input_lags == input_lags && s.input_delay == delay;
  });
  if (found != rows.end()) return static_cast<std::size_t>(found - rows.begin());
  StructureScore added{state_lags, input_lags, delay, not_a_number, not_a_number, not_a_number};
  added.rmse = Eigen::VectorXd::Constant(rows.front().rmse.size(), not_a_number);
  rows.push_back(std::move(added));
  return rows.size() - 1;
}

/// Delays to test: the delay of one linear motion, and the usual delay. If an input has effects of opposite sign in two
/// modes, they cancel in one linear model. Such a model may prefer a wrong delay.
std::vector<Index> delays_of(const StructureScore& linear, const SearchedLags& searched) {
  constexpr Index usual = 1;
  std::vector<Index> delays{linear.input_delay};
  if (searched.delay && linear.input_delay != usual) delays.push_back(usual);
  return delays;
}

/// Positions in the table of equal state and input lags, from 1 to `most`, if they were searched. Runs must have enough
/// samples before their first prediction.
std::vector<std::size_t> positions_of_equal(Rows& rows, Index most, const SearchedLags& searched) {
  const StructureScore linear = marked(rows, &StructureScore::linear);
  std::vector<std::size_t> positions;
  for (const Index delay : delays_of(linear, searched))
    for (Index lags = 1; lags <= most; ++lags) {
      const Index state_lags = searched.state ? lags : linear.state_lags,
                  input_lags = searched.input ? lags : linear.input_lags;
      if (searched.most_samples == 0 || std::max(state_lags, delay + input_lags - 1) <= searched.most_samples)
        positions.push_back(position_of(rows, state_lags, input_lags, delay));
    }
  return positions;
}

void let_drifting_choose(const Recording& recording, const StructureInputs& inputs, Rows& rows) {
  const Index transitions = recording.transitions(Role::train);
  if (transitions > most_asked_transitions) return;
  Rows candidates = rows;
  positions_of_equal(candidates, most_equal_lags, inputs.searched);
  Index latest = 0;
  for (const StructureScore& c : candidates)
    latest = std::max(latest, structure_of(c, recording, inputs.window).first_transition());
  const auto score = [&](const StructureScore& c, const DriftingGrid& grid) {
    return drifting_training_score(recording, latest, structure_of(c, recording, inputs.window), grid);
  };
  DriftingGrid constant = coarse_drifting_grid();
  constant.q = constant.p0 = {0.0};
  constant.leak = {1.0};
  StructureScore& of_linear = marked(candidates, &StructureScore::drifting);
  of_linear.drifting_score = score(of_linear, coarse_drifting_grid());
  if (!(of_linear.drifting_score >= score(of_linear, constant) + least_drifting_gain)) return;
  double highest = of_linear.drifting_score;
  for (StructureScore& c : candidates) {
    if (!is_exact(c)) continue;
    if (!c.drifting) c.drifting_score = score(c, coarse_drifting_grid());
    highest = std::max(highest, c.drifting_score);
  }
  const double slack = loss_by_chance(static_cast<double>(transitions));
  const StructureSize of_lags{recording.state_count(), recording.input_count()};
  const auto size = [&](const StructureScore& c) { return of_lags({c.state_lags, c.input_lags, c.input_delay}); };
  std::optional<std::size_t> fewest;
  for (std::size_t i = 0; i < candidates.size(); ++i)
    if (candidates[i].drifting_score >= highest - slack && (!fewest || size(candidates[i]) < size(candidates[*fewest])))
      fewest = i;
  if (!fewest) return;
  rows = std::move(candidates);
  mark(rows, &StructureScore::drifting, *fewest);
}

/// Marks the rows that modes use.
void let_modes_choose(const Recording& recording, const StructureInputs& inputs,
                      const std::vector<std::size_t>& positions, std::size_t incumbent, bool one_theta, Rows& rows) {
  std::vector<LinearStructure> structures;
  for (const std::size_t at : positions) structures.push_back(structure_of(rows[at], recording, inputs.window));
  const auto at = std::find(positions.begin(), positions.end(), incumbent) - positions.begin();
  const StructuresOfModes compared =
      compare_structures(recording, structures, static_cast<std::size_t>(at), one_theta, inputs.window.seed);
  for (std::size_t i = 0; i < positions.size(); ++i)
    rows[positions[i]].*(one_theta ? &StructureScore::one_motion_score : &StructureScore::modes_score) =
        compared.scores[i];
  mark(rows, one_theta ? &StructureScore::one_motion : &StructureScore::chosen, positions[compared.chosen]);
}

}  // namespace

void choose_for_stages(const Recording& recording, const StructureInputs& inputs, FoundStructure& found) {
  Rows& rows = found.scores;
  if (rows.empty()) return;
  marked(rows, &StructureScore::chosen).linear = true;
  const StructureScore of_linear = marked(rows, &StructureScore::linear);
  const Index more = of_linear.differences ? 1 : 0, of_inputs = recording.input_count() > 0 ? more : 0;
  const std::size_t exact =
      position_of(rows, of_linear.state_lags + more, of_linear.input_lags + of_inputs, of_linear.input_delay);
  for (const Flag flag : {&StructureScore::chosen, &StructureScore::one_motion, &StructureScore::drifting})
    mark(rows, flag, exact);
  let_drifting_choose(recording, inputs, rows);
  std::vector<std::size_t> positions = positions_of_equal(rows, most_equal_lags_of_modes, inputs.searched);
  for (const Flag flag : {&StructureScore::chosen, &StructureScore::drifting}) {
    const auto at = static_cast<std::size_t>(&marked(rows, flag) - rows.data());
    if (std::find(positions.begin(), positions.end(), at) == positions.end()) positions.push_back(at);
  }
  if (inputs.with_modes) {
    let_modes_choose(recording, inputs, positions, exact, false, rows);
    let_modes_choose(recording, inputs, positions, exact, true, rows);
  }
  const StructureScore& chosen = marked(rows, &StructureScore::chosen);
  found.state_lags = chosen.state_lags;
  found.input_lags = chosen.input_lags;
}

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

StructureScore row_of(const ArmaxFit& fit, const StructureLoss& loss) {
  StructureScore row{fit.order.state_lags,
                     std::max<Index>(1, fit.order.input_lags),
                     InputDelays(fit.delays).latest(),
                     fit.left_out.log_score,
                     loss.mean,
                     loss.standard_error,
                     fit.S.diagonal().cwiseSqrt()};
  row.noise_lags = fit.order.noise_lags;
  row.differences = fit.order.differences;
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
void tell_answer(const ArmaxFit& fit, const Recording& recording, const Tell& tell) {
  const StepResponse response = bank_of(recording, fit, std::nullopt).modes.front().response.value;
  const auto list = [](const Eigen::MatrixXd& of) { return fmt::join(of.data(), of.data() + of.size(), ", "); };
  tell(Level::progress,
       fmt::format("linear model: {} state and {} noise lags{}; gain {:.4g}, 63 % after {:.4g} s", fit.order.state_lags,
                   fit.order.noise_lags, fit.order.differences ? ", in differences" : "", list(response.gain),
                   list(response.response_s)));
}

/// The linear stage (ident/lag/linear_stage.hpp) on recordings whose structure is searched as a whole. Empty where it
/// does not apply, and where the lags of an ARX explain the runs best: then they are searched by least squares.
std::optional<FoundStructure> linear_structure_of(const Recording& recording, const StructureInputs& inputs,
                                                  const Tell& tell) {
  const SearchedLags& searched = inputs.searched;
  const bool acted_on = recording.input_count() > 0;
  if (!searched.state || (acted_on && !(searched.input && searched.delay)) || is_repeated(recording)) return {};
  LinearStageOptions options;
  options.intercept = inputs.window.intercept;
  options.least_delay = least_delays(recording);
  const LinearStage stage = find_linear_stage(recording, options);
  if (stage.candidates.empty()) return {};
  const ArmaxFit& fit = stage.fit();
  if (fit.order.noise_lags == 0) return {};
  const double rounding = std::numeric_limits<double>::epsilon() * recording.runs.front().states().norm();
  if (!leaves_enough(recording, fit, searched.most_samples) || fit.S.trace() < rounding * rounding) return {};
  tell_answer(fit, recording, tell);
  FoundStructure found;
  for (const ArmaxFit& one : stage.candidates)
    found.scores.push_back(row_of(one, loss_against(stage.candidates[stage.best].left_out, one.left_out, stage.rows)));
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

FoundStructure search_structure(const Recording& recording, const StructureInputs& inputs, const Tell& tell) {
  const Stopwatch watch;
  std::optional<FoundStructure> linear = linear_structure_of(recording, inputs, tell);
  FoundStructure found = linear ? std::move(*linear) : find_structure(recording, inputs.window, inputs.searched);
  if (found.remark.empty() && is_repeated(recording))
    found.remark = "no sensor noise was looked for, because over 10 % of the samples repeat the one before";
  StructureInputs of_stages = inputs;
  of_stages.window.input_delay = found.input_delay;
  choose_for_stages(recording, of_stages, found);
  tell(Level::progress,
       fmt::format("structure: {} structures compared in {:.2f} s", found.structures, watch.seconds()));
  if (!found.remark.empty()) tell(Level::warning, "structure: " + found.remark);
  return found;
}

}  // namespace modebank
