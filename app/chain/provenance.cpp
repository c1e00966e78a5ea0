#include "app/provenance.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <ctime>

#include "app/build_info.hpp"
#include "app/config_file.hpp"

namespace modebank::app {

Provenance make_provenance(const Config& config, const CommandLine& line) {
  Provenance provenance;
  provenance.modebank_version = build_info::version;
  provenance.created = fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr)));
  provenance.command_line = line.typed;
  provenance.config_hash = config_hash(config);
  provenance.versions = {{"ceres", build_info::ceres},       {"eigen", build_info::eigen},
                         {"hdf5", build_info::hdf5},         {"boost", build_info::boost},
                         {"compiler", build_info::compiler}, {"git", build_info::git_revision}};
  return provenance;
}

}  // namespace modebank::app
