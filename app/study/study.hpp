#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "app/config/config_file.hpp"

namespace modebank::app {

/// A study as it was asked for.
struct StudyCall {
  Config config;
  std::filesystem::path config_file;                                        ///< it was read from
  KeyValues overrides;                                                      ///< and these from the command line
  std::string typed;                                                        ///< the whole command line, for provenance
  std::function<void(const std::string&)> say = [](const std::string&) {};  ///< takes what it says of its progress
};

/// Does what study.stage says and says what it did. Returns 0 when every run is done, else 1.
/// Throws ConfigurationError, and DataError when the study had to stop.
int do_study(const StudyCall& call);

}  // namespace modebank::app
