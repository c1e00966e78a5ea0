#include "ident/lag/structure_search.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "ident/lag/lagged_rows.hpp"
#include "ident/lag/structure_choice.hpp"
#include "ident/lag/structure_scorer.hpp"

namespace modebank {
namespace {

constexpr Index first_end = usual_lags, last_end = 30, end_step = 9;
constexpr double least_share = 0.75;  // smallest share of the transitions that a range must keep
constexpr Index rows_per_column = 2;
constexpr Index fewest_rows = 20;
constexpr int most_rounds = 4;  // largest number of rounds of one climb
constexpr std::size_t finalists = 10;

/// One delay holds for all inputs, so none may need a larger one.
Index least_of_all(const std::vector<Index>& least) {
  return least.empty() ? 0 : *std::max_element(least.begin(), least.end());
}

/// The ranges of the searched numbers, up to `most`.
StructureRanges ranges_up_to(const Recording& recording, const FitOptions& window, const SearchedLags& searched,
                             const Lags& most) {
  const bool acted_on = recording.input_count() > 0;
  const auto range = [](bool free, Index low, Index high, Index fixed) {
    return free ? LagRange{low, std::max(low, high)} : LagRange{fixed, fixed};
  };
  StructureRanges ranges{
      range(searched.state, 1, most[0], window.state_lags),
      range(searched.input && acted_on, 1, most[1], searched.input || !acted_on ? 1 : window.input_lags),
      range(searched.delay && acted_on, least_of_all(least_delays(recording)), most[2],
            searched.delay || !acted_on ? 1 : window.input_delay.latest())};
  ranges.newest = window.input_delay.with_latest(ranges.input_delay.low);
  if (searched.most_samples == 0) return ranges;
  // The configured lags may be too many for the start of a free run; that configuration is rejected elsewhere.
  const Index stated = std::max(ranges.state_lags.low, ranges.input_lags.low + ranges.input_delay.low - 1);
  ranges.memory = std::max(searched.most_samples, stated);
  ranges.state_lags.high = std::min(ranges.state_lags.high, ranges.memory);
  return ranges;
}

LinearStructure structure_of(const LaggedRows& rows, const Lags& lags) {
  return {rows.states, rows.inputs, rows.intercept, lags[0], lags[1], lags[2]};
}

bool leaves_enough(const LaggedRows& rows) {
  const StructureRanges& r = rows.ranges;
  const LinearStructure largest = structure_of(rows, {r.state_lags.high, r.input_lags.high, r.input_delay.high});
  return rows.share >= least_share && rows.count() >= rows_per_column * largest.regressors();
}

/// Least-squares scores of the structures on one set of rows. Each score is computed once.
class StructureClimb {
 public:
  StructureClimb(LaggedRows rows, const Eigen::VectorXd& quantum) : rows_(std::move(rows)), scorer_(rows_, quantum) {}
  StructureClimb(const StructureClimb&) = delete;  // must not be copied, because the scorer refers to the rows
  StructureClimb& operator=(const StructureClimb&) = delete;

  const LaggedRows& rows() const { return rows_; }
  const StructureScorer& scorer() const { return scorer_; }
  const ScoredStructures& seen() const { return seen_; }

  /// Changes one number of lags at a time while the score improves. Delays stay within least_delay and most_delay.
  void climb(Lags at, Index least_delay, Index most_delay) {
    const StructureRanges& ranges = rows_.ranges;
    const LagRange delays{std::max(least_delay, ranges.input_delay.low), std::min(most_delay, ranges.input_delay.high)};
    const std::array<LagRange, 3> range{ranges.state_lags, ranges.input_lags, delays};
    for (std::size_t i = 0; i < at.size(); ++i) at[i] = std::clamp(at[i], range[i].low, range[i].high);
    while (!holds(at) && at[1] > range[1].low) --at[1];
    if (!holds(at)) return;
    for (int round = 0; round < most_rounds; ++round) {
      const Lags before = at;
      for (const std::size_t i : {std::size_t{2}, std::size_t{0}, std::size_t{1}}) {
        std::vector<Lags> line;
        for (Index value = range[i].low; value <= range[i].high; ++value) {
          Lags other = at;
          other[i] = value;
          if (holds(other)) line.push_back(other);
        }
        at = best(line);
      }
      if (at == before) break;
    }
  }

