// Scores of filters: of filters that the chain learned, and of filters from another archive.
#include <fmt/format.h>

#include "app/chain/chain.hpp"
#include "app/chain/model_rows.hpp"
#include "app/chain/stored_banks.hpp"
#include "app/text/mode_names.hpp"

namespace modebank {

std::optional<EvaluationStream> Chain::stream_to_sink() const {
  if (!sink_) return {};
  return EvaluationStream{*sink_, archive_.labels.has_value()};
}

void Chain::score(const std::string& filter, const FilterOptions& options, const ScoringOptions& scoring) {
  const std::optional<EvaluationStream> stream = stream_to_sink();
  if (const std::optional<Bank> bank = archive_.bank_of(filter))
    put(score_filter(filter, *bank, *archive_.recording, options, scoring, stream ? &*stream : nullptr));
}

/// Computes the scores of predictions several steps ahead, the scores of combined filters, and the finding.
void Chain::conclude(const FilterOptions& filter, const ScoringOptions& scoring) {
  score_ahead(filter, scoring, archive_);
  forget(combined_name);
  const std::optional<EvaluationStream> stream = stream_to_sink();
  if (std::optional<FilterScores> together = score_combined(filter, scoring, archive_, stream ? &*stream : nullptr))
    put(std::move(*together));
  warn_of_free_runs();
  archive_.finding = find_modes(archive_);
  archive_.confusion = confusion_of(archive_);
}

void Chain::put(FilterScores scores) {
  const std::string filter = scores.evaluation.filter;
  if (!scores.residual_tests.runs.empty()) put(std::move(scores.residual_tests));
  std::vector<FilterEvaluation> evaluation;
  evaluation.push_back(std::move(scores.evaluation));
  put_rows(filter, std::move(evaluation), archive_.evaluations);
  put_rows(filter, std::move(scores.summary), archive_.summary);
  put_rows(filter, std::move(scores.free_runs), archive_.free_runs);
  put_rows(filter, std::move(scores.diagnostics), archive_.diagnostics);
}

void Chain::put(ResidualTestSet tests) {
  const std::string model = tests.model;
  std::vector<ResidualTestSet> set;
  set.push_back(std::move(tests));
  put_rows(model, std::move(set), archive_.residual_tests);
}

void Chain::put_scores(Archive&& part) {
  put_back_recording(part, archive_);
  for (FilterEvaluation& evaluation : part.evaluations) {
    const std::string filter = evaluation.filter;
    put({std::move(evaluation), rows_out_of(part.summary, {filter}), rows_out_of(part.diagnostics, {filter}),
         rows_out_of(part.free_runs, {filter})});
  }
  for (ResidualTestSet& tests : part.residual_tests) put(std::move(tests));
}

void Chain::warn_of_free_runs() const {
  for (const FilterEvaluation& evaluation : archive_.evaluations)
    for (const std::string& line : remarks(evaluation.filter, archive_.recording->runs, evaluation.free_runs))
      tell_(Level::warning, line);
}

void Chain::forget(const std::string& filter) {
  put_rows<FilterEvaluation>(filter, {}, archive_.evaluations);
  put_rows<SummaryRow>(filter, {}, archive_.summary);
  put_rows<FreeRunRow>(filter, {}, archive_.free_runs);
  put_rows<DiagnosticsRow>(filter, {}, archive_.diagnostics);
  put_rows<ResidualTestSet>(filter, {}, archive_.residual_tests);
}

/// A run may have fewer competitors than the run before, so the old results are removed.
void Chain::forget_competitors() {
  for (const char* filter : competitor_names) forget(filter);
}

void Chain::score_competitors(const CompetitorScoreInputs& inputs) {
  const auto score_all = [&] {
    forget_competitors();
    put(test_global(*archive_.recording, *archive_.windows, inputs.window));
    for (const char* filter : competitor_names) score(filter, competitor_filter(filter), inputs.scoring);
  };
  const auto give = [&] {
    std::vector<std::string> models(competitor_names.begin(), competitor_names.end());
    models.emplace_back("global");
    return scores_out_of(archive_, models);
  };
  const auto take = [&](Archive&& part) {
    forget_competitors();
    put_scores(std::move(part));
  };
  provide(Stage::competitor_scores, {score_all, give, take});
}

void Chain::judge(const ChainInputs& inputs) {
  const Stopwatch watch;
  score_competitors(inputs.competitor_scores);
  const auto score_bank = [&] { score("bank", inputs.bank_scores.filter, inputs.bank_scores.scoring); };
  const auto give = [&] { return scores_out_of(archive_, {"bank"}); };
  provide(Stage::bank_scores, {score_bank, give, [&](Archive&& part) { put_scores(std::move(part)); }});
  conclude(inputs.bank_scores.filter, inputs.bank_scores.scoring);
  tell_(Level::progress,
        fmt::format("evaluation: {} filters in {:.2f} s", archive_.evaluations.size(), watch.seconds()));
}

const Archive& Chain::judge_stored(const std::filesystem::path& banks, const ChainOptions& options,
                                   const Execution& execution, const EvaluationSink* sink) {
  sink_ = sink;
  wanted_ = stage_keys(chain_inputs(options), "");
  import({options.data});
  const Stopwatch watch;
  // For a single model (`FilterVariant::kf`) this reads the global model, as the stages of learning do.
  StoredBanks stored = read_banks(banks, *archive_.recording, options.filter.variant == FilterVariant::kf, tell_);
  archive_.bank = std::move(stored.bank);
  archive_.baseline = std::move(stored.baseline);
  archive_.noise_only = std::move(stored.noise_only);
  archive_.one_motion = std::move(stored.one_motion);
  archive_.drifting = std::move(stored.drifting);
  archive_.nonlinear = std::move(stored.nonlinear);
  archive_.terms_asked = stored.terms_asked;
  archive_.unrefined = std::move(stored.unrefined);
  archive_.measured_fit = stored.measured_fit;
  archive_.left_out = std::move(stored.left_out);
  const ScoringOptions scoring = scoring_inputs(options);
  score("bank", options.filter, scoring);
  for (const char* filter : competitor_names) score(filter, competitor_filter(filter), scoring);
  conclude(options.filter, scoring);
  archive_.mode_names =
      mode_names_of(archive_, options.mode_names.empty() ? stored.mode_names : options.mode_names, tell_);
  tell_(Level::progress,
        fmt::format("evaluation: {} filters in {:.2f} s", archive_.evaluations.size(), watch.seconds()));
  describe(execution, {describe_file(banks)});
  return archive_;
}

}  // namespace modebank
