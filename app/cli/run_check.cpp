#include <tbb/global_control.h>

#include <nlohmann/json.hpp>

#include "app/cli/check/check_output.hpp"
#include "app/cli/commands.hpp"
#include "app/cli/progress_meter.hpp"
#include "app/cli/result.hpp"
#include "app/config/config_file.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app {
int run_check(const CommandLine& line) {
  const Config config = load_config(line.files.front(), line.overrides);
  validate(config);
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, config.job.thread_count());
  const ProgressMeter meter(!line.quiet);
  const DataCheck check = check_data({data_options_of(config), config.window.length, config.window.intercept});
  const std::vector<std::string> findings = findings_of(check, config);
  print_text(line, check_text(check, findings));
  print_json(line, check_json(check, findings), check.unusable.empty() ? 0 : 1);
  if (!check.unusable.empty()) throw DataError("unusable as configured: " + unusable_text(check));
  return 0;
}

}  // namespace modebank::app
