#include "app/pipeline.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "app/summary_text.hpp"
#include "filter/bank_frame.hpp"
#include "filter/diagnostics.hpp"
#include "filter/evaluate.hpp"
#include "filter/horizon.hpp"
#include "filter/innovation_tests.hpp"
#include "filter/learn.hpp"
#include "filter/scores.hpp"
#include "filter/smoother.hpp"
#include "ident/error.hpp"
#include "ident/fit_window.hpp"
#include "ident/linearise.hpp"
#include "ident/model_choice.hpp"
#include "ident/residual_tests.hpp"
#include "ident/seed.hpp"
#include "io/import.hpp"
#include "mixture/criteria.hpp"
#include "mixture/features.hpp"
#include "mixture/select.hpp"

namespace modebank::app {
namespace {

class Stopwatch {
 public:
  double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

std::vector<RunEvaluation> evaluate_runs(const Bank& bank, const std::vector<Trajectory>& runs,
                                         const FilterOptions& options, bool smooth) {
  std::vector<RunEvaluation> evaluations(runs.size());
  tbb::parallel_for(std::size_t{0}, runs.size(), [&](std::size_t i) {
    evaluations[i] = evaluate_run(bank, runs[i], options);
    if (smooth) smooth_run(bank, runs[i], options, evaluations[i]);
  });
  return evaluations;
}

std::vector<HorizonEvaluation> look_ahead(const Bank& bank, const std::vector<Trajectory>& runs,
                                          const FilterOptions& options, const std::vector<Index>& horizons) {
  std::vector<HorizonEvaluation> evaluations(runs.size());
  tbb::parallel_for(std::size_t{0}, runs.size(),
                    [&](std::size_t i) { evaluations[i] = evaluate_horizons(bank, runs[i], options, horizons); });
  return evaluations;
}

/// The global model of the windows in linear terms, whatever they were fitted with.
GlobalModel linear_global(const Config& config, const Archive& archive) {
  const Recording& recording = *archive.recording;
  const auto motion = motion_model(config.window, recording.state_count(), recording.input_count());
  const GlobalModel& global = archive.windows->global;
  return motion ? linearise(*motion, global, operating_point(recording)) : global;
}

/// The one seed reaches the windows' samples, too.
FitOptions window_options(const Config& config) {
  FitOptions options = config.window;
  options.seed = config.job.seed;
  return options;
}

bool trained_on(const Recording& recording, const Trajectory& run) {
  return std::any_of(recording.runs.begin(), recording.runs.end(), [&](const Trajectory& other) {
    return other.role == Role::train && other.samples() == run.samples() && other.state == run.state &&
           other.input == run.input;
  });
}

}  // namespace

namespace {

/// Over the samples that have a prediction, as in the summary.
double mean_log_score(const Bank& bank, const Recording& recording, Role role, const FilterOptions& options) {
  double sum = 0.0;
  Index scored = 0;
  for (const Trajectory& run : recording.runs) {
    if (run.role != role) continue;
    for (const double score : log_densities(bank, run, options)) {
      if (std::isnan(score)) continue;
      sum += score;
      ++scored;
    }
  }
  return sum / static_cast<double>(scored);
}

/// The bank, refined if so configured.
Refinement learn_modes_of(const Config& config, const Eigen::MatrixXd& R, const MotionModel* motion,
                          const Archive& archive) {
  BankOptions options = config.bank;
  options.em.seed = config.job.seed;
  if (options.refine == Refine::em)
    return learn_refined_bank(*archive.recording, *archive.windows, *archive.mixture, options, R, config.filter);
  return {learn_bank(*archive.recording, *archive.windows, *archive.mixture, options, R, motion), {}, {}, {}, {}};
}

/// What a limit on the number of modes cost: the same bank without it, on the runs that were held out.
void report_merging(const Config& config, const Eigen::MatrixXd& R, const MotionModel* motion, const Archive& archive) {
  const Index components = archive.mixture->mixture.components(), limit = config.bank.modes;
  if (limit == 0 || components <= limit) return;
  const Recording& recording = *archive.recording;
  Config unlimited = config;
  unlimited.bank.modes = 0;
  const Role role = recording.transitions(Role::test) > 0 ? Role::test : Role::train;
  const Bank whole = learn_modes_of(unlimited, R, motion, archive).bank;
  const double before = mean_log_score(whole, recording, role, config.filter);
  const double after = mean_log_score(*archive.bank, recording, role, config.filter);
  spdlog::info("bank.modes: {} components merged into {}: log score on {} runs {:.4f} -> {:.4f} ({:+.4f})", components,
               limit, role == Role::test ? "held-out" : "training", before, after, after - before);
}

void report_refinement(const Refinement& refined) {
  for (const RefineCandidate& c : refined.candidates)
    spdlog::info(
        "refine: {:<12} {:>3} modes, shared {}, Q prior {}: {:.4f} nats/sample left out, after {} iterations{}",
        c.start, c.modes, name_of(c.shared), c.noise_transitions, c.score, c.iterations, c.selected ? " (chosen)" : "");
  const MeasurementStage& measured = refined.measurement;
  if (!std::isnan(measured.score))
    spdlog::info("refine: {} iterations with measurement noise: {:.4f} -> {:.4f} nats/sample left out",
                 measured.iterations, measured.score_before, measured.score);
  const Averaging& averaged = refined.averaging;
  if (!std::isnan(averaged.score))
    spdlog::info("refine: {} fits averaged: {:.4f} -> {:.4f} nats/sample left out", averaged.members,
                 averaged.score_before, averaged.score);
}

void learn_modes(const Config& config, const Eigen::MatrixXd& R, const MotionModel* motion, Archive& archive) {
  Refinement learned = learn_modes_of(config, R, motion, archive);
  archive.bank = std::move(learned.bank);
  if (config.bank.refine == Refine::em) archive.unrefined = std::move(learned.start);
  report_refinement(learned);
  report_merging(config, R, motion, archive);
}

}  // namespace

void import_stage(const Config& config, Archive& archive) {
  const Stopwatch watch;
  ImportedData data = import_data(config.data);
  for (const std::string& note : data.notes) spdlog::warn("{}", note);
  archive.recording = std::move(data.recording);
  archive.lag = std::move(data.lag);
  archive.provenance.inputs = std::move(data.files);
  archive.provenance.data_hash = std::move(data.data_hash);
  spdlog::info("import: {} runs, {} training and {} test transitions in {:.2f} s", archive.recording->runs.size(),
               archive.recording->transitions(Role::train), archive.recording->transitions(Role::test),
               watch.seconds());
}

void identify_stage(const Config& config, Archive& archive) {
  const Stopwatch watch;
  archive.windows = fit_windows(*archive.recording, window_options(config));
  spdlog::info("windows: {} fitted in {:.2f} s", archive.windows->count(), watch.seconds());
  WindowCounts counts;
  counts.add(*archive.windows);
  for (const std::string& warning : window_warnings(*archive.windows, counts)) spdlog::warn("windows: {}", warning);
}

bool streams_windows(const Config& config, const Archive& archive) {
  constexpr Index in_memory = 1000000;  // some 150 MB for three parameters
  return is_linear(config.window) && config.window.residual == ResidualKind::one_step &&
         count_windows(*archive.recording, config.window) > in_memory;
}

std::string identify_into_file(const Config& config, const Archive& archive) {
  const Stopwatch watch;
  WindowCounts counts;
  const auto produce = [&](const WindowSink& sink) {
    return stream_windows(*archive.recording, window_options(config), [&](const WindowFits& fits, Index first) {
      counts.add(fits);
      sink(fits, first);
    });
  };
  const Index windows = count_windows(*archive.recording, config.window);
  const WindowFits common = write_archive(config.archive.output, archive, windows, produce);
  spdlog::info("windows: {} fitted and archived in {:.2f} s", windows, watch.seconds());
  for (const std::string& warning : window_warnings(common, counts)) spdlog::warn("windows: {}", warning);
  return data_text(*archive.recording) + windows_text(common, counts);
}

/// The mixture of another archive, which must be over the same features.
GaussianMixture stored_start(const Config& config, Archive& archive, const std::vector<std::string>& features) {
  const std::string& file = config.mixture.start_file;
  Archive stored = read_archive(file);
  if (!stored.mixture) throw DataError(fmt::format("mixture.start: {} holds no mixture", file));
  if (stored.mixture->feature_names != features)
    throw DataError(fmt::format("mixture.start: the mixture of {} is over {}, this one over {}", file,
                                fmt::join(stored.mixture->feature_names, ", "), fmt::join(features, ", ")));
  const std::vector<Index>& sizes = config.mixture.selection.components;
  const Index components = stored.mixture->mixture.components();
  if (std::find(sizes.begin(), sizes.end(), components) == sizes.end())
    spdlog::warn("mixture.start: the mixture of {} has {} components, which is not among the candidates", file,
                 components);
  archive.provenance.inputs.push_back(describe_file(file));
  return std::move(stored.mixture->mixture);
}

void cluster_stage(const Config& config, Archive& archive) {
  const Stopwatch watch;
  const FeatureCloud cloud = make_features(*archive.windows, config.mixture.features, config.mixture.windows,
                                           archive.recording->states, config.mixture.selection.straddling,
                                           config.mixture.error_aware ? WindowErrors::include : WindowErrors::ignore);
  SelectionOptions selection = config.mixture.selection;
  if (!config.mixture.start_file.empty()) selection.start = stored_start(config, archive, cloud.names);
  archive.mixture = select_mixture(*archive.windows, cloud, selection, config.job.seed);
  spdlog::info("mixture: {} components from {} windows in {:.2f} s", archive.mixture->mixture.components(),
               cloud.windows.size(), watch.seconds());
  for (const std::string& warning : selection_warnings(archive.mixture->candidates))
    spdlog::warn("mixture: {}", warning);
}

void competitors_stage(const Config& config, Archive& archive) {
  const Recording& recording = *archive.recording;
  const WindowFits& windows = *archive.windows;
  Baseline baseline = learn_baseline(recording, linear_global(config, archive), windows.structure);
  baseline.bank.model = windows.model;
  if (baseline.at_bound) spdlog::info("baseline: R is at its lower bound: the data show no measurement noise");
  if (!baseline.converged) spdlog::warn("baseline: its noise did not reach a maximum of the likelihood");
  archive.noise_only = learn_noise_only(recording, windows.structure, baseline.bank.R);
  archive.baseline = std::move(baseline.bank);
}

void modes_stage(const Config& config, Archive& archive) {
  const Recording& recording = *archive.recording;
  const auto motion = motion_model(config.window, recording.state_count(), recording.input_count());
  archive.unrefined.reset();
  if (config.filter.variant == FilterVariant::kf)
    archive.bank = archive.baseline;
  else
    learn_modes(config, archive.baseline->R, motion.get(), archive);
}

void bank_stage(const Config& config, Archive& archive) {
  const Stopwatch watch;
  competitors_stage(config, archive);
  modes_stage(config, archive);
  spdlog::info("bank: {} modes, {} screened, in {:.2f} s", archive.bank->mode_count(), archive.bank->screened.size(),
               watch.seconds());
}

/// What makes a stored bank's scores mean something else than they seem to.
void warn_of_foreign_bank(const std::string& file, const Archive& stored, const Recording& recording) {
  std::vector<std::string> trained;
  for (const Trajectory& run : recording.runs)
    if (run.role == Role::test && stored.recording && trained_on(*stored.recording, run)) trained.push_back(run.run);
  if (!trained.empty())
    spdlog::warn("{}: its bank was trained on {}: the scores of the test runs are not held out", file,
                 fmt::join(trained, ", "));
  const Bank& bank = *stored.bank;
  if (bank.state_names != state_names(recording, bank.structure) ||
      bank.input_names != input_names(recording, bank.structure))
    spdlog::warn("{}: its bank was learned from columns {}; {}, the data have {}; {}", file,
                 fmt::join(bank.state_names, ", "), fmt::join(bank.input_names, ", "),
                 fmt::join(names_of(recording.states), ", "), fmt::join(names_of(recording.inputs), ", "));
  constexpr double tolerated = 0.1;  // a tenth more or less time per step changes increments by as much
  if (const double dt_s = recording.median_period_s(); std::abs(dt_s - bank.dt_s) > tolerated * bank.dt_s)
    spdlog::warn("{}: its bank steps by {:.4g} s, the data by {:.4g} s", file, bank.dt_s, dt_s);
}

void load_banks(const Config& config, Archive& archive) {
  Archive stored = read_archive(config.archive.bank);
  if (!stored.bank) throw DataError(fmt::format("{}: holds no bank", config.archive.bank));
  const Recording& recording = *archive.recording;
  const LinearStructure& structure = stored.bank->structure;
  if (structure.states != recording.state_count() || structure.inputs != recording.input_count())
    throw DataError(fmt::format("{}: its bank has {} states and {} inputs, the data have {} and {}",
                                config.archive.bank, structure.states, structure.inputs, recording.state_count(),
                                recording.input_count()));
  warn_of_foreign_bank(config.archive.bank, stored, recording);
  archive.provenance.inputs.push_back(describe_file(config.archive.bank));
  archive.bank = std::move(stored.bank);
  archive.baseline = std::move(stored.baseline);
  archive.noise_only = std::move(stored.noise_only);
  archive.unrefined = std::move(stored.unrefined);
}

FilterScores score_filter(const Config& config, const Archive& archive, const std::string& name) {
  const std::vector<Trajectory>& runs = archive.recording->runs;
  // The competitors stay what they are, whatever filter the bank runs in.
  const bool competitor = name != "bank";
  const FilterVariant variant = name == "baseline" ? FilterVariant::kf : FilterVariant::imm;
  const FilterOptions options = competitor ? FilterOptions{variant, false, config.filter.time_steps} : config.filter;
  const Bank& bank = *(!competitor ? archive.bank : name == "baseline" ? archive.baseline : archive.noise_only);
  FilterScores scores;
  scores.evaluation = {name, evaluate_runs(bank, runs, options, config.scoring.smooth)};
  scores.summary = summarize(name, runs, scores.evaluation.runs);
  scores.diagnostics = diagnose(name, bank, runs, scores.evaluation.runs);
  if (config.scoring.horizon != std::vector<Index>{1})
    scores.horizons = summarize_horizons(name, runs, look_ahead(bank, runs, options, config.scoring.horizon));
  return scores;
}

void take_scores(std::vector<FilterScores> scores, Archive& archive) {
  archive.evaluations.clear();
  archive.summary.clear();
  archive.horizons.clear();
  archive.diagnostics.clear();
  const auto append = [](auto& list, auto& rows) {
    list.insert(list.end(), std::make_move_iterator(rows.begin()), std::make_move_iterator(rows.end()));
  };
  for (FilterScores& filter : scores) {
    archive.evaluations.push_back(std::move(filter.evaluation));
    append(archive.summary, filter.summary);
    append(archive.diagnostics, filter.diagnostics);
    append(archive.horizons, filter.horizons);
  }
}

void evaluate_stage(const Config& config, Archive& archive) {
  const Stopwatch watch;
  std::vector<FilterScores> scores;
  if (archive.bank) scores.push_back(score_filter(config, archive, "bank"));
  if (archive.baseline) scores.push_back(score_filter(config, archive, "baseline"));
  if (archive.noise_only) scores.push_back(score_filter(config, archive, "noise_only"));
  take_scores(std::move(scores), archive);
  spdlog::info("evaluation: {} filters in {:.2f} s", archive.evaluations.size(), watch.seconds());
}

namespace {

template <class Test>
ResidualTestSet test_runs(const std::string& model, std::size_t runs, Test test) {
  ResidualTestSet set{model, std::vector<ResidualTests>(runs)};
  tbb::parallel_for(std::size_t{0}, runs, [&](std::size_t i) { set.runs[i] = test(i); });
  return set;
}

}  // namespace

ResidualTestSet test_global(const Config& config, const Archive& archive) {
  const std::vector<Trajectory>& runs = archive.recording->runs;
  const Eigen::VectorXd theta = linear_global(config, archive).theta;
  return test_runs("global", runs.size(),
                   [&](std::size_t i) { return test_residuals(runs[i], archive.windows->structure, theta); });
}

ResidualTestSet test_filter(const Archive& archive, const FilterEvaluation& evaluation) {
  const std::vector<Trajectory>& runs = archive.recording->runs;
  return test_runs(evaluation.filter, runs.size(),
                   [&](std::size_t i) { return test_innovations(runs[i], evaluation.runs[i]); });
}

void residual_test_stage(const Config& config, Archive& archive) {
  archive.residual_tests.clear();
  if (archive.windows) archive.residual_tests.push_back(test_global(config, archive));
  for (const FilterEvaluation& evaluation : archive.evaluations)
    archive.residual_tests.push_back(test_filter(archive, evaluation));
}

}  // namespace modebank::app
