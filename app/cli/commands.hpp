#pragma once

#include <filesystem>

#include "app/cli/command_line.hpp"
#include "app/cli/result.hpp"
#include "app/config/config.hpp"

namespace modebank::app {

/// Runs the command and returns the exit status. On an error it throws: ConfigurationError gives status 2, all other
/// exceptions give status 1.
int run_command(const CommandLine& line);

int run_pipeline(const CommandLine& line);    ///< the command run
Result do_pipeline(const CommandLine& line);  ///< same as run_pipeline, without printing
/// Same as do_pipeline, for a valid configuration. `file` is the configuration's path, which need not exist yet.
Result do_configured(const CommandLine& line, const Config& config, const std::filesystem::path& file);
int run_init(const CommandLine& line);
int run_demo(const CommandLine& line);
int run_check(const CommandLine& line);
int run_simulate(const CommandLine& line);
Result do_simulate(const CommandLine& line);  ///< same as the command simulate, without printing
/// Reads the parameters of the system that simulate.system names. The name is a file with a section [system], relative
/// to `folder`, or a built-in system (configs/systems). Throws ConfigurationError with file and line, also for a
/// parameter that this kind of system does not have.
void read_system(const std::filesystem::path& folder, Config& config);
int run_report(const CommandLine& line);
int run_study(const CommandLine& line);
int run_show(const CommandLine& line);
int run_track(const CommandLine& line);
int run_predict(const CommandLine& line);
int run_export(const CommandLine& line);
int run_verify(const CommandLine& line);

}  // namespace modebank::app
