#pragma once

#include <filesystem>
#include <string>

#include "app/chain/chain.hpp"
#include "app/config/config.hpp"
#include "app/text/warnings.hpp"

/// The steps of `modebank run`, for the program and the Python module.
namespace modebank::app {

/// A listener that also prints a warning if a stage's result needs attention.
class Adviser : public Listener {
 public:
  void done(Stage stage, const Archive& archive) const override;
  void warn_of_windows(const WindowCounts& counts) const;
};

/// Checks a configuration before any file is read. `file` is the path of the configuration, or empty without one.
/// Throws ConfigurationError for:
/// - values that do not fit each other,
/// - files that do not exist,
/// - an archive that cannot be written or that would replace one of its sources.
void check_request(const Config& config, const std::filesystem::path& file, const MemoryTables* memory = nullptr);

/// Runs the chain's stages up to `last`, writes the result to `output` and returns the archive. If `banks` is not
/// empty, scores the banks of that archive instead. Evaluations that do not fit into memory are written at once, and
/// the returned archive does not contain them.
const Archive& run_and_write(Chain& chain, const ChainOptions& options, Stage last, const std::string& banks,
                             const Execution& execution, const std::filesystem::path& output);

/// Computes all stages and writes them to archive.output. `typed`: the command line, for the provenance. `memory`: runs
/// in memory, used in place of files. Throws the exceptions of the stages.
void run_all(const Config& config, const std::string& typed, const Listener& listener,
             const MemoryTables* memory = nullptr);

}  // namespace modebank::app
