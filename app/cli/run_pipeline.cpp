#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <tbb/global_control.h>

#include <functional>

#include "app/chain/chain.hpp"
#include "app/chain/pipeline.hpp"
#include "app/chain/provenance.hpp"
#include "app/cli/acting_doubts.hpp"
#include "app/cli/commands.hpp"
#include "app/cli/dry_run.hpp"
#include "app/cli/kept_stages.hpp"
#include "app/cli/log/joined_inputs.hpp"
#include "app/cli/log/log_text.hpp"
#include "app/cli/log/run_log.hpp"
#include "app/cli/progress_meter.hpp"
#include "app/cli/summary_json.hpp"
#include "app/config/config_file.hpp"
#include "app/config/section.hpp"
#include "app/text/first_screen.hpp"
#include "app/text/free_run_text.hpp"
#include "app/text/operating_point.hpp"
#include "app/text/summary_text.hpp"
#include "app/text/terminal.hpp"
#include "app/text/window_text.hpp"
#include "ident/fit/fit_windows.hpp"
#include "ident/model/parameter_labels.hpp"
#include "io/archive/archive.hpp"
#include "io/archive/bank/load_bank.hpp"
#include "io/archive/inspect.hpp"
#include "io/files/replace_file.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app {
namespace {

Stage last_stage(const std::string& until) {
  if (until == "windows") return Stage::windows;
  return until == "mixture" ? Stage::mixture : until == "bank" ? Stage::bank : Stage::bank_scores;
}

/// Throws if the output would replace another result: that of other data, of a bank from another file, or of more
/// stages. This is checked before any fit, as soon as the hash of the data is known.
void check_replaces_same_result(const ArchiveConfig& archive, const std::string& data_hash, Stage last) {
  std::error_code error;
  if (!std::filesystem::exists(archive.output, error)) return;
  std::string other;
  try {
    const OpenArchive opened(archive.output);
    const std::string hash = load_data_hash(opened), bank = resolved_values(load_configuration(opened))["archive.bank"];
    const nlohmann::json members = inspect(opened, "/")["members"];
    if (hash != data_hash)
      other = fmt::format("of other data (data_hash {}, this run's is {})", hash, data_hash);
    else if (bank != archive.bank || (last < Stage::bank && members.contains("bank")) ||
             (last < Stage::bank_scores && members.contains("evaluation")))
      other = bank.empty() ? "a learned bank" : "of the bank of " + bank;
  } catch (const std::exception& reason) {
    throw DataError(
        fmt::format("archive.output: {} exists and is not replaced, because it cannot be read: {}; name another file, "
                    "or add --force",
                    archive.output, reason.what()));
  }
  if (!other.empty())
    throw DataError(fmt::format(
        "archive.output: {} holds another result, {}, and is not replaced; name another file, or add --force",
        archive.output, other));
}

/// Prints a chain's messages to the log.
class Log : public Adviser {
 public:
  /// The output is checked as soon as the data are read.
  Log(const CommandLine& line, const ArchiveConfig& archive) : line_(line), archive_(archive) {}

  void done(Stage stage, const Archive& archive) const override {
    if (stage == Stage::data && !line_.force)
      check_replaces_same_result(archive_, archive.provenance.data_hash, last_stage(line_.until));
    Adviser::done(stage, archive);
  }
  void tell(Level level, const std::string& line) const override {
    constexpr std::array levels{spdlog::level::debug, spdlog::level::info, spdlog::level::warn};
    spdlog::log(levels[static_cast<std::size_t>(level)], "{}", line);
  }

