#pragma once

#include <filesystem>
#include <functional>
#include <limits>
#include <string>
#include <string_view>

#include "app/chain/chain.hpp"

namespace modebank {

/// Name of a file that holds the result of one stage: STAGE-KEY.h5.
std::string stage_file_name(Stage stage, std::string_view key);

/// The one store of stages, for a run that is stopped and goes on and for the runs of a study: a folder with one
/// archive per stage and key (stage_file_name). A file appears by rename, whole or not at all. Two processes may
/// compute the same stage at the same time; both write the same numbers. Other files in the folder do not count and
/// stay.
class StageStore : public StageSource {
 public:
  struct Rules {
    double worth_a_file_s = 1.0;                                ///< a stage that took less is not kept
    Stage last = Stage::bank_scores;                            ///< later stages are not kept
    double limit_mb = std::numeric_limits<double>::infinity();  ///< files used longest ago go first; 0: none is kept
    std::function<void()> kept = {};                            ///< called after a file was written or taken
  };
  StageStore(std::filesystem::path folder, Rules rules) : folder_(std::move(folder)), rules_(std::move(rules)) {}

  void provide(Stage stage, const std::string& key, const StagePart& part) override;

  /// Removes the files of stages, and the folder if it then is empty.
  void clear() const;

 private:
  bool load(const std::filesystem::path& file, const StagePart& part) const;
  void store(const std::filesystem::path& file, const StagePart& part) const;
  void make_room() const;

  std::filesystem::path folder_;
  Rules rules_;
};

}  // namespace modebank
