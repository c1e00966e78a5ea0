// The chain's stages that are about the competitors.
#include "app/chain/chain.hpp"
#include "app/chain/model_rows.hpp"

namespace modebank {

void Chain::learn_competitor_banks(const CompetitorInputs& inputs) {
  const auto learn_all = [&] {
    Competitors learned = learn_competitors(*archive_.recording, *archive_.windows, inputs, listener_);
    archive_.baseline = std::move(learned.baseline);
    archive_.noise_only = std::move(learned.noise_only);
    archive_.drifting = std::move(learned.drifting);
    archive_.nonlinear = std::move(learned.nonlinear);
  };
  const auto copy_all = [&] {
    Archive part;
    part.baseline = archive_.baseline;
    part.noise_only = archive_.noise_only;
    part.drifting = archive_.drifting;
    part.nonlinear = archive_.nonlinear;
    return part;
  };
  const auto take_all = [&](Archive&& part) {
    archive_.baseline = std::move(part.baseline);
    archive_.noise_only = std::move(part.noise_only);
    archive_.drifting = std::move(part.drifting);
    archive_.nonlinear = std::move(part.nonlinear);
  };
  archive_.terms_asked = inputs.terms != "none";
  provide(Stage::competitors, {learn_all, copy_all, take_all});
}

void Chain::forget(const std::string& filter) {
  put_rows<FilterEvaluation>(filter, {}, archive_.evaluations);
  put_rows<SummaryRow>(filter, {}, archive_.summary);
  put_rows<FreeRunRow>(filter, {}, archive_.free_runs);
  put_rows<DiagnosticsRow>(filter, {}, archive_.diagnostics);
  put_rows<ResidualTestSet>(filter, {}, archive_.residual_tests);
}

/// A run may have fewer than the one before.
void Chain::forget_competitors() {
  for (const char* filter : competitor_names) forget(filter);
}

void Chain::score_competitors(const CompetitorScoreInputs& inputs) {
  const auto score_all = [&] {
    forget_competitors();
    put(test_global(*archive_.recording, *archive_.windows, inputs.window));
    for (const char* filter : competitor_names) score(filter, competitor_filter(filter, inputs.filter), inputs.scoring);
  };
  const auto copy = [&] {
    std::vector<std::string> models(competitor_names.begin(), competitor_names.end());
    models.emplace_back("global");
    return scores_of(models, archive_);
  };
  const auto take = [&](Archive&& part) {
    forget_competitors();
    put_scores(std::move(part));
  };
  provide(Stage::competitor_scores, {score_all, copy, take});
}

}  // namespace modebank
