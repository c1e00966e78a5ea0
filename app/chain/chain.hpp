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

/// How a stage's result comes into the chain's archive, and out of it: no part of it is copied.
struct StagePart {
  std::function<void()> compute;
  std::function<Archive()> give;        ///< an archive of the result alone, which `take` must get back
  std::function<void(Archive&&)> take;  ///< puts the result that such an archive holds in place
  double writing_s = 0.0;  ///< about how long its writing takes: what is computed faster is not worth keeping
};

/// Decides where stages' results come from. This one computes them all.
class StageSource {
 public:
  virtual ~StageSource() = default;
  /// Calls part.compute, or part.take with what an earlier part.give gave for the same key.
  virtual void provide(Stage, const std::string& /*key*/, const StagePart& part) { part.compute(); }
};

/// Takes from an archive what it holds of the data and of the stages up to `until`; the others are computed.
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

/// What an archive says of itself beside its numbers: the part on data is the chain's.
struct Execution {
  std::string config;  ///< resolved
  Provenance provenance;
};

/// The one order of stages, from data to scores. Options that follow one another are fastest when they share early
/// stages: a stage whose key is that of the last run is left as it is.
class Chain {
 public:
  /// All must outlive the chain. `memory`: runs that are in memory; null: they are files.
  Chain(StageSource& source, const Listener& listener, const MemoryTables* memory = nullptr)
      : source_(source), listener_(listener), memory_(memory) {}

  /// The archive after the stage `last` (bank_scores: all), which must not be earlier than in the run before. Throws
  /// what the stages throw; what then is there is not used again. `sink`: takes evaluations as they are made, which
  /// then are not in the archive; null: they are.
  const Archive& run(const ChainOptions& options, Stage last, const Execution& execution,
                     const EvaluationSink* sink = nullptr);

  /// Scores the banks of another archive on the data; nothing is learned. Throws DataError when their channels do not
  /// fit the data's. Not to be mixed with run().
  const Archive& judge_stored(const std::filesystem::path& banks, const ChainOptions& options,
                              const Execution& execution, const EvaluationSink* sink = nullptr);

  /// Inputs of the last run, with the structure that it found.
  const ChainInputs& inputs() const { return inputs_; }

  /// Seconds that the last run spent on each stage; 0 for those left as they were.
  const std::array<double, stage_count>& seconds() const { return seconds_; }

 private:
  void provide(Stage stage, const StagePart& part);
  /// A stage whose result is the part of the archive that is of type P.
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
  ImportedData data_;  ///< what is said of the recording: files and hash
  ChainInputs inputs_;
  StageKeys wanted_, held_;
  std::array<double, stage_count> seconds_{};
  const EvaluationSink* sink_ = nullptr;  ///< during run and judge_stored
};

}  // namespace modebank
