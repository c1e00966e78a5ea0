#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "app/chain/listener.hpp"
#include "app/chain/stage_key.hpp"
#include "app/chain/stages.hpp"
#include "io/import/import.hpp"

namespace modebank {

/// How a stage's result enters and leaves the chain's archive. No part of the result is copied.
struct StagePart {
  std::function<void()> compute;
  std::function<Archive()> give;        ///< an archive with only the stage's result; `take` must receive this archive
                                        ///< later
  std::function<void(Archive&&)> take;  ///< moves the result from the archive of `give` back into the chain's archive
  double writing_s = 0.0;               ///< expected time to write the result; a result that was computed faster is not
                                        ///< stored
};

/// Decides where the results of stages come from: this base class computes all of them.
class StageSource {
 public:
  virtual ~StageSource() = default;
  /// Calls `part.compute`, or `part.take` with a result that `part.give` returned earlier for the same key.
  virtual void provide(Stage, const std::string& /*key*/, const StagePart& part) { part.compute(); }
};

/// Facts about the execution that the archive stores. The chain adds the data's hash.
struct Execution {
  std::string config;  ///< the resolved configuration
  Provenance provenance;
};

/// Runs the stages in their order, from data to scores. A stage is skipped if its key equals that of the last run. A
/// series of runs is therefore fastest if consecutive runs share their early stages.
class Chain {
 public:
  /// All arguments must outlive the chain. `memory`: the runs in memory; null if the data are files.
  Chain(StageSource& source, const Listener& listener, const MemoryTables* memory = nullptr)
      : source_(source), listener_(listener), memory_(memory) {}

  /// Returns the archive after the stage `last` (bank_scores: after all stages). `last` must not be earlier than in the
  /// run before. Throws the exceptions of the stages; earlier results are then not reused. If `sink` is not null, it
  /// receives each evaluation at once, and the archive contains no evaluations.
  const Archive& run(const ChainOptions& options, Stage last, const Execution& execution,
                     const EvaluationSink* sink = nullptr);

  /// Scores the banks of another archive on the data, without learning. Throws DataError if the banks' channels do not
  /// fit the data's. A chain calls either this function or run(), never both.
  const Archive& judge_stored(const std::filesystem::path& banks, const ChainOptions& options,
                              const Execution& execution, const EvaluationSink* sink = nullptr);

  /// Inputs of the last run, with the structure that the chain found.
  const ChainInputs& inputs() const { return inputs_; }

  /// Seconds that the last run spent on each stage; 0 for a stage that was skipped.
  const std::array<double, stage_count>& seconds() const { return seconds_; }

 private:
  void provide(Stage stage, const StagePart& part);
  /// A stage whose result is the part of type P in the archive.
  template <class P>
  void provide(Stage stage, const std::function<void()>& compute);
  void import(const DataInputs& inputs);
  void learn(const ChainOptions& options, Stage last);
  void provide_learned(Stage stage, const std::function<void()>& compute);
  void provide_windows(const std::function<void()>& compute);
  void judge(const ChainInputs& inputs);
  void score(const std::string& filter, const FilterOptions& options, const ScoringOptions& scoring);
  void conclude(const FilterOptions& filter, const ScoringOptions& scoring);
  std::optional<EvaluationStream> stream_to_sink() const;
  void put(FilterScores scores);
  void put_scores(Archive&& part);
  void warn_of_free_runs() const;
  void forget(const std::string& filter);
  void forget_competitors();
  void score_competitors(const CompetitorScoreInputs& inputs);
  void put(ResidualTestSet tests);
  void describe(const Execution& execution, const std::vector<InputFile>& more_files);

  StageSource& source_;
  const Listener& listener_;
  const Tell tell_ = [this](Level level, const std::string& line) { listener_.tell(level, line); };
  const MemoryTables* memory_;
  Archive archive_;
  ImportedData data_;  ///< files and hash of the recording, as imported
  ChainInputs inputs_;
  StageKeys wanted_, held_;
  std::array<double, stage_count> seconds_{};
  const EvaluationSink* sink_ = nullptr;  ///< set only while run or judge_stored works
};

}  // namespace modebank
