// Reads configurations, and the points of their studies.
#include "app/config/config_file.hpp"
#include "app/study/space/study_space.hpp"
#include "tests/fuzz/entry.hpp"

namespace modebank::fuzz {

namespace {

/// Reads a configuration file in the same way as the commands. The resolved text must be a configuration with the same
/// meaning.
void read_configuration(std::string_view text) {
  const app::Config config = app::load_config(scratch_file("fuzz.ini", text), {});
  const std::string resolved = app::resolved_text(config);
  require(app::resolved_text(app::resolved_config(resolved)) == resolved,
          "the resolved configuration reads back as another one");
  app::validate(config);
  constexpr Index few_points = 1000;
  if (config.study.sample <= few_points) app::lay_out(config);
}

const Entry ini("ini", read_configuration);

}  // namespace

}  // namespace modebank::fuzz
