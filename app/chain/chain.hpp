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
  std::function<Archive()> give;        ///< an archive with only the result, which `take` must receive again
  std::function<void(Archive&&)> take;  ///< puts the result of such an archive back in its place
  double writing_s = 0.0;               ///< expected time to write it; a result computed faster is not worth a file
};

/// Decides where the results of stages come from: this base class computes all of them.
class StageSource {
 public:
  virtual ~StageSource() = default;
  /// Calls part.compute, or part.take with the result of an earlier part.give for the same key.
  virtual void provide(Stage, const std::string& /*key*/, const StagePart& part) { part.compute(); }
};

/// Takes data and stages up to `until` from an archive, as far as the archive has them. All other stages are computed.
class StoredStages : public StageSource {
 public:
  /// Throws DataError when the archive holds no data.
  StoredStages(const std::filesystem::path& file, Stage until);
  const Archive& stored() const { return stored_; }
  void provide(Stage stage, const std::string& key, const StagePart& part) override;

 private:
  Archive stored_;
  Stage until_;
};

/// An archive's statements about itself. The chain adds the data's hash.
struct Execution {
  std::string config;  ///< the resolved configuration
  Provenance provenance;
};

/// The one order of stages, from data to scores. A stage is skipped if its key equals that of the last run. So a series
/// of options is fastest if neighbours share early stages.
class Chain {
 public:
  /// All arguments must outlive the chain. `memory`: runs in memory; null: the data are files.
  Chain(StageSource& source, const Listener& listener, const MemoryTables* memory = nullptr)
      : source_(source), listener_(listener), memory_(memory) {}

  /// The archive after the stage `last` (bank_scores: all stages). `last` must not be earlier than in the run before.
  /// Throws the exceptions of the stages; earlier results are then not reused. `sink` receives evaluations as they are
  /// made, and the archive then has none; null: the archive has them.
  const Archive& run(const ChainOptions& options, Stage last, const Execution& execution,
                     const EvaluationSink* sink = nullptr);

  /// Scores the banks of another archive on the data, without learning. Throws DataError if the banks' channels do not
  /// fit the data's. A chain calls either this function or run(), never both.
  const Archive& judge_stored(const std::filesystem::path& banks, const ChainOptions& options,
                              const Execution& execution, const EvaluationSink* sink = nullptr);

  /// Inputs of the last run, with the structure that was found.
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
  const MemoryTables* memory_;
  Archive archive_;
  ImportedData data_;  ///< files and hash of the recording
  ChainInputs inputs_;
  StageKeys wanted_, held_;
  std::array<double, stage_count> seconds_{};
  const EvaluationSink* sink_ = nullptr;  ///< during run and judge_stored
};

}  // namespace modebank
