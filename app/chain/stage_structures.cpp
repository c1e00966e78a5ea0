#include "app/chain/stage_structures.hpp"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <vector>

#include "filter/learn/competitors/drifting.hpp"
#include "filter/learn/refine/structure_score.hpp"
#include "ident/base/not_a_number.hpp"
#include "ident/lag/structure_choice.hpp"

namespace modebank {
namespace {

constexpr Index most_asked_transitions = 20000, most_equal_lags = 8;
constexpr double least_drifting_gain = 0.02;  // [nats/sample]

LinearStructure structure_of(const StructureScore& s, const Recording& recording, const FitOptions& window) {
  return {
      recording.state_count(), recording.input_count(), window.intercept, s.state_lags, s.input_lags, s.input_delay};
}

class DriftingChoice {
 public:
  DriftingChoice(const Recording& recording, const FitOptions& window, Index latest)
      : recording_(recording), window_(window), latest_(latest) {}

  /// Minus infinity where it cannot be learned.
  double score(const StructureScore& of, const DriftingGrid& grid) const {
    return drifting_training_score(recording_, latest_, structure_of(of, recording_, window_), TimeSteps::single, grid);
  }

 private:
  const Recording& recording_;
  const FitOptions& window_;
  Index latest_;
};

using Rows = std::vector<StructureScore>;
using Flag = bool StructureScore::*;

StructureScore& marked(Rows& rows, Flag flag) {
  return *std::find_if(rows.begin(), rows.end(), [&](const StructureScore& s) { return s.*flag; });
}

void mark(Rows& rows, Flag flag, std::size_t at) {
  for (StructureScore& s : rows) s.*flag = false;
  rows[at].*flag = true;
}

/// Where the table has these lags; they are added to it where it has them not, without a score.
std::size_t position_of(Rows& rows, Index state_lags, Index input_lags, Index delay) {
  const auto found = std::find_if(rows.begin(), rows.end(), [&](const StructureScore& s) {
    return s.state_lags == state_lags && s.input_lags == input_lags && s.input_delay == delay;
  });
  if (found != rows.end()) return static_cast<std::size_t>(found - rows.begin());
  StructureScore added{state_lags, input_lags, delay, not_a_number, not_a_number, not_a_number};
  added.rmse = Eigen::VectorXd::Constant(rows.front().rmse.size(), not_a_number);
  rows.push_back(std::move(added));
  return rows.size() - 1;
}

/// As many lags of the states as of the inputs, of those that are searched for.
std::size_t position_of_equal(Rows& rows, Index lags, Index delay, const SearchedLags& searched,
                              const StructureScore& like) {
  return position_of(rows, searched.state ? lags : like.state_lags, searched.input ? lags : like.input_lags, delay);
}

/// The delay of one linear motion, and the usual one: effects of an input that differ in sign between modes cancel in
/// one model of all of them, which then takes a later sample of that input.
std::vector<Index> delays_of(const StructureScore& linear, const SearchedLags& searched) {
  constexpr Index usual = 1;
  std::vector<Index> delays{linear.input_delay};
  if (searched.delay && linear.input_delay != usual) delays.push_back(usual);
  return delays;
}

Index memory_of(const StructureScore& s) { return std::max(s.state_lags, s.input_delay + s.input_lags - 1); }

void let_drifting_choose(const Recording& recording, const StructureInputs& inputs, Rows& rows) {
  const Index transitions = recording.transitions(Role::train);
  if (transitions > most_asked_transitions) return;
  Rows candidates = rows;
  const StructureScore best = rows.front();
  for (const Index delay : delays_of(marked(rows, &StructureScore::linear), inputs.searched))
    for (Index lags = 1; lags <= most_equal_lags; ++lags)
      position_of_equal(candidates, lags, delay, inputs.searched, best);
  if (inputs.searched.most_samples > 0)
    std::erase_if(candidates, [&](const StructureScore& c) { return memory_of(c) > inputs.searched.most_samples; });
  Index latest = 0;
  for (const StructureScore& c : candidates)
    latest = std::max(latest, structure_of(c, recording, inputs.window).first_transition());
  const DriftingChoice choice(recording, inputs.window, latest);
  DriftingGrid constant = coarse_drifting_grid();
  constant.q = constant.p0 = {0.0};
  constant.leak = {1.0};
  StructureScore& of_linear = marked(candidates, &StructureScore::linear);
  of_linear.drifting_score = choice.score(of_linear, coarse_drifting_grid());
  if (!(of_linear.drifting_score >= choice.score(of_linear, constant) + least_drifting_gain)) return;
  double highest = of_linear.drifting_score;
  for (StructureScore& c : candidates) {
    if (!c.linear) c.drifting_score = choice.score(c, coarse_drifting_grid());
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

/// Marks which of the rows at these positions modes take.
void let_modes_choose(const Recording& recording, const StructureInputs& inputs,
                      const std::vector<std::size_t>& positions, bool one_theta, Rows& rows) {
  std::vector<LinearStructure> structures;
  for (const std::size_t at : positions) structures.push_back(structure_of(rows[at], recording, inputs.window));
  const auto linear = std::find_if(positions.begin(), positions.end(), [&](std::size_t at) { return rows[at].linear; });
  const StructuresOfModes compared = compare_structures(
      recording, structures, static_cast<std::size_t>(linear - positions.begin()), one_theta, inputs.window.seed);
  for (std::size_t i = 0; i < positions.size(); ++i)
    rows[positions[i]].*(one_theta ? &StructureScore::one_motion_score : &StructureScore::modes_score) =
        compared.scores[i];
  mark(rows, one_theta ? &StructureScore::one_motion : &StructureScore::chosen, positions[compared.chosen]);
}

}  // namespace

void choose_for_stages(const Recording& recording, const StructureInputs& inputs, FoundStructure& found) {
  Rows& rows = found.scores;
  if (rows.empty()) return;
  StructureScore& of_linear = marked(rows, &StructureScore::chosen);
  of_linear.linear = of_linear.one_motion = of_linear.drifting = true;
  let_drifting_choose(recording, inputs, rows);
  std::vector<std::size_t> positions;
  const auto ask = [&](std::size_t at) {
    if (std::find(positions.begin(), positions.end(), at) == positions.end()) positions.push_back(at);
  };
  const StructureScore like = marked(rows, &StructureScore::linear);
  const Index most = inputs.searched.most_samples;
  for (const Index delay : delays_of(like, inputs.searched))
    for (const Index lags : {1, 2})
      if (most == 0 || delay + lags - 1 <= most) ask(position_of_equal(rows, lags, delay, inputs.searched, like));
  for (const Flag flag : {&StructureScore::linear, &StructureScore::drifting})
    ask(static_cast<std::size_t>(&marked(rows, flag) - rows.data()));
  if (inputs.with_modes) {
    let_modes_choose(recording, inputs, positions, false, rows);
    let_modes_choose(recording, inputs, positions, true, rows);
  }
  const StructureScore& chosen = marked(rows, &StructureScore::chosen);
  found.state_lags = chosen.state_lags;
  found.input_lags = chosen.input_lags;
  found.input_delay = chosen.input_delay;
}

}  // namespace modebank
