#include <fmt/format.h>

#include "app/chain/chain.hpp"
#include "modebank/base/error.hpp"

namespace modebank {

StoredStages::StoredStages(const std::filesystem::path& file, Stage until)
    : stored_(read_archive(file)), until_(until) {
  if (!stored_.recording) throw DataError(fmt::format("{}: this archive has no data", file.string()));
  stored_.provenance.inputs.push_back(describe_file(file));
}

void StoredStages::provide(Stage stage, const std::string& /*key*/, const StagePart& part) {
  Archive result;
  if (stage == Stage::data) {
    static_cast<DataPart&>(result) = std::move(static_cast<DataPart&>(stored_));
    result.provenance = stored_.provenance;
  } else if (stage == Stage::structure && stage <= until_) {
    result.structure = std::move(stored_.structure);
  } else if (stage == Stage::windows && stage <= until_) {
    result.windows = std::move(stored_.windows);
  } else if (stage == Stage::mixture && stage <= until_) {
    result.mixture = std::move(stored_.mixture);
  }
  if (result.recording || result.structure || result.windows || result.mixture)
    part.take(std::move(result));
  else
    part.compute();
}

}  // namespace modebank
