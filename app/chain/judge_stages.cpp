#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <iterator>

#include "app/chain/stages.hpp"
#include "app/config/free_run_check.hpp"
#include "filter/judge/combination.hpp"
#include "filter/judge/diagnostics.hpp"
#include "filter/judge/evaluate.hpp"
#include "filter/judge/horizon.hpp"
#include "filter/judge/scores.hpp"
#include "filter/judge/statistics.hpp"
#include "ident/base/work_counter.hpp"
#include "ident/fit/fit_windows.hpp"
#include "ident/fit/linearise.hpp"
#include "ident/model/residual_tests.hpp"

namespace modebank {
namespace {

/// A filter to score: `bank` itself, or another bank with the same sizes.
struct Scored {
  const std::string& name;
  const Bank& bank;
  bool chi_square_nis;  ///< whether every prediction is one Gaussian of known variance
  const std::vector<Trajectory>& runs;
  const ScoringOptions& scoring;
  const EvaluationStream* stream;
};

using Positions = std::vector<std::size_t>;

/// Splits the runs of a role, in order, into groups whose evaluations fit into memory together. A group has one run per
/// thread, or more if runs are short.
std::vector<Positions> parts_of(const std::vector<Trajectory>& runs, Role role) {
  constexpr Index samples_at_once = 200000;
  const auto threads = static_cast<std::size_t>(tbb::this_task_arena::max_concurrency());
  std::vector<Positions> parts;
  Index samples = 0;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    if (runs[i].role != role) continue;
    samples += runs[i].samples();
    if (parts.empty() || (parts.back().size() >= threads && samples > samples_at_once)) {
      parts.emplace_back();
      samples = runs[i].samples();
    }
    parts.back().push_back(i);
  }
  return parts;
}

/// Drops arrays that no judge reads. States and covariances are judged only if the truth is known. Without a sequence
/// of modes, the state array also marks the samples that have a mode.
void keep_for_judges(const Trajectory& run, RunEvaluation& e) {
  for (Eigen::MatrixXd* array : {&e.prediction, &e.mode_probability_predicted}) array->resize(0, 0);
  if (run.truth.size() > 0) return;
  e.covariance.resize(0, 0);
  if (e.viterbi_mode.size() > 0) e.state.resize(0, 0);
}

/// After a run is judged, keeps only the arrays that the stages `finding` and `confusion` read.
void keep_for_finding(const Scored& scored, const Trajectory& run, bool judged, RunEvaluation& e) {
  RunEvaluation kept;
  if (run.role == Role::train && scored.name == "bank") kept.pit = std::move(e.pit);
  if (judged) kept.log_density = std::move(e.log_density);
  if (judged && scored.name == "bank" && scored.stream->labelled) kept.mode_probability = std::move(e.mode_probability);
  e = std::move(kept);
}

template <class Row>
void append(std::vector<Row> rows, std::vector<Row>& all) {
  all.insert(all.end(), std::make_move_iterator(rows.begin()), std::make_move_iterator(rows.end()));
}

/// Evaluates the runs of a role, tests their residuals and appends the rows of scores. `evaluate` filters one run.
template <class Evaluate>
void score_role(const Scored& scored, Role role, Evaluate evaluate, FilterScores& result) {
  FilterEvaluation& said = result.evaluation;
  const auto has_role = [role](const Trajectory& run) { return run.role == role; };
  WorkCounter counter("runs filtered by " + scored.name,
                      static_cast<std::size_t>(std::count_if(scored.runs.begin(), scored.runs.end(), has_role)));
  std::vector<RunScores> scores(scored.runs.size());
  for (const Positions& part : parts_of(scored.runs, role)) {
    tbb::parallel_for(std::size_t{0}, part.size(), [&](std::size_t at) {
      const std::size_t i = part[at];
      said.runs[i] = evaluate(i);
      counter.add();
      scores[i] = score_run(said.runs[i]);
      result.residual_tests.runs[i] = test_innovations(scored.runs[i], scores[i]);
    });
    for (const std::size_t i : part) {
      if (!scored.stream) break;
      scored.stream->sink(said.filter, i, said.runs[i], said.free_runs.empty() ? nullptr : &said.free_runs[i]);
      keep_for_judges(scored.runs[i], said.runs[i]);
    }
  }
  append(summarize(scored.name, role, scored.runs, said.runs, scores), result.summary);
  append(diagnose(scored.name, role, scored.bank, scored.chi_square_nis, scored.runs, said.runs, scores),
         result.diagnostics);
}

template <class Evaluate>
FilterScores score_runs(const Scored& scored, std::vector<FreeRun> free_runs, Evaluate evaluate) {
  const std::vector<Trajectory>& runs = scored.runs;
  FilterScores result;
  FilterEvaluation& said = result.evaluation;
  said = {scored.name, std::vector<RunEvaluation>(runs.size()), std::move(free_runs), scored.stream != nullptr};
  result.residual_tests = {scored.name, std::vector<ResidualTests>(runs.size())};
  const Role judged = parts_of(runs, Role::test).empty() ? Role::train : Role::test;
  for (const Role role : {Role::train, Role::test}) {
    score_role(scored, role, evaluate, result);
    for (std::size_t i = 0; scored.stream && i < runs.size(); ++i)
      if (runs[i].role == role) keep_for_finding(scored, runs[i], role == judged, said.runs[i]);
  }
  if (!said.free_runs.empty())
    result.free_runs = summarize_free_runs(scored.name, runs, said.free_runs, scored.scoring.free_run);
  return result;
}

}  // namespace

