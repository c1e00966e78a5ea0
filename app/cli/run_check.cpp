#include <fmt/format.h>
#include <tbb/global_control.h>

#include <nlohmann/json.hpp>

#include "app/cli/check_output.hpp"
#include "app/cli/commands.hpp"
#include "app/config/config_file.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app {

int run_check(const CommandLine& line) {
  if (line.files.size() != 1) throw ConfigurationError("check needs one configuration file: modebank check CONFIG");
  const Config config = load_config(line.files.front(), line.overrides);
  validate(config);
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, config.job.thread_count());
  const DataCheck check = check_data({config.data, config.window.length, config.window.intercept});
  const std::vector<std::string> findings = findings_of(check, config);
  fmt::print("{}", line.json ? check_json(check, findings).dump(2) + "\n" : check_text(check, findings));
  if (!check.unusable.empty()) throw DataError("unusable as configured: " + unusable_text(check));
  return 0;
}

}  // namespace modebank::app
