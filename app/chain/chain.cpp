#include "app/chain/chain.hpp"

#include <fmt/format.h>

#include "app/chain/expected_time.hpp"
#include "app/chain/mode_names.hpp"
#include "app/chain/training_check.hpp"
#include "ident/fit/window_length.hpp"
#include "io/import/import.hpp"

namespace modebank {

void Chain::provide(Stage stage, const StagePart& part) {
  std::string& held = held_[index_of(stage)];
  const std::string& wanted = wanted_[index_of(stage)];
  if (held == wanted) return;
  held.clear();  // if this throws, what is there belongs to no run
  const Stopwatch watch;
  // What goes into a file as it is made is in no memory for another run to take.
  const bool streamed = sink_ && (stage == Stage::competitor_scores || stage == Stage::bank_scores);
  if (streamed)
    part.compute();
  else
    source_.provide(stage, wanted, part);
  seconds_[index_of(stage)] = watch.seconds();
  if (!streamed) held = wanted;
  listener_.done(stage, archive_);
}

const Archive& Chain::run(const ChainOptions& options, Stage last, const Execution& execution,
                          const EvaluationSink* sink) {
  sink_ = sink;
  seconds_.fill(0.0);
  inputs_ = chain_inputs(options);
  wanted_ = stage_keys(inputs_, "");  // what the data hold is known when they are read
  import(inputs_.data);
  const auto want = [this, data_key = wanted_[index_of(Stage::data)]] {
    wanted_ = stage_keys(inputs_, data_.data_hash);
    wanted_[index_of(Stage::data)] = data_key;
  };
  want();
  if (last >= Stage::structure) {
    refuse_constant_states(*archive_.recording);
    if (last >= Stage::bank_scores && options.scoring.horizon != ScoringOptions::default_horizon)
      refuse_unreached_horizons(*archive_.recording, options.scoring.horizon);
    find_lags(inputs_.structure);
  }
  if (last >= Stage::windows && (archive_.structure || options.automatic_windows.any())) {
    ChainOptions found = archive_.structure ? with_structure(options, *archive_.structure) : options;
    if (options.automatic_windows.length) found.window.length = automatic_length(*archive_.recording, found.window);
    if (options.automatic_windows.step) found.window.step = automatic_step(*archive_.recording);
    inputs_ = chain_inputs(found);
    want();
  }
  const ChainInputs& inputs = inputs_;
  if (last >= Stage::windows) identify_windows(inputs.windows);
  if (last >= Stage::mixture) cluster_windows(inputs.mixture);
  if (last >= Stage::bank) learn_bank(inputs);
  if (last >= Stage::bank_scores)
    judge(inputs);
  else if (archive_.windows)
    put(test_global(*archive_.recording, *archive_.windows, inputs.windows.window));
  archive_.mode_names = mode_names_of(archive_, options.mode_names, listener_);
  describe(execution, mixture_files_);
  return archive_;
}

void Chain::import(const DataInputs& inputs) {
  const auto compute = [&] {
    const Stopwatch watch;
    data_ = import_data(inputs.data, memory_);
    archive_.provenance.data_hash = data_.data_hash;  // listeners may want to know which data they are
    for (const std::string& note : data_.notes) listener_.warning(note);
    archive_.recording = std::move(data_.recording);
    archive_.lag = std::move(data_.lag);
    archive_.labels = std::move(data_.labels);
    archive_.step_scatter = data_.step_scatter;
    listener_.progress(fmt::format("import: {} runs, {} training and {} test transitions in {:.2f} s",
                                   archive_.recording->runs.size(), archive_.recording->transitions(Role::train),
                                   archive_.recording->transitions(Role::test), watch.seconds()));
  };
  const auto copy = [&] {
    Archive part;
    part.recording = archive_.recording;
    part.lag = archive_.lag;
    part.labels = archive_.labels;
    part.step_scatter = archive_.step_scatter;
    part.provenance.inputs = data_.files;
    part.provenance.data_hash = data_.data_hash;
    return part;
  };
  const auto take = [&](Archive&& part) {
    archive_.recording = std::move(part.recording);
    archive_.lag = std::move(part.lag);
    archive_.labels = std::move(part.labels);
    archive_.step_scatter = part.step_scatter;
    data_.files = std::move(part.provenance.inputs);
    archive_.provenance.data_hash = data_.data_hash = std::move(part.provenance.data_hash);
  };
  provide(Stage::data, {compute, copy, take});
}

void Chain::find_lags(std::optional<StructureInputs> inputs) {
  if (inputs && one_model_alone()) inputs->with_modes = false;
  if (!inputs) {
    archive_.structure.reset();
    held_[index_of(Stage::structure)].clear();
    return;
  }
  const auto compute = [&] { archive_.structure = search_structure(*archive_.recording, *inputs, listener_); };
  const auto copy = [&] {
    Archive part;
    part.structure = archive_.structure;
    return part;
  };
  const auto take = [&](Archive&& part) { archive_.structure = std::move(part.structure); };
  provide(Stage::structure, {compute, copy, take});
}

void Chain::identify_windows(const WindowInputs& inputs) {
  constexpr double written_per_s = 1e5;  // with their samples and a copy of both, on a slow disk
  const auto compute = [&] {
    if (const std::string open = open_effects(*archive_.recording, inputs.window); !open.empty())
      listener_.warning(open);
    tell_if_long(listener_, "windows", expected_windows_s(*archive_.recording, inputs.window),
                 "--window.step 10 fits every tenth window");
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
  const auto take = [&](Archive&& part) { archive_.windows = std::move(part.windows); };
  const double windows =
      static_cast<double>(archive_.recording->transitions(Role::train)) / static_cast<double>(inputs.window.step);
  provide(Stage::windows, {compute, copy, take, windows / written_per_s});
}

void Chain::cluster_windows(const MixtureInputs& inputs) {
  const std::string& start = inputs.start_file;
  const auto compute = [&] {
    tell_if_long(listener_, "mixture", expected_mixture_s(*archive_.windows, inputs.mixture),
                 "--mixture.components 4 tries one number of components");
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
  learn_competitor_banks(inputs.competitors);
  const auto learn = [&] {
    BankInputs asked = inputs.bank;
    if (one_model_alone()) {
      asked.one_model = true;
      listener_.progress("bank: that of baseline, as steps scatter");
    }
    if (!archive_.noise_only->noise_factor.empty()) {
      asked.bank.em.noise_by_input = true;
      if (asked.one_motion) asked.one_motion->bank.em.noise_by_input = true;
    }
    const LearnedFrom from{*archive_.recording, *archive_.windows, *archive_.mixture, *archive_.baseline};
    const double expected_s = expected_learning_s(*archive_.recording, archive_.windows->structure, asked.bank.em);
    if (asked.bank.refine == Refine::em && !asked.one_model)
      tell_if_long(listener_, "bank", expected_s, "--bank.refine none leaves this out");
    LearnedBank learned = learn_modes(from, asked, listener_);
    archive_.bank = std::move(learned.bank);
    archive_.unrefined = std::move(learned.unrefined);
    archive_.measured_fit = learned.measured_fit;
    archive_.merging = std::move(learned.merging);
    archive_.learned_transitions = learned.learned_transitions;
    listener_.progress(fmt::format("bank: {} modes, {} screened, in {:.2f} s", archive_.bank->mode_count(),
                                   archive_.bank->screened.size(), watch.seconds()));
    archive_.one_motion.reset();
    std::vector<std::pair<std::string, std::vector<Bank>>> of_splits{{"bank", std::move(learned.of_splits)}};
    if (asked.one_motion) {
      tell_if_long(listener_, "one_motion", expected_s, "--bank.refine_transitions 10000 learns from fewer");
      Refinement one_motion = learn_one_motion(from, *archive_.bank, asked, listener_);
      archive_.one_motion = std::move(one_motion.bank);
      of_splits.emplace_back("one_motion", std::move(one_motion.of_splits));
    }
    archive_.left_out = score_left_out(archive_, asked, of_splits, listener_);
  };
  const auto copy = [&] {
    Archive part;
    part.bank = archive_.bank;
    part.one_motion = archive_.one_motion;
    part.unrefined = archive_.unrefined;
    part.measured_fit = archive_.measured_fit;
    part.merging = archive_.merging;
    part.left_out = archive_.left_out;
    part.learned_transitions = archive_.learned_transitions;
    return part;
  };
  const auto take = [&](Archive&& part) {
    archive_.bank = std::move(part.bank);
    archive_.one_motion = std::move(part.one_motion);
    archive_.unrefined = std::move(part.unrefined);
    archive_.measured_fit = part.measured_fit;
    archive_.merging = std::move(part.merging);
    archive_.left_out = std::move(part.left_out);
    archive_.learned_transitions = part.learned_transitions;
  };
  provide(Stage::bank, {learn, copy, take});
}

void Chain::describe(const Execution& execution, const std::vector<InputFile>& more_files) {
  archive_.config = execution.config;
  archive_.provenance = execution.provenance;
  archive_.provenance.data_hash = data_.data_hash;
  archive_.provenance.inputs = data_.files;
  archive_.provenance.inputs.insert(archive_.provenance.inputs.end(), more_files.begin(), more_files.end());
}

}  // namespace modebank
