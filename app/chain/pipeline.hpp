#pragma once

#include <filesystem>
#include <string>

#include "app/chain/chain.hpp"
#include "app/config/config.hpp"
#include "app/text/warnings.hpp"

/// What `modebank run` does, for everyone who does it: the program and the Python module.
namespace modebank::app {

/// A listener that also says, as warnings, what of a stage's result needs a look.
class Adviser : public Listener {
 public:
  void done(Stage stage, const Archive& archive) const override;
  void warn_of_windows(const WindowFits& windows, const WindowCounts& counts) const;
};

/// Throws ConfigurationError, before anything is read, for keys that the command does not have, values that do not fit
/// each other, files that do not exist, and an archive that cannot be written or would take the place of what it is
/// made from. `file`: of the configuration; empty: there is none.
void check_request(const std::string& command, const Config& config, const std::filesystem::path& file,
                   const MemoryTables* memory = nullptr);

/// Runs the chain's stages up to `last`, or scores the banks of an archive (`banks`, else empty), and writes the result
/// to `output`, evaluations as they are made where there are too many to hold. Returns the archive, in that case
/// without them.
const Archive& run_and_write(Chain& chain, const ChainOptions& options, Stage last, const std::string& banks,
                             const Execution& execution, const std::filesystem::path& output);

/// All stages, computed, written to archive.output. `typed`: for provenance; `memory`: runs in place of files. Throws
/// what the stages throw.
void run_all(const Config& config, const std::string& typed, const Listener& listener,
             const MemoryTables* memory = nullptr);

}  // namespace modebank::app
