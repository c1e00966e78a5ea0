#include "app/chain/provenance.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <ctime>

#include "app/chain/build_info.hpp"
#include "ident/base/printable.hpp"

namespace modebank {

Provenance make_provenance(const std::string& config_hash, const std::string& command_line) {
  Provenance provenance;
  provenance.modebank_version = build_info::version;
  provenance.created = fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr)));
  provenance.command_line = printable(command_line);
  provenance.config_hash = config_hash;
  provenance.versions = {{"ceres", build_info::ceres},       {"eigen", build_info::eigen},
                         {"hdf5", build_info::hdf5},         {"boost", build_info::boost},
                         {"compiler", build_info::compiler}, {"git", build_info::git_revision}};
  return provenance;
}

}  // namespace modebank
