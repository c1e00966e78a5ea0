#include <spdlog/spdlog.h>
#include <tbb/global_control.h>

#include <nlohmann/json.hpp>

#include "app/chain/stages.hpp"
#include "app/chain/stored_banks.hpp"
#include "app/cli/commands.hpp"
#include "app/cli/live_filter.hpp"
#include "app/cli/new_data.hpp"
#include "app/cli/predict_text.hpp"
#include "app/cli/result.hpp"
#include "app/config/config_file.hpp"
#include "app/config/free_run_check.hpp"
#include "filter/judge/free_run.hpp"
#include "io/archive/archive.hpp"
#include "io/archive/bank/load_bank.hpp"
#include "io/archive/load_averaged.hpp"
#include "io/files/output_file.hpp"
#include "io/files/read_file.hpp"
#include "io/files/replace_file.hpp"
#include "io/import/import.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app {
namespace {

double period_of(const OpenArchive& archive, const Config& config) {
  return load_bank(archive, tracked_bank(config)).dt_s;
}

std::vector<FreeRun> predict_all(const OpenArchive& archive, const Config& config, const Recording& recording) {
  const FreeRunOptions how = scoring_inputs(chain_options(config)).free_run;
  const Bank bank = load_bank(archive, tracked_bank(config));
  check_columns(config, bank, archive);
  if (const std::string remark = period_remark(archive.path().string(), bank, recording); !remark.empty())
    spdlog::warn("{}", remark);
  check_free_run(bank.structure, how);
  return free_runs(bank, recording.runs, tracked_options(config), how);
}

FileForm predictions_form() {
  return {"a table of predictions", [](const std::filesystem::path& path) {
            std::ifstream stream = open_file(path);
            std::string header;
            std::getline(stream, header);
            return header.starts_with("run,time,") && header.find("_predicted,") != std::string::npos;
          }};
}

/// One prediction: its configuration, and the sampling of the new data.
struct Task {
  Config config;
  AveragedColumns averaged;
};

Task task_of(const CommandLine& line, const OpenArchive& archive) {
  Task task{stored_config(load_configuration(archive), line.overrides), {}};
  Config& config = task.config;
  if (config.track.filter == TrackedFilter::combined)
    throw ConfigurationError("predict: combined filters need measurements; choose one of them (--filter)");
  if (config.scoring.free_run.samples == 0)
    throw ConfigurationError(
        "predict needs the number of measured samples at the start: --samples N (filter.simulate)");
  if (given(line, "data.inputs")) {
    turn_to_new_files(line, config.data);
    task.averaged = take_sampling(line, archive, config.data.lag_auto ? period_of(archive, config) : 0.0, config.data);
  } else if (config.data.rate_hz > 0.0) {
    task.averaged = load_averaged(archive);
  }
  if (line.output.empty()) return task;
  std::vector<std::filesystem::path> sources{archive.path()};
  for (const DataFile& file : data_files(config.data)) sources.push_back(file.path);
  check_output({"-o", line.output, predictions_form()}, sources);
  return task;
}

}  // namespace

int run_predict(const CommandLine& line) {
  const OpenArchive archive(line.files.front());
  const Task task = task_of(line, archive);
  const Config& config = task.config;
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, config.job.thread_count());
  const ImportedData data = import_data(data_options_of(config), nullptr, &task.averaged);
  for (const std::string& note : data.notes) spdlog::warn("{}", note);
  const std::vector<FreeRun> predicted = predict_all(archive, config, data.recording);
  for (const std::string& remark : remarks("bank", data.recording.runs, predicted)) spdlog::warn("{}", remark);
  if (predicted_samples(predicted) == 0) throw DataError("no sample could be predicted");
  nlohmann::json result;
  if (!line.output.empty()) {
    replace_file(final_target(line.output), {predicted_csv(data.recording, predicted)});
    result["written"] = {line.output};
  } else if (line.json) {
    result["runs"] = predicted_json(data.recording, predicted);
  } else {
    print_text(line, predicted_csv(data.recording, predicted));
  }
  print_json(line, result);
  return 0;
}

}  // namespace modebank::app
