#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <tbb/global_control.h>

#include <nlohmann/json.hpp>

#include "app/cli/check/check_output.hpp"
#include "app/cli/check/check_suggestions.hpp"
#include "app/cli/commands.hpp"
#include "app/cli/json_number.hpp"
#include "app/cli/progress_meter.hpp"
#include "app/cli/result.hpp"
#include "app/config/valid_config.hpp"
#include "app/text/structure_text.hpp"
#include "app/text/terminal.hpp"
#include "ident/base/printable.hpp"
#include "io/import/import.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app {
namespace {

class ScoringLog : public Listener {
 public:
  void progress(const std::string& line) const override { spdlog::info("{}", line); }
};

nlohmann::json structure_json(const FoundStructure& found) {
  nlohmann::json scores = nlohmann::json::array();
  for (const StructureScore& s : found.scores)
    scores.push_back({{"state_lags", s.state_lags},
                      {"input_lags", s.input_lags},
                      {"input_delay", s.input_delay},
                      {"log_score", json_number(s.log_score)},
                      {"loss", json_number(s.loss)},
                      {"loss_standard_error", json_number(s.loss_standard_error)},
                      {"rmse", json_numbers(s.rmse)},
                      {"drifting_score", json_number(s.drifting_score)},
                      {"one_motion_score", json_number(s.one_motion_score)},
                      {"modes_score", json_number(s.modes_score)},
                      {"chosen", s.chosen},
                      {"one_motion", s.one_motion},
                      {"linear", s.linear},
                      {"drifting", s.drifting}});
  return {{"state_lags", found.state_lags},
          {"input_lags", found.input_lags},
          {"input_delay", found.input_delay},
          {"samples", found.samples},
          {"structures", found.structures},
          {"feedback", found.feedback()},
          {"feedback_t", json_number(found.feedback_t)},
          {"same_sample_t", json_number(found.same_sample_t)},
          {"remark", found.remark},
          {"scores", scores}};
}

/// Prints findings at once, and each suggestion as soon as it is scored.
void tell(const CommandLine& line, const Config& config, const DataCheck& check, nlohmann::json& page) {
  const std::vector<std::string> findings = findings_of(check, config);
  print_text(line, check_text(check, findings));
  const bool usable = check.unusable.empty(), scored = usable && !line.findings;
  const ChainOptions options = chain_options(config);
  const std::optional<FoundStructure> found = scored ? find_structure(options, ScoringLog()) : std::nullopt;
  if (found) {
    const int width = standard_output().width;
    print_text(line, "\n" + wrapped(structure_text(*found, !config.data.input.empty(), width), width));
  }
  const Suggestions suggestions = scored ? suggest(with_found(options, found), check, {}, ScoringLog()) : Suggestions{};
  if (scored) print_text(line, suggestions_text(suggestions, config));
  if (line.json) {
    page = check_json(check, findings);
    page["structure"] = found ? structure_json(*found) : nlohmann::json(nullptr);
    page["suggestions"] = scored ? suggestions_json(suggestions, config) : nlohmann::json(nullptr);
  }
  if (usable) return;
  print_json(line, page, 1);
  throw DataError("unusable as configured: " + unusable_text(check));
}

}  // namespace

int run_check(const CommandLine& line) {
  const Config config = load_valid_config(line.files.front(), line.overrides);
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, config.job.thread_count());
  const ProgressMeter meter(!line.quiet);
  const DataCheck check = check_data({data_options_of(config), config.window.length, config.window.intercept});
  nlohmann::json page;
  tell(line, config, check, page);
  print_json(line, page);
  return 0;
}

}  // namespace modebank::app
