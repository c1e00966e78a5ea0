#include "app/chain/pipeline.hpp"

#include <fmt/format.h>
#include <tbb/global_control.h>

#include "app/chain/provenance.hpp"
#include "app/config/config_file.hpp"
#include "io/archive/archive_form.hpp"
#include "io/files/replace_file.hpp"
#include "io/import/import.hpp"
#include "mixture/criteria.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app {

namespace {

void check_bank(const std::string& file) {
  if (!file.empty() && !std::filesystem::exists(file)) throw ConfigurationError(fmt::format("{}: no such file", file));
}

/// Input files of a run.
std::vector<std::filesystem::path> sources_of(const Config& config, const std::filesystem::path& configuration,
                                              const MemoryTables* memory) {
  std::vector<std::filesystem::path> sources;
  for (const std::filesystem::path& file : {configuration, std::filesystem::path(config.archive.bank)})
    if (!file.empty()) sources.push_back(file);
  if (memory == nullptr)
    for (const DataFile& file : data_files(config.data)) sources.push_back(file.path);
  return sources;
}

}  // namespace

void Adviser::done(Stage stage, const Archive& archive) const {
  if (stage == Stage::windows) {
    WindowCounts counts;
    counts.add(*archive.windows);
    warn_of_windows(counts);
  }
  // A refined bank keeps nothing of the mixture, so warnings about the mixture do not apply.
  if (stage == Stage::bank && archive.mixture && !archive.unrefined)
    for (const std::string& text : selection_warnings(archive.mixture->candidates))
      tell(Level::warning, "mixture: " + text);
  if (const std::string text = refinement_warning(archive.measured_fit); stage == Stage::bank && !text.empty())
    tell(Level::warning, "refine: " + text);
  if (stage == Stage::bank_scores)
    if (const std::string text = unscored_warning(archive); !text.empty()) tell(Level::warning, "scores: " + text);
}

void Adviser::warn_of_windows(const WindowCounts& counts) const {
  if (const std::string found = window_warning(counts); !found.empty()) tell(Level::warning, "windows: " + found);
}

void check_request(const Config& config, const std::filesystem::path& file, const MemoryTables* memory) {
  check_bank(config.archive.bank);
  validate(config);
  const bool replaces = std::filesystem::exists(config.archive.output);
  check_output({"archive.output", config.archive.output, archive_form()},
               replaces ? sources_of(config, file, memory) : std::vector<std::filesystem::path>());
}

const Archive& run_and_write(Chain& chain, const ChainOptions& options, Stage last, const std::string& banks,
                             const Execution& execution, const std::filesystem::path& output) {
  const auto make = [&](const EvaluationSink* sink) -> const Archive& {
    return banks.empty() ? chain.run(options, last, execution, sink)
                         : chain.judge_stored(banks, options, execution, sink);
  };
  if (last == Stage::bank_scores) {
    const Recording& recording = *chain.run(options, Stage::data, execution).recording;
    const Archive* archive = nullptr;
    const auto make_streamed = [&](const EvaluationSink& sink) -> const Archive& { return *(archive = &make(&sink)); };
    if (streams_evaluations(recording)) {
      write_archive(final_target(output), recording, make_streamed);
      return *archive;
    }
  }
  const Archive& archive = make(nullptr);
  write_archive(final_target(output), archive);
  return archive;
}

void run_all(const Config& config, const std::string& typed, const Listener& listener, const MemoryTables* memory) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, config.job.thread_count());
  StageSource computed;
  Chain chain(computed, listener, memory);
  run_and_write(chain, chain_options(config), Stage::bank_scores, config.archive.bank,
                {resolved_text(config), make_provenance(config_hash(config), typed)}, config.archive.output);
}

}  // namespace modebank::app
