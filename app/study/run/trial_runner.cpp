#include "app/study/run/trial_runner.hpp"

#include "app/chain/provenance.hpp"
#include "app/config/config_file.hpp"

namespace modebank::app {

const Archive& TrialRunner::run(const Config& config, const std::string& typed) {
  return chain_.run(chain_options(config), Stage::bank_scores,
                    {resolved_text(config), make_provenance(config_hash(config), typed)});
}

}  // namespace modebank::app
