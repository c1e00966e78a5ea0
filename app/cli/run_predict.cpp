#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <tbb/global_control.h>

#include <iterator>

#include "app/chain/stages.hpp"
#include "app/chain/stored_banks.hpp"
#include "app/cli/commands.hpp"
#include "app/cli/live_filter.hpp"
#include "app/cli/new_data.hpp"
#include "app/config/config_file.hpp"
#include "app/config/free_run_check.hpp"
#include "filter/judge/horizon.hpp"
#include "io/archive/archive.hpp"
#include "io/archive/bank/load_bank.hpp"
#include "io/archive/load_averaged.hpp"
#include "io/files/csv_field.hpp"
#include "io/files/output_file.hpp"
#include "io/files/read_file.hpp"
#include "io/files/replace_file.hpp"
#include "io/import/import.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app {
namespace {

using nlohmann::json;

Index predicted_samples(const std::vector<FreeRun>& predicted) {
  Index samples = 0;
  for (const FreeRun& run : predicted) samples += (run.mode.array() >= 0).count();
  return samples;
}

/// One line per sample that has a prediction. For each state, the columns are the prediction, its standard deviation
/// and its band.
std::string predicted_csv(const Recording& recording, const std::vector<FreeRun>& predicted) {
  fmt::memory_buffer out;
  auto to = std::back_inserter(out);
  fmt::format_to(to, "run,time");
  for (const Channel& s : recording.states)
    for (const char* what : {"_predicted", "_sd", "_lower", "_upper"})
      fmt::format_to(to, ",{}", csv_field(s.name + what));
  fmt::format_to(to, ",mode\n");
  for (std::size_t r = 0; r < predicted.size(); ++r) {
    const FreeRun& run = predicted[r];
    for (Index k = 0; k < run.mode.size(); ++k) {
      if (run.mode(k) < 0) continue;
      fmt::format_to(to, "{},{}", csv_field(recording.runs[r].run), recording.runs[r].time_s(k));
      for (Index i = 0; i < run.mean.rows(); ++i)
        fmt::format_to(to, ",{},{},{},{}", run.mean(i, k), run.deviation(i, k), run.lower(i, k), run.upper(i, k));
      fmt::format_to(to, ",{}\n", run.mode(k));
    }
  }
  return fmt::to_string(out);
}

/// The same values for each run, as one array per column.
json predicted_json(const Recording& recording, const std::vector<FreeRun>& predicted) {
  json runs = json::array();
  for (std::size_t r = 0; r < predicted.size(); ++r) {
    const FreeRun& run = predicted[r];
    json object{{"run", recording.runs[r].run}, {"time_s", json::array()}, {"mode", json::array()}};
    for (Index k = 0; k < run.mode.size(); ++k) {
      if (run.mode(k) < 0) continue;
      object["time_s"].push_back(recording.runs[r].time_s(k));
      object["mode"].push_back(run.mode(k));
      for (Index i = 0; i < run.mean.rows(); ++i) {
        json& state = object["states"][recording.states[static_cast<std::size_t>(i)].name];
        state["predicted"].push_back(run.mean(i, k));
        state["sd"].push_back(run.deviation(i, k));
        state["lower"].push_back(run.lower(i, k));
        state["upper"].push_back(run.upper(i, k));
      }
    }
    runs.push_back(std::move(object));
  }
  return runs;
}

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
  json result;
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
