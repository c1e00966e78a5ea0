#include <spdlog/spdlog.h>

#include "app/chain/stored_banks.hpp"
#include "app/cli/commands.hpp"
#include "app/cli/new_data.hpp"
#include "app/cli/tracker.hpp"
#include "app/config/config_file.hpp"
#include "io/archive/archive.hpp"
#include "io/archive/bank/load_bank.hpp"
#include "io/import/import.hpp"

namespace modebank::app {
namespace {

/// Reads runs as `run` does, but does not split them at missing values, because the filter predicts missing values.
std::vector<Trajectory> read_runs(const OpenArchive& archive, const Config& config, const Bank& bank,
                                  const AveragedColumns& averaged) {
  const ImportedData data = import_data(data_options_of(config), nullptr, &averaged);
  for (const std::string& note : data.notes) spdlog::warn("{}", note);
  if (const std::string remark = period_remark(archive.path().string(), bank, data.recording); !remark.empty())
    spdlog::warn("{}", remark);
  return data.recording.runs;
}

}  // namespace

int run_track(const CommandLine& line) {
  const OpenArchive archive(line.files.front());
  Config config = stored_config(load_configuration(archive), line.overrides);
  config.track.json = line.json;
  const bool files = given(line, "data.inputs");
  if (files) turn_to_new_files(line, config.data);
  OpenedFilter opened = open_filter(archive, config);
  const AveragedColumns averaged = take_sampling(line, archive, opened.bank.dt_s, config.data);
  const Alignment alignment{config.data.rate_hz, config.data.lag_s, averaged};
  const std::vector<Trajectory> runs =
      files ? read_runs(archive, config, opened.bank, averaged) : std::vector<Trajectory>();
  Tracker tracker(archive, config, std::move(opened), files ? Alignment{} : alignment);
  try {
    files ? tracker.follow_runs(runs, runs.size() > 1) : tracker.follow_lines();
  } catch (...) {
    try {
      tracker.finish(true);
    } catch (...) {  // the first error counts
    }
    throw;
  }
  tracker.finish(false);
  return 0;
}

}  // namespace modebank::app
