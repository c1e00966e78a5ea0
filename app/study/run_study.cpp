#include <fmt/format.h>

#include "app/commands.hpp"
#include "app/config_file.hpp"
#include "app/pipeline.hpp"
#include "app/study/study_plan.hpp"
#include "ident/error.hpp"

namespace modebank::app {

int run_study(const CommandLine& line) {
  if (line.files.size() != 1) throw ConfigurationError("study needs one configuration file: modebank study CONFIG");
  const Config config = load_config(line.files.front(), line.overrides);
  validate(config);
  throw ConfigurationError(fmt::format("study.stage = {}: not there yet", name_of(config.study.stage)));
}

}  // namespace modebank::app
