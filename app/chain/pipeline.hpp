#pragma once

#include <filesystem>
#include <string>

#include "app/chain/chain.hpp"
#include "app/config/config.hpp"
#include "app/text/warnings.hpp"

/// The steps of `modebank run`, for the program and the Python module.
namespace modebank::app {

/// A listener that also warns where a stage's result needs attention.
class Adviser : public Listener {
 public:
  void done(Stage stage, const Archive& archive) const override;
  void warn_of_windows(const WindowFits& windows, const WindowCounts& counts) const;
};

/// Checks a configuration before anything is read. Throws ConfigurationError for keys that the command does not have,
/// values that do not fit each other and files that do not exist. It also throws for an archive that cannot be written
/// or would replace one of its sources. `file`: path of the configuration; empty: there is none.
void check_request(const std::string& command, const Config& config, const std::filesystem::path& file,
                   const MemoryTables* memory = nullptr);

/// Runs the chain's stages up to `last` and writes the result to `output`. With `banks` (else empty), scores the banks
/// of that archive instead. Evaluations that do not fit into memory are written as they are made. Returns the archive,
/// in that case without evaluations.
const Archive& run_and_write(Chain& chain, const ChainOptions& options, Stage last, const std::string& banks,
                             const Execution& execution, const std::filesystem::path& output);

/// Computes all stages and writes them to archive.output. `typed`: command line, for provenance; `memory`: runs in
/// place of files. Throws what the stages throw.
void run_all(const Config& config, const std::string& typed, const Listener& listener,
             const MemoryTables* memory = nullptr);

}  // namespace modebank::app
