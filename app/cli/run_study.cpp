#include "app/cli/commands.hpp"
#include "app/cli/dry_run.hpp"
#include "app/config/config_file.hpp"
#include "app/report/page/write_page.hpp"
#include "app/study/study.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app {

int run_study(const CommandLine& line) {
  if (line.files.size() != 1) throw ConfigurationError("study needs one configuration file: modebank study CONFIG");
  const std::string& file = line.files.front();
  const Config config = load_config(file, line.overrides);
  if (line.dry_run) return print_dry_run(config, {config.study.output});
  return do_study({config, file, line.overrides, line.typed, report::write_running_study});
}

}  // namespace modebank::app
