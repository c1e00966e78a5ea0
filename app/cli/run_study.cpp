#include "app/cli/commands.hpp"
#include "app/cli/dry_run.hpp"
#include "app/config/config_file.hpp"
#include "app/study/answers/study_json.hpp"
#include "app/study/study.hpp"

namespace modebank::app {

int run_study(const CommandLine& line) {
  const std::string& file = line.files.front();
  const Config config = load_config(file, line.overrides);
  if (line.dry_run) return print_result(line, dry_run(config, {config.study.output}));
  const auto say = [&](const std::string& text) { print_text(line, text); };
  const int status = do_study({config, file, line.overrides, line.typed, say});
  if (line.json) print_json(line, study_json(config.study.output), status);
  return status;
}

}  // namespace modebank::app