bool streams_evaluations(const Recording& recording) {
  constexpr Index most_in_memory = 500000;  // largest number of samples; all filters' evaluations and the file's image
                                            // then need about 0.8 GB
  return recording.transitions(Role::train) + recording.transitions(Role::test) > most_in_memory;
}

std::vector<FreeRun> free_runs(const Bank& bank, const std::vector<Trajectory>& runs, const FilterOptions& filter,
                               const FreeRunOptions& options) {
  if (options.samples == 0) return {};
  std::vector<FreeRun> result(runs.size());
  tbb::parallel_for(std::size_t{0}, runs.size(),
                    [&](std::size_t i) { result[i] = free_run(bank, runs[i], filter, options); });
  return result;
}

std::vector<std::string> remarks(const std::string& filter, const std::vector<Trajectory>& runs,
                                 const std::vector<FreeRun>& free_runs) {
  std::vector<std::string> lines;
  for (std::size_t i = 0; i < free_runs.size(); ++i) {
    for (const std::string& note : free_runs[i].notes)
      if (filter == "bank")  // these remarks concern the data, so they are the same for all filters
        lines.push_back(fmt::format("free run of {}: run {} {}", filter, runs[i].run, note));
    if (const Index lost = free_runs[i].lost_paths; lost > 0)
      lines.push_back(fmt::format("free run of {}: run {}: {} sample paths left the finite range and were taken out",
                                  filter, runs[i].run, lost));
  }
  return lines;
}

FilterScores score_filter(const std::string& name, const Bank& bank, const Recording& recording,
                          const FilterOptions& filter, const ScoringOptions& scoring, const EvaluationStream* stream) {
  const std::vector<Trajectory>& runs = recording.runs;
  const bool chi_square_nis = bank.mode_count() == 1 && bank.running_noise.empty();
  check_free_run(bank.structure, scoring.free_run);
  return score_runs({name, bank, chi_square_nis, runs, scoring, stream},
                    free_runs(bank, runs, filter, scoring.free_run), [&](std::size_t i) {
                      RunEvaluation said = evaluate_run(bank, runs[i], filter);
                      draw_pit(runs[i], scoring.seed, said);
                      if (bank.running_noise.empty()) said.viterbi_mode = mode_sequence(bank, runs[i], filter);
                      return said;
                    });
}

std::optional<FilterScores> score_combined(const FilterOptions& filter, const ScoringOptions& scoring,
                                           const Archive& archive, const EvaluationStream* stream) {
  const std::vector<LearnedFilter> all = learned_filters(archive, filter);
  if (all.size() < 2) return std::nullopt;
  std::vector<std::string> names;
  for (const LearnedFilter& one : all) names.push_back(one.name);
  const std::vector<double> start = start_weights(archive.combination, 1, names);
  const std::vector<Trajectory>& runs = archive.recording->runs;
  const std::string name = combined_name;
  const Bank frame = combined_frame(all.front().bank);
  return score_runs({name, frame, false, runs, scoring, stream}, {}, [&](std::size_t i) {
    std::vector<BankFilter> filters;
    for (const LearnedFilter& one : all) filters.emplace_back(one.bank, one.options);
    CombinedFilter together(std::move(filters), start);
    RunEvaluation said = evaluate_run(frame, runs[i], together);
    draw_pit(runs[i], scoring.seed, said);
    return said;
  });
}

ResidualTestSet test_global(const Recording& recording, const WindowFits& windows, const FitOptions& window) {
  const auto motion = motion_model(window, recording.state_count(), recording.input_count());
  const Eigen::VectorXd theta = linear_global(recording, windows, motion.get()).theta;
  ResidualTestSet set{"global", std::vector<ResidualTests>(recording.runs.size())};
  tbb::parallel_for(std::size_t{0}, recording.runs.size(),
                    [&](std::size_t i) { set.runs[i] = test_residuals(recording.runs[i], windows.structure, theta); });
  return set;
}

}  // namespace modebank
