#include "app/chain/chain.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "app/chain/model_rows.hpp"
#include "app/config/section.hpp"
#include "app/text/mode_dynamics.hpp"
#include "app/text/mode_names.hpp"
#include "filter/learn/chain/chain.hpp"

namespace modebank {

namespace {

/// Moves the part of type P from an archive into a new archive.
template <class P>
Archive part_out_of(Archive& archive) {
  Archive part;
  static_cast<P&>(part) = std::exchange(static_cast<P&>(archive), {});
  return part;
}

template <class P>
void take_part(Archive&& part, Archive& archive) {
  static_cast<P&>(archive) = std::move(static_cast<P&>(part));
}

}  // namespace

void Chain::provide(Stage stage, const StagePart& part) {
  std::string& held = held_[index_of(stage)];
  const std::string& wanted = wanted_[index_of(stage)];
  if (held == wanted) return;
  held.clear();  // if the computation throws, no key matches this stage's result
  const Stopwatch watch;
  // Results that are written to a file during the computation are not in memory, so a later run cannot reuse them.
  const bool streamed = sink_ && (stage == Stage::competitor_scores || stage == Stage::bank_scores);
  if (streamed)
    part.compute();
  else
    source_.provide(stage, wanted, part);
  seconds_[index_of(stage)] = watch.seconds();
  if (!streamed) held = wanted;
  listener_.done(stage, archive_);
}

template <class P>
void Chain::provide(Stage stage, const std::function<void()>& compute) {
  provide(stage, {compute, [this] { return part_out_of<P>(archive_); },
                  [this](Archive&& part) { take_part<P>(std::move(part), archive_); }});
}

const Archive& Chain::run(const ChainOptions& options, Stage last, const Execution& execution,
                          const EvaluationSink* sink) {
  sink_ = sink;
  seconds_.fill(0.0);
  inputs_ = chain_inputs(options);
  wanted_ = stage_keys(inputs_, "");  // the data's hash becomes known only when the data are read
  import(inputs_.data);
  if (last >= Stage::bank_scores && options.scoring.horizon != ScoringOptions::default_horizon)
    refuse_unreached_horizons(*archive_.recording, options.scoring.horizon);
  learn(options, std::min(last, Stage::bank));
  if (last >= Stage::bank_scores)
    judge(inputs_);
  else if (archive_.windows)
    put(test_global(*archive_.recording, *archive_.windows, inputs_.windows));
  archive_.mode_names = mode_names_of(archive_, options.mode_names, tell_);
  describe(execution, {});
  return archive_;
}

void Chain::import(const DataInputs& inputs) {
  const auto compute = [&] {
    const Stopwatch watch;
    data_ = import_data(inputs.data, memory_);
    archive_.provenance.data_hash = data_.data_hash;  // listeners may need the data's hash
    for (const std::string& note : data_.notes) tell_(Level::warning, note);
    static_cast<DataPart&>(archive_) = {std::move(data_.recording), std::move(data_.labels), data_.step_scatter,
                                        std::move(data_.lag)};
    tell_(Level::progress, fmt::format("import: {} runs, {} training and {} test transitions in {:.2f} s",
                                       archive_.recording->runs.size(), archive_.recording->transitions(Role::train),
                                       archive_.recording->transitions(Role::test), watch.seconds()));
  };
  const auto give = [&] {
    Archive part = part_out_of<DataPart>(archive_);
    part.provenance.inputs = data_.files;
    part.provenance.data_hash = data_.data_hash;
    return part;
  };
  const auto take = [&](Archive&& part) {
    data_.files = std::move(part.provenance.inputs);
    archive_.provenance.data_hash = data_.data_hash = std::move(part.provenance.data_hash);
    take_part<DataPart>(std::move(part), archive_);
  };
  provide(Stage::data, {compute, give, take});
}

void Chain::learn(const ChainOptions& options, Stage last) {
  if (!inputs_.structure) held_[index_of(Stage::structure)].clear();
  LearningHooks hooks;
  hooks.provide = [&](Stage stage, const LearningInputs& inputs, const std::function<void()>& compute) {
    static_cast<LearningInputs&>(inputs_) = inputs;
    inputs_.competitor_scores.window = inputs.windows;
    const std::string data_key = wanted_[index_of(Stage::data)];
    wanted_ = stage_keys(inputs_, data_.data_hash);
    wanted_[index_of(Stage::data)] = data_key;
    provide_learned(stage, compute);
  };
  hooks.tell = tell_;
  LearningOptions learning = options;
  learning.one_model = archive_.step_scatter > most_step_scatter;
  learn_all(*archive_.recording, learning, last, hooks, archive_);
}

void Chain::provide_learned(Stage stage, const std::function<void()>& compute) {
  switch (stage) {
    case Stage::structure:
      return provide<StructurePart>(stage, compute);
    case Stage::windows:
      return provide_windows(compute);
    case Stage::mixture:
      return provide<MixturePart>(stage, compute);
    case Stage::competitors:
      return provide<CompetitorsPart>(stage, compute);
    default:
      return provide<BankPart>(Stage::bank, [&] {
        compute();
        if (archive_.bank) add_responses(*archive_.bank);
      });
  }
}

void Chain::provide_windows(const std::function<void()>& compute) {
  constexpr double written_per_s = 1e5;  // windows that a slow disk writes per second, with their samples
  const FitOptions& window = inputs_.windows;
  const auto in_its_section = [&] { in_section("window", compute); };
  const auto give = [&] {
    Archive part = part_out_of<WindowsPart>(archive_);
    part.recording = std::exchange(archive_.recording, {});
    return part;
  };
  const auto take = [&](Archive&& part) {
    put_back_recording(part, archive_);
    take_part<WindowsPart>(std::move(part), archive_);
  };
  const double windows =
      static_cast<double>(archive_.recording->transitions(Role::train)) / static_cast<double>(window.step);
  provide(Stage::windows, {in_its_section, give, take, windows / written_per_s});
}

void Chain::describe(const Execution& execution, const std::vector<InputFile>& more_files) {
  archive_.config = execution.config;
  archive_.provenance = execution.provenance;
  archive_.provenance.data_hash = data_.data_hash;
  archive_.provenance.inputs = data_.files;
  archive_.provenance.inputs.insert(archive_.provenance.inputs.end(), more_files.begin(), more_files.end());
}

}  // namespace modebank
