// The structure of every stage: the linear stage first, then few lags for bank, one_motion and drifting.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <functional>
#include <initializer_list>
#include <limits>
#include <utility>

#include "filter/learn/chain/stages.hpp"
#include "filter/learn/competitors/competitors.hpp"
#include "filter/learn/left_out/folds.hpp"
#include "ident/data/stretch.hpp"
#include "ident/fit/global_model.hpp"
#include "ident/lag/structure_choice.hpp"
#include "ident/lag/structure_search.hpp"
#include "modebank/base/error.hpp"

namespace modebank {
namespace {

using Rows = std::vector<StructureScore>;

LinearStructure structure_of(const StructureScore& s, const Recording& recording, const FitOptions& window) {
  return {recording.state_count(),
          recording.input_count(),
          window.intercept,
          s.state_lags,
          s.input_lags,
          window.input_delay.with_latest(s.input_delay),
          window.centre};
}

/// Whether the model takes states as measured exactly, in levels.
bool is_exact(const StructureScore& s) { return s.noise_lags == 0 && !s.differences; }

/// Position of these lags in the table, to which missing lags are added without a score.
std::size_t position_of(Rows& rows, Index state_lags, Index input_lags, Index delay) {
  const auto found = std::ranges::find_if(rows, [&](const StructureScore& s) {
    return is_exact(s) && s.state_lags == state_lags && s.input_lags == input_lags && s.input_delay == delay;
  });
  if (found != rows.end()) return static_cast<std::size_t>(found - rows.begin());
  StructureScore added{state_lags, input_lags, delay, not_a_number, not_a_number, not_a_number};
  added.rmse = Eigen::VectorXd::Constant(rows.front().rmse.size(), not_a_number);
  rows.push_back(std::move(added));
  return rows.size() - 1;
}

/// Positions in the table of these equal state and input lags, if they were searched, with the delay of one
/// linear motion and the usual one: effects of opposite sign in two modes cancel in one linear model, which may then
/// prefer a wrong delay. Runs must have enough samples before their first prediction.
std::vector<std::size_t> positions_of_equal(Rows& rows, const StructureScore& linear,
                                            std::initializer_list<Index> equal, const SearchedLags& searched) {
  std::vector<Index> delays{linear.input_delay};
  if (searched.delay && linear.input_delay != 1) delays.push_back(1);
  std::vector<std::size_t> positions;
  for (const Index delay : delays)
    for (const Index lags : equal) {
      const Index state_lags = searched.state ? lags : linear.state_lags,
                  input_lags = searched.input ? lags : linear.input_lags;
      if (searched.most_samples == 0 || std::max(state_lags, delay + input_lags - 1) <= searched.most_samples)
        positions.push_back(position_of(rows, state_lags, input_lags, delay));
    }
  return positions;
}

/// Causal log score of the training transitions from `latest` on, by the drifting model learned from them, if any.
double drifting_score(const Recording& recording, Index latest, const LinearStructure& structure,
                      const DriftingGrid& grid) {
  const Recording part = from_common_start(recording, latest - structure.first_transition());
  try {
    return learn_drifting(part, fit_global(part, structure), structure, {1}, grid).drift.tuning.log_score;
  } catch (const DataError&) {
    return -std::numeric_limits<double>::infinity();
  }
}

/// The row that `drifting` chooses: `exact` unless coefficients drift. Its candidates are then added to the rows.
std::size_t row_of_drifting(const Recording& recording, const StructureInputs& inputs, const StructureScore& linear,
                            std::size_t exact, Rows& rows) {
  constexpr Index most_asked_transitions = 20000;
  constexpr double least_drifting_gain = 0.02;  // [nats/sample]
  const Index transitions = recording.transitions(Role::train);
  if (transitions > most_asked_transitions) return exact;
  Rows candidates = rows;
  positions_of_equal(candidates, linear, {1, 2, 3, 4, 5, 6, 7, 8}, inputs.searched);
  const auto structure = [&](const StructureScore& c) { return structure_of(c, recording, inputs.window); };
  Index latest = 0;
  for (const StructureScore& c : candidates) latest = std::max(latest, structure(c).first_transition());
  const DriftingGrid coarse{{0.0, 1e-4, 1e-3, 1e-2}, {0.0, 1e-2, 1.0}, {1.0, 0.97},
                            {0.7, 0.85, 0.93, 0.97}, {0.0, 4.0, 10.0}, {1e-3}};
  DriftingGrid constant = coarse;
  constant.q = constant.p0 = {0.0};
  constant.leak = {1.0};
  const auto score = [&](const StructureScore& c, const DriftingGrid& grid) {
    return drifting_score(recording, latest, structure(c), grid);
  };
  const double of_exact = score(candidates[exact], coarse);
  if (!(of_exact >= score(candidates[exact], constant) + least_drifting_gain)) return exact;
  double highest = of_exact;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (!is_exact(candidates[i])) continue;
    candidates[i].drifting_score = i == exact ? of_exact : score(candidates[i], coarse);
    highest = std::max(highest, candidates[i].drifting_score);
  }
  const double least = highest - loss_by_chance(static_cast<double>(transitions));
  const auto size = [&](const StructureScore& c) {  // of structures that are as good as the best
    return c.drifting_score >= least ? structure(c).regressors() : std::numeric_limits<Index>::max();
  };
  const auto fewest = std::ranges::min_element(candidates, {}, size) - candidates.begin();
  rows = std::move(candidates);
  return static_cast<std::size_t>(fewest);
}

/// The row that modes, or one motion whose noise switches (`one_theta`), choose among these.
std::size_t row_of_modes(const Recording& recording, const StructureInputs& inputs,
                         const std::vector<std::size_t>& positions, std::size_t incumbent, bool one_theta, Rows& rows) {
  if (!inputs.with_modes || positions.size() < 2) return incumbent;
  std::vector<LinearStructure> structures;
  for (const std::size_t at : positions) structures.push_back(structure_of(rows[at], recording, inputs.window));
  const auto at = std::ranges::find(positions, incumbent) - positions.begin();
  const StructuresOfModes compared =
      compare_structures(recording, structures, static_cast<std::size_t>(at), one_theta, inputs.window.seed);
  for (std::size_t i = 0; i < positions.size(); ++i)
    (one_theta ? rows[positions[i]].one_motion_score : rows[positions[i]].modes_score) = compared.scores[i];
  return positions[compared.chosen];
}

}  // namespace