  /// Starts from the best structure of one kind and removes one lag at a time, always the one whose removal costs
  /// least. Candidates are the oldest state lag, and the oldest and newest input lags. A climb that changes one number
  /// at a time may miss the smallest structure that is equally good.
  void prune(bool (*wanted)(const Lags&)) {
    if (select(seen_, wanted).empty()) return;
    Lags at = best_of(seen_, wanted);
    for (bool smaller = true; smaller;) {
      std::vector<Lags> line;
      for (const Lags& without :
           {Lags{at[0] - 1, at[1], at[2]}, Lags{at[0], at[1] - 1, at[2]}, Lags{at[0], at[1] - 1, at[2] + 1}})
        if (holds(without) && wanted(without)) line.push_back(without);
      smaller = !line.empty();
      if (smaller) at = best(line);
    }
  }

 private:
  LaggedRows rows_;
  StructureScorer scorer_;
  ScoredStructures seen_;

  bool holds(const Lags& lags) const { return rows_.ranges.holds(lags[0], lags[1], lags[2]); }

  /// The structure with the highest score. On a tie, the first structure with this score.
  Lags best(const std::vector<Lags>& line) {
    std::vector<Lags> fresh;
    std::copy_if(line.begin(), line.end(), std::back_inserter(fresh), [&](const Lags& l) { return !seen_.count(l); });
    std::vector<LeftOutForecast> forecasts(fresh.size());
    tbb::parallel_for(std::size_t{0}, fresh.size(),
                      [&](std::size_t i) { forecasts[i] = scorer_.least_squares(structure_of(rows_, fresh[i])); });
    for (std::size_t i = 0; i < fresh.size(); ++i) seen_.emplace(fresh[i], std::move(forecasts[i]));
    return *std::max_element(line.begin(), line.end(), [&](const Lags& a, const Lags& b) {
      return seen_.at(a).log_score < seen_.at(b).log_score;
    });
  }
};

/// Climbs from starts with few, some and many lags. Also climbs from `another`, if it is given.
void explore(StructureClimb& search, const Lags* another) {
  std::vector<Lags> starts{{1, 1, 1}, {4, 4, 1}, {8, 8, 1}};
  if (another) starts.insert(starts.begin(), *another);
  const LagRange& delays = search.rows().ranges.input_delay;
  if (delays.high > 0)
    for (const Lags& start : starts) search.climb(start, 1, delays.high);
  if (delays.high > 0) search.prune(&acts_later);
  if (delays.low > 0) return;
  if (delays.high > 0) {
    const Lags late = best_of(search.seen(), &acts_later);
    starts = {{1, 1, 0}, late, {late[0], late[1] + late[2], 0}};
  }
  for (const Lags& start : starts) search.climb(start, 0, 0);
  search.prune(&acts_at_once);
}

/// The limits of a wider search. A limit is raised if the best structure lies at the limit and the limit may be raised.
/// The other limits stay.
Lags moved_ends(const StructureClimb& search, const SearchedLags& searched, const Lags& most) {
  const Lags at = best_with_delay_rule(search.seen(), search.scorer().part_rows());
  const bool acted_on = search.rows().inputs > 0;
  const std::array<bool, 3> free{searched.state, searched.input && acted_on, searched.delay && acted_on};
  Lags moved = most;
  for (std::size_t i = 0; i < moved.size(); ++i)
    if (free[i] && at[i] >= most[i] && most[i] < last_end) moved[i] = std::min(last_end, most[i] + end_step);
  return moved;
}

/// Fits the finalists of one kind of structure with the loss of the windows.
ScoredStructures polish(const StructureClimb& search, const std::vector<Lags>& chosen, const FitOptions& window) {
  std::vector<LeftOutForecast> forecasts(chosen.size());
  tbb::parallel_for(std::size_t{0}, chosen.size(), [&](std::size_t i) {
    forecasts[i] = search.scorer().robust(structure_of(search.rows(), chosen[i]), window);
  });
  ScoredStructures polished;
  for (std::size_t i = 0; i < chosen.size(); ++i) polished.emplace(chosen[i], std::move(forecasts[i]));
  return polished;
}

FoundStructure settle(const StructureClimb& search, const FitOptions& window) {
  const StructureSize size{search.rows().states, search.rows().inputs};
  const Eigen::VectorXd& weight = search.scorer().part_rows();
  const ScoredStructures late = select(search.seen(), &acts_later), at_once = select(search.seen(), &acts_at_once);
  ScoredStructures polished = polish(search, finalists_of(late, size, weight, finalists), window);
  if (!at_once.empty() && (late.empty() || gains_enough(at_once, late, weight))) {
    ScoredStructures others = polish(search, finalists_of(at_once, size, weight, finalists), window);
    if (late.empty() || gains_enough(others, polished, weight)) polished = std::move(others);
  }
  const Lags chosen = smallest_as_good(polished, size, weight);
  FoundStructure found{chosen[0], chosen[1], window.input_delay.with_latest(chosen[2]), search.rows().count(),
                       search.rows().parts.count};
  found.by_runs = search.rows().parts.by_runs;
  found.structures = static_cast<std::ptrdiff_t>(search.seen().size());
  found.scores = score_table(polished, chosen, weight);
  return found;
}

/// The structure of `window`, with the smallest value of each searched number.
FoundStructure nothing_found(const StructureRanges& ranges, const std::string& remark) {
  const Index later = std::max(Index{1}, ranges.input_delay.low);
  FoundStructure found{ranges.state_lags.low, ranges.input_lags.low,
                       ranges.input_delay.holds(later) ? ranges.newest.with_latest(later) : ranges.newest};
  found.remark = remark;
  return found;
}

std::string cut_remark(const Lags& most) {
  return "searched up to " + std::to_string(most[0]) +
         " lags only; with more lags, fewer than three quarters of the transitions or fewer than two per coefficient "
         "would remain";
}

}  // namespace

std::vector<Index> least_delays(const Recording& recording) {
  std::vector<Index> least;
  for (Index i = 0; i < recording.input_count(); ++i) {
    Index moving = 0, repeated = 0;
    for (const Trajectory& run : recording.runs)
      for (Index k = 1; k < run.samples() && run.role == Role::train; ++k) {
        if (run.states().col(k) == run.states().col(k - 1)) continue;
        ++moving;
        repeated += run.inputs()(i, k) == run.inputs()(i, k - 1);
      }
    least.push_back(2 * repeated > moving ? 0 : 1);
  }
  return least;
}

FoundStructure find_structure(const Recording& recording, const FitOptions& window, const SearchedLags& searched) {
  const auto rows_up_to = [&](const Lags& most) {
    return make_lagged_rows(recording, ranges_up_to(recording, window, searched, most), window.intercept);
  };
  Lags most{first_end, first_end, first_end};
  LaggedRows rows = rows_up_to(most);
  while (!leaves_enough(rows) && most[0] > 1) {
    for (Index& end : most) end = end > 6 ? end - 2 : end - 1;
    rows = rows_up_to(most);
  }
  if (rows.count() < fewest_rows)
    return nothing_found(rows.ranges, "no search: only " + std::to_string(rows.count()) +
                                          " transitions of the training runs are complete");
  std::string remark = most[0] < first_end ? cut_remark(most) : "";
  auto search = std::make_unique<StructureClimb>(std::move(rows), recording.quantum);
  explore(*search, nullptr);
  for (Lags moved = moved_ends(*search, searched, most); remark.empty() && moved != most;
       moved = moved_ends(*search, searched, most)) {
    LaggedRows wider = rows_up_to(moved);
    if (!leaves_enough(wider)) {
      remark = cut_remark(most);
      break;
    }
    const Lags best = best_with_delay_rule(search->seen(), search->scorer().part_rows());
    most = moved;
    search = std::make_unique<StructureClimb>(std::move(wider), recording.quantum);
    explore(*search, &best);
  }
  FoundStructure found = settle(*search, window);
  found.remark = remark;
  return found;
}

}  // namespace modebank
