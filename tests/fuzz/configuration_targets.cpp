#include <stdexcept>

#include "app/config/config_file.hpp"
#include "app/config/option_table.hpp"
#include "app/study/space/study_space.hpp"
#include "tests/fuzz/mutate.hpp"
#include "tests/fuzz/scratch.hpp"
#include "tests/fuzz/target.hpp"

namespace modebank::fuzz {

namespace {

/// A configuration file as every command reads it. What it was resolved to is a configuration of the same meaning.
void read_configuration(std::string_view text) {
  const app::Config config = app::load_config(scratch_file("fuzz.ini", text), {});
  const std::string resolved = app::resolved_text(config);
  if (app::resolved_text(app::resolved_config(resolved)) != resolved)
    throw std::logic_error("the resolved configuration reads back as another one");
  app::validate(config);
  constexpr Index few_points = 1000;
  if (config.study.sample <= few_points) app::lay_out(config);
}

std::vector<std::string> ini_corpus() {
  std::vector<std::string> texts = corpus("ini");
  texts.push_back(app::resolved_text({}));
  return texts;
}

std::vector<std::string> ini_tokens() {
  std::vector<std::string> tokens{"[study]\nvary = ", "{1:5:1}", " | ", "{0.1..1 log 3}", "together", "auto", "none"};
  for (const app::Option& option : app::option_table()) {
    tokens.push_back(option.key);
    tokens.push_back(option.name() + " = ");
    tokens.push_back("[" + option.section() + "]\n" + option.name() + " = ");
  }
  return tokens;
}

}  // namespace

std::vector<Target> configuration_targets() {
  return {{"ini", 1'000'000,
           [](Random& random) {
             static const auto texts = ini_corpus(), tokens = ini_tokens();
             return mutated_text(random, texts, tokens);
           },
           read_configuration}};
}

}  // namespace modebank::fuzz