void choose_for_stages(const Recording& recording, const StructureInputs& inputs, FoundStructure& found) {
  Rows& rows = found.scores;
  if (rows.empty()) return;
  StructureScore& searched = *std::ranges::find_if(rows, &StructureScore::chosen);
  searched.chosen = false;
  searched.linear = true;
  const StructureScore linear = searched;
  const Index more = linear.differences ? 1 : 0, of_inputs = recording.input_count() > 0 ? more : 0;
  const std::size_t exact =
      position_of(rows, linear.state_lags + more, linear.input_lags + of_inputs, linear.input_delay);
  const std::size_t drifting = row_of_drifting(recording, inputs, linear, exact, rows);
  std::vector<std::size_t> positions{exact};
  if (!found.noisy_sensor) positions = positions_of_equal(rows, linear, {1, 2, 3, 4, 6}, inputs.searched);
  for (const std::size_t row : {exact, drifting})
    if (!found.noisy_sensor && std::ranges::find(positions, row) == positions.end()) positions.push_back(row);
  const std::size_t modes = row_of_modes(recording, inputs, positions, exact, false, rows),
                    one_motion = row_of_modes(recording, inputs, positions, exact, true, rows);
  rows[drifting].drifting = true;
  rows[modes].chosen = true;
  rows[one_motion].one_motion = true;
  found.state_lags = rows[modes].state_lags;
  found.input_lags = rows[modes].input_lags;
}

namespace {

/// Whether samples repeat too often for a density of noise. A rest, where inputs are zero, does not count.
bool is_repeated(const Recording& recording) {
  constexpr double most = 0.1;  // share of samples that equal the one before, as for comparing densities
  Index repeated = 0, samples = 0;
  for (const Trajectory& run : recording.runs)
    for (Index k = 1; k < run.samples() && run.role == Role::train; ++k) {
      const auto same = run.states().col(k).array() == run.states().col(k - 1).array();
      if (recording.input_count() > 0 && same.all() && run.inputs().col(k).isZero(0.0)) continue;
      ++samples;
      repeated += same.any();
    }
  return static_cast<double>(repeated) > most * static_cast<double>(samples);
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
  for (const Trajectory& run : recording.runs) {
    if (run.role != Role::train) continue;
    lost += std::min(run.transitions(), memory - 1);
    ++runs;
  }
  if (runs < fewest_whole_runs) lost *= 5;  // the stretches of a run
  return 4 * lost <= recording.transitions(Role::train) && (most == 0 || memory <= most);
}

/// The linear stage (ident/lag/linear_stage.hpp) on recordings whose structure is searched as a whole. Empty where it
/// does not apply, and where the lags of an ARX explain the runs best: then they are searched by least squares.
std::optional<FoundStructure> linear_structure_of(const Recording& recording, const StructureInputs& inputs,
                                                  const Tell& tell) {
  const SearchedLags& searched = inputs.searched;
  const bool acted_on = recording.input_count() > 0;
  if (!searched.state || (acted_on && !(searched.input && searched.delay)) || is_repeated(recording)) return {};
  const LinearStage stage =
      find_linear_stage(recording, {.intercept = inputs.window.intercept, .least_delay = least_delays(recording)});
  if (stage.candidates.empty() || stage.fit().order.noise_lags == 0) return {};
  const ArmaxFit& fit = stage.fit();
  const double rounding = std::numeric_limits<double>::epsilon() * recording.runs.front().states().norm();
  if (!leaves_enough(recording, fit, searched.most_samples) || fit.S.trace() < rounding * rounding) return {};
  // States the answer before stages choose among few lags, which takes most of the time.
  const Bank bank = bank_of(recording, fit, std::nullopt);
  const StepResponse& response = bank.modes.front().response.value;
  const auto list = [](const Eigen::MatrixXd& of) { return fmt::join(of.data(), of.data() + of.size(), ", "); };
  tell(Level::progress,
       fmt::format("linear model: {} state and {} noise lags{}; gain {:.4g}, 63 % after {:.4g} s", fit.order.state_lags,
                   fit.order.noise_lags, fit.order.differences ? ", in differences" : "", list(response.gain),
                   list(response.response_s)));
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
  found.noisy_sensor = !found.differences && has_noisy_sensor(bank.R.diagonal(), bank.noise_variance());
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
