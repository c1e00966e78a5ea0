#pragma once

#include <filesystem>
#include <functional>
#include <limits>
#include <string>
#include <string_view>

#include "app/chain/chain.hpp"

namespace modebank {

/// Name of the file with the result of one stage: STAGE-KEY.h5.
std::string stage_file_name(Stage stage, std::string_view key);

/// A folder with one archive per stage and key (stage_file_name). It serves a run that continues after a stop, and the
/// runs of a study.
/// Each file is written under a temporary name and renamed, so a visible file is always complete. Two processes may
/// compute the same stage at the same time, since both write the same numbers. Other files in the folder are ignored.
class StageStore : public StageSource {
 public:
  struct Rules {
    double worth_a_file_s = 1.0;      ///< [s] a stage that took less time is not stored
    Stage last = Stage::bank_scores;  ///< stages after this one are not stored
    double limit_mb =
        std::numeric_limits<double>::infinity();  ///< limit of the folder's size [MB]; files that were not used for the
                                                  ///< longest time are removed first. 0: nothing is stored
    std::function<void()> kept = {};              ///< called after a file was written or read
  };
  StageStore(std::filesystem::path folder, Rules rules) : folder_(std::move(folder)), rules_(std::move(rules)) {}

  void provide(Stage stage, const std::string& key, const StagePart& part) override;

  /// Removes the stored stages, and then the folder if it is empty.
  void clear() const;

 private:
  bool load(const std::filesystem::path& file, const StagePart& part) const;
  void store(const std::filesystem::path& file, const StagePart& part) const;
  void make_room() const;

  std::filesystem::path folder_;
  Rules rules_;
};

}  // namespace modebank
