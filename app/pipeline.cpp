#include "app/pipeline.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>

#include "app/stopwatch.hpp"
#include "app/summary_text.hpp"
#include "filter/learn.hpp"
#include "filter/merging_cost.hpp"
#include "ident/error.hpp"
#include "ident/fit_window.hpp"
#include "ident/linearise.hpp"
#include "ident/model_choice.hpp"
#include "ident/seed.hpp"
#include "io/import.hpp"
#include "mixture/criteria.hpp"
#include "mixture/features.hpp"
#include "mixture/select.hpp"

namespace modebank::app {
namespace {

/// The one seed reaches the windows' samples, too.
FitOptions window_options(const Config& config) {
  FitOptions options = config.window;
  options.seed = config.job.seed;
  return options;
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

/// What a limit on the number of modes cost: the same bank is learned without it.
std::vector<MergingCost> merging_of(const Config& config, const Eigen::MatrixXd& R, const MotionModel* motion,
                                    const Archive& archive) {
  const Index components = archive.mixture->mixture.components();
  if (config.bank.modes == 0 || components <= config.bank.modes) return {};
  Config unlimited = config;
  unlimited.bank.modes = 0;
  const Bank whole = learn_modes_of(unlimited, R, motion, archive).bank;
  return merging_costs(whole, *archive.bank, components, *archive.recording, config.filter);
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
  if (measured.end == MeasuredFit::iteration_limit)
    spdlog::warn("refine: the fit with measurement noise was stopped by bank.max_iterations before it had converged");
  if (measured.end == MeasuredFit::stalled)
    spdlog::warn("refine: the fit with measurement noise stalled before it had converged");
  const Averaging& averaged = refined.averaging;
  if (!std::isnan(averaged.score))
    spdlog::info("refine: {} fits averaged: {:.4f} -> {:.4f} nats/sample left out", averaged.members,
                 averaged.score_before, averaged.score);
}

void learn_modes(const Config& config, const Eigen::MatrixXd& R, const MotionModel* motion, Archive& archive) {
  Refinement learned = learn_modes_of(config, R, motion, archive);
  report_refinement(learned);
  archive.bank = std::move(learned.bank);
  archive.measured_fit = learned.measurement.end;
  if (config.bank.refine == Refine::em) archive.unrefined = std::move(learned.start);
  archive.merging = merging_of(config, R, motion, archive);
}

}  // namespace

GlobalModel linear_global(const Config& config, const Archive& archive) {
  const Recording& recording = *archive.recording;
  const auto motion = motion_model(config.window, recording.state_count(), recording.input_count());
  const GlobalModel& global = archive.windows->global;
  return motion ? linearise(*motion, global, operating_point(recording)) : global;
}

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
  archive.merging.clear();
  archive.measured_fit = MeasuredFit::none;
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

}  // namespace modebank::app
