#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "app/config/config_file.hpp"

namespace modebank::app {

/// One call of `modebank study`.
struct StudyCall {
  Config config;
  std::filesystem::path config_file;                                        ///< file of the configuration
  KeyValues overrides;                                                      ///< keys from the command line
  std::string typed;                                                        ///< the whole command line, for provenance
  std::function<void(const std::string&)> say = [](const std::string&) {};  ///< prints progress
};

/// Executes study.stage and reports the result. Returns 0 when every run is done, else 1. Throws ConfigurationError,
/// and DataError when the study had to stop.
int do_study(const StudyCall& call);

}  // namespace modebank::app