 private:
  const CommandLine& line_;
  const ArchiveConfig& archive_;
};

std::string archive_line(const Config& config) { return fmt::format("\narchive   {}\n", config.archive.output); }

nlohmann::json written(const Config& config) { return {{"written", {config.archive.output}}}; }

/// Whether there are so many windows that they are written to the file during the fit.
bool streams_windows(const Recording& recording, const FitOptions& window) {
  constexpr Index in_memory = 1000000;  // largest number of windows in memory: about 150 MB for a model with three
                                        // parameters
  return count_windows(recording, window) > in_memory;
}

/// Fits windows and writes them to an archive that contains only the data of `before` and the windows. `report` is
/// called for each block of windows. Returns the properties that all windows share.
WindowFits identify_into_file(const std::filesystem::path& path, const Archive& before, const FitOptions& window,
                              const std::function<void(const WindowFits&)>& report) {
  const Recording& recording = *before.recording;
  const auto produce = [&](const WindowSink& sink) {
    const WindowSink report_and_sink = [&](const WindowFits& fits, Index first) {
      report(fits);
      sink(fits, first);
    };
    return in_section("window", [&] { return stream_windows(recording, window, report_and_sink); });
  };
  return write_archive(path, before, count_windows(recording, window), produce);
}

/// Adds doubts about columns and the single linear model. The screen already has the doubt about the level.
void add_doubts(const Archive& archive, Result& result) {
  std::vector<std::string> doubts = delay_doubts(archive);
  if (archive.recording) std::ranges::copy(joined_doubts(*archive.recording), std::back_inserter(doubts));
  for (const std::string& doubt : doubts) result.text += paragraph("doubt", doubt);
  if (const std::string level = level_doubt(archive); !level.empty()) {
    if (!has_first_screen(archive)) result.text += paragraph("doubt", level);
    doubts.push_back(level);
  }
  result.members["doubts"] = doubts;
}

/// If there are too many windows for memory, writes them to the file during the fit.
Result identify_many(const Config& config, const Chain& chain, const Archive& data, const Log& log) {
  const Stopwatch watch;
  WindowCounts counts;
  const FitOptions& window = chain.inputs().windows;
  const WindowFits common = identify_into_file(final_target(config.archive.output), data, window,
                                               [&](const WindowFits& fits) { counts.add(fits); });
  log.tell(Level::progress,
           fmt::format("windows: {} fitted and archived in {:.2f} s", counts.total(), watch.seconds()));
  log.warn_of_windows(counts);
  const std::vector<std::string> labels =
      parameter_labels(common, names_of(data.recording->states), names_of(data.recording->inputs));
  Result result{data_text(*data.recording) + windows_text(common, counts, labels), written(config)};
  add_doubts(data, result);
  result.text += archive_line(config);
  return result;
}

/// Throws for options of learning, because they have no effect on a stored bank.
void refuse_learning_options(const CommandLine& line, const Config& config) {
  if (config.archive.bank.empty()) return;
  if (!line.until.empty()) throw ConfigurationError("--until does not work with archive.bank, which is only judged");
  for (const auto& [key, value] : line.overrides)
    if (key.starts_with("mixture.") || (key.starts_with("bank.") && key != "bank.mode_names"))
      throw ConfigurationError(
          fmt::format("--{}: with archive.bank nothing is learned; the bank is that of {}", key, config.archive.bank));
}

/// Runs the stages and writes the archive.
Result execute(const CommandLine& line, const Config& config, StageSource& source) {
  const Stage last = last_stage(line.until);
  const Log log(line, config.archive);
  Chain chain(source, log);
  const ChainOptions options = chain_options(config);
  const Execution execution{resolved_text(config), make_provenance(config_hash(config), line.typed)};
  if (last == Stage::windows) {
    const Archive& data = chain.run(options, Stage::structure, execution);
    if (streams_windows(*data.recording, chain.inputs().windows)) return identify_many(config, chain, data, log);
  }
  const Archive& archive = run_and_write(chain, options, last, config.archive.bank, execution, config.archive.output);
  const Settings settings = resolved_values(archive.config);
  if (!has_first_screen(archive)) {
    Result result{summary_text(archive, time_unit(settings)) + free_run_text(archive), written(config)};
    add_doubts(archive, result);
    result.text += archive_line(config);
    return result;
  }
  Result result{first_screen(archive, settings, config.archive.output, standard_output().width, line.program),
                written(config)};
  add_doubts(archive, result);
  if (line.json) result.members["summary"] = summary_json(archive, settings);
  return result;
}

}  // namespace

Result do_configured(const CommandLine& line, const Config& config, const std::filesystem::path& file) {
  check_request(config, file);
  refuse_learning_options(line, config);
  if (line.dry_run) return dry_run(config, {config.archive.output});
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, config.job.thread_count());
  const ProgressMeter meter(!line.quiet);
  KeptStages kept(config.archive.output);
  return execute(line, config, kept);
}

Result do_pipeline(const CommandLine& line) {
  if (names_logs(line.files)) return do_run_log(line);
  if (line.files.size() != 1)
    throw ConfigurationError("run needs one configuration file, or logs: modebank run CONFIG");
  Origins origins;
  const Config config = load_config(line.files.front(), line.overrides, &origins);
  validate(config);
  Result result = do_configured(line, config, line.files.front());
  if (line.dry_run) add_values(config, origins, result);
  return result;
}

int run_pipeline(const CommandLine& line) { return print_result(line, do_pipeline(line)); }

}  // namespace modebank::app
