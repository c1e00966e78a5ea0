#include "app/chain/chain.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "app/chain/stored_banks.hpp"
#include "io/import/import.hpp"

namespace modebank {
namespace {

/// The order of models in the rows of an archive.
constexpr std::array<std::string_view, 6> model_order{"global",     "bank",       "baseline",
                                                      "noise_only", "one_motion", "drifting"};

template <class Row>
const std::string& model_of(const Row& row) {
  if constexpr (std::is_same_v<Row, ResidualTestSet>)
    return row.model;
  else
    return row.filter;
}

/// Replaces the rows of a model.
template <class Row>
void put_rows(const std::string& model, std::vector<Row> rows, std::vector<Row>& all) {
  std::erase_if(all, [&](const Row& row) { return model_of(row) == model; });
  all.insert(all.end(), std::make_move_iterator(rows.begin()), std::make_move_iterator(rows.end()));
  const auto rank = [](const Row& row) { return std::find(model_order.begin(), model_order.end(), model_of(row)); };
  std::stable_sort(all.begin(), all.end(), [&](const Row& a, const Row& b) { return rank(a) < rank(b); });
}

template <class Row>
std::vector<Row> rows_of(const std::vector<std::string>& models, const std::vector<Row>& all) {
  std::vector<Row> rows;
  for (const Row& row : all)
    if (std::find(models.begin(), models.end(), model_of(row)) != models.end()) rows.push_back(row);
  return rows;
}

/// Everything that was found out about these models.
Archive scores_of(const std::vector<std::string>& models, const Archive& archive) {
  Archive part;
  part.recording = archive.recording;
  part.evaluations = rows_of(models, archive.evaluations);
  part.summary = rows_of(models, archive.summary);
  part.horizons = rows_of(models, archive.horizons);
  part.free_runs = rows_of(models, archive.free_runs);
  part.diagnostics = rows_of(models, archive.diagnostics);
  part.residual_tests = rows_of(models, archive.residual_tests);
  return part;
}

}  // namespace

void Chain::provide(Stage stage, const StagePart& part) {
  std::string& held = held_[index_of(stage)];
  const std::string& wanted = wanted_[index_of(stage)];
  if (held == wanted) return;
  held.clear();  // if this throws, what is there belongs to no run
  const Stopwatch watch;
  source_.provide(stage, wanted, part);
  seconds_[index_of(stage)] = watch.seconds();
  held = wanted;
  listener_.done(stage, archive_);
}

const Archive& Chain::run(const ChainOptions& options, Stage last, const Execution& execution) {
  seconds_.fill(0.0);
  const ChainInputs inputs = chain_inputs(options);
  wanted_ = stage_keys(inputs, "");  // what the data hold is known when they are read
  import(inputs.data);
  const std::string data_key = wanted_[index_of(Stage::data)];
  wanted_ = stage_keys(inputs, data_.data_hash);
  wanted_[index_of(Stage::data)] = data_key;
  if (last >= Stage::windows) identify_windows(inputs.windows);
  if (last >= Stage::mixture) cluster_windows(inputs.mixture);
  if (last >= Stage::bank) learn_bank(inputs);
  if (last >= Stage::bank_scores)
    judge(inputs);
  else if (archive_.windows)
    put(test_global(*archive_.recording, *archive_.windows, inputs.windows.window));
  describe(execution, mixture_files_);
  return archive_;
}

void Chain::import(const DataInputs& inputs) {
  const auto compute = [&] {
    const Stopwatch watch;
    data_ = import_data(inputs.data);
    for (const std::string& note : data_.notes) listener_.warning(note);
    archive_.recording = std::move(data_.recording);
    archive_.lag = std::move(data_.lag);
    listener_.progress(fmt::format("import: {} runs, {} training and {} test transitions in {:.2f} s",
                                   archive_.recording->runs.size(), archive_.recording->transitions(Role::train),
                                   archive_.recording->transitions(Role::test), watch.seconds()));
  };
  const auto copy = [&] {
    Archive part;
    part.recording = archive_.recording;
    part.lag = archive_.lag;
    part.provenance.inputs = data_.files;
    part.provenance.data_hash = data_.data_hash;
    return part;
  };
  const auto take = [&](Archive&& part) {
    archive_.recording = std::move(part.recording);
    archive_.lag = std::move(part.lag);
    data_.files = std::move(part.provenance.inputs);
    data_.data_hash = std::move(part.provenance.data_hash);
  };
  provide(Stage::data, {compute, copy, take});
}

void Chain::identify_windows(const WindowInputs& inputs) {
  const auto compute = [&] {
    const Stopwatch watch;
    archive_.windows = identify(*archive_.recording, inputs);
    listener_.progress(fmt::format("windows: {} fitted in {:.2f} s", archive_.windows->count(), watch.seconds()));
  };
  const auto copy = [&] {
    Archive part;
    part.recording = archive_.recording;
    part.windows = archive_.windows;
    return part;
  };
  provide(Stage::windows, {compute, copy, [&](Archive&& part) { archive_.windows = std::move(part.windows); }});
}

void Chain::cluster_windows(const MixtureInputs& inputs) {
  const std::string& start = inputs.start_file;
  const auto compute = [&] {
    archive_.mixture = cluster(*archive_.recording, *archive_.windows, inputs, listener_);
    mixture_files_.clear();
    if (!start.empty()) mixture_files_.push_back(describe_file(start));
  };
  const auto copy = [&] {
    Archive part;
    part.mixture = archive_.mixture;
    part.provenance.inputs = mixture_files_;
    return part;
  };
  const auto take = [&](Archive&& part) {
    archive_.mixture = std::move(part.mixture);
    mixture_files_ = std::move(part.provenance.inputs);
  };
  provide(Stage::mixture, {compute, copy, take});
}

void Chain::learn_bank(const ChainInputs& inputs) {
  const Stopwatch watch;
  const auto learn_all = [&] {
    Competitors learned = learn_competitors(*archive_.recording, *archive_.windows,
                                            archive_.mixture->mixture.components(), inputs.competitors, listener_);
    archive_.baseline = std::move(learned.baseline);
    archive_.noise_only = std::move(learned.noise_only);
    archive_.one_motion = std::move(learned.one_motion);
    archive_.drifting = std::move(learned.drifting);
  };
  const auto copy_all = [&] {
    Archive part;
    part.baseline = archive_.baseline;
    part.noise_only = archive_.noise_only;
    part.one_motion = archive_.one_motion;
    part.drifting = archive_.drifting;
    return part;
  };
  const auto take_all = [&](Archive&& part) {
    archive_.baseline = std::move(part.baseline);
    archive_.noise_only = std::move(part.noise_only);
    archive_.one_motion = std::move(part.one_motion);
    archive_.drifting = std::move(part.drifting);
  };
  provide(Stage::competitors, {learn_all, copy_all, take_all});

  const auto learn = [&] {
    LearnedBank learned = learn_modes({*archive_.recording, *archive_.windows, *archive_.mixture, *archive_.baseline},
                                      inputs.bank, listener_);
    archive_.bank = std::move(learned.bank);
    archive_.unrefined = std::move(learned.unrefined);
    archive_.measured_fit = learned.measured_fit;
    archive_.merging = std::move(learned.merging);
    listener_.progress(fmt::format("bank: {} modes, {} screened, in {:.2f} s", archive_.bank->mode_count(),
                                   archive_.bank->screened.size(), watch.seconds()));
  };
  const auto copy = [&] {
    Archive part;
    part.bank = archive_.bank;
    part.unrefined = archive_.unrefined;
    part.measured_fit = archive_.measured_fit;
    part.merging = archive_.merging;
    return part;
  };
  const auto take = [&](Archive&& part) {
    archive_.bank = std::move(part.bank);
    archive_.unrefined = std::move(part.unrefined);
    archive_.measured_fit = part.measured_fit;
    archive_.merging = std::move(part.merging);
  };
  provide(Stage::bank, {learn, copy, take});
}

void Chain::score(const std::string& filter, const FilterOptions& options, const ScoringOptions& scoring) {
  if (filter == "drifting" && archive_.drifting)
    put(score_drifting(*archive_.drifting, *archive_.recording, options.time_steps, scoring));
  else if (const std::optional<Bank> bank = archive_.bank_of(filter))
    put(score_filter(filter, *bank, *archive_.recording, options, scoring));
}

void Chain::put(FilterScores scores) {
  const std::string filter = scores.evaluation.filter;
  for (const std::string& line : remarks(filter, archive_.recording->runs, scores.evaluation.free_runs))
    listener_.warning(line);
  put(test_filter(*archive_.recording, scores.evaluation));
  std::vector<FilterEvaluation> evaluation;
  evaluation.push_back(std::move(scores.evaluation));
  put_rows(filter, std::move(evaluation), archive_.evaluations);
  put_rows(filter, std::move(scores.summary), archive_.summary);
  put_rows(filter, std::move(scores.horizons), archive_.horizons);
  put_rows(filter, std::move(scores.free_runs), archive_.free_runs);
  put_rows(filter, std::move(scores.diagnostics), archive_.diagnostics);
}

void Chain::put(ResidualTestSet tests) {
  const std::string model = tests.model;
  put_rows(model, {std::move(tests)}, archive_.residual_tests);
}

/// A run may have fewer than the one before.
void Chain::forget_competitors() {
  for (const char* filter : competitor_names) {
    put_rows<FilterEvaluation>(filter, {}, archive_.evaluations);
    put_rows<SummaryRow>(filter, {}, archive_.summary);
    put_rows<HorizonRow>(filter, {}, archive_.horizons);
    put_rows<FreeRunRow>(filter, {}, archive_.free_runs);
    put_rows<DiagnosticsRow>(filter, {}, archive_.diagnostics);
    put_rows<ResidualTestSet>(filter, {}, archive_.residual_tests);
  }
}

void Chain::judge(const ChainInputs& inputs) {
  const Stopwatch watch;
  const auto take = [&](Archive&& part) {
    for (FilterEvaluation& evaluation : part.evaluations) {
      const std::string filter = evaluation.filter;
      put({std::move(evaluation), rows_of({filter}, part.summary), rows_of({filter}, part.horizons),
           rows_of({filter}, part.diagnostics), rows_of({filter}, part.free_runs)});
    }
    for (ResidualTestSet& tests : part.residual_tests) put(std::move(tests));
  };
  const auto take_competitors = [&](Archive&& part) {
    forget_competitors();
    take(std::move(part));
  };
  const CompetitorScoreInputs& competitors = inputs.competitor_scores;
  const auto score_competitors = [&] {
    forget_competitors();
    put(test_global(*archive_.recording, *archive_.windows, competitors.window));
    for (const char* filter : competitor_names)
      score(filter, competitor_filter(filter, competitors.filter), competitors.scoring);
  };
  const auto copy_competitors = [&] {
    std::vector<std::string> models(competitor_names.begin(), competitor_names.end());
    models.emplace_back("global");
    return scores_of(models, archive_);
  };
  provide(Stage::competitor_scores, {score_competitors, copy_competitors, take_competitors});

  const auto score_bank = [&] { score("bank", inputs.bank_scores.filter, inputs.bank_scores.scoring); };
  provide(Stage::bank_scores, {score_bank, [&] { return scores_of({"bank"}, archive_); }, take});
  archive_.finding = find_modes(archive_);
  listener_.progress(fmt::format("evaluation: {} filters in {:.2f} s", archive_.evaluations.size(), watch.seconds()));
}

const Archive& Chain::judge_stored(const std::filesystem::path& banks, const ChainOptions& options,
                                   const Execution& execution) {
  wanted_ = stage_keys(chain_inputs(options), "");
  import({options.data});
  const Stopwatch watch;
  // One model is the global one, as where banks are learned.
  StoredBanks stored = read_banks(banks, *archive_.recording, options.filter.variant == FilterVariant::kf, listener_);
  archive_.bank = std::move(stored.bank);
  archive_.baseline = std::move(stored.baseline);
  archive_.noise_only = std::move(stored.noise_only);
  archive_.one_motion = std::move(stored.one_motion);
  archive_.drifting = std::move(stored.drifting);
  archive_.unrefined = std::move(stored.unrefined);
  archive_.measured_fit = stored.measured_fit;
  const ScoringOptions scoring = scoring_inputs(options);
  score("bank", options.filter, scoring);
  for (const char* filter : competitor_names) score(filter, competitor_filter(filter, options.filter), scoring);
  archive_.finding = find_modes(archive_);
  listener_.progress(fmt::format("evaluation: {} filters in {:.2f} s", archive_.evaluations.size(), watch.seconds()));
  describe(execution, {describe_file(banks)});
  return archive_;
}

void Chain::describe(const Execution& execution, const std::vector<InputFile>& more_files) {
  archive_.config = execution.config;
  archive_.provenance = execution.provenance;
  archive_.provenance.data_hash = data_.data_hash;
  archive_.provenance.inputs = data_.files;
  archive_.provenance.inputs.insert(archive_.provenance.inputs.end(), more_files.begin(), more_files.end());
}

}  // namespace modebank
