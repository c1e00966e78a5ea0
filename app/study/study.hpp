#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "app/config/config_file.hpp"

namespace modebank::app {

/// One call of `modebank study`.
struct StudyCall {
  Config config;
  std::filesystem::path config_file;                                        ///< path of the configuration file
  KeyValues overrides;                                                      ///< keys of the command line
  std::string typed;                                                        ///< the whole command line, for the
                                                                            ///< provenance
  std::function<void(const std::string&)> say = [](const std::string&) {};  ///< prints progress
};

/// Executes the step study.stage and reports the result. Returns 0 if every run is done, else 1. Throws
/// ConfigurationError, or DataError if the study had to stop.
int do_study(const StudyCall& call);

}  // namespace modebank::app
