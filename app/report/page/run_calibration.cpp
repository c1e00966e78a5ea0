#include <fmt/format.h>

#include <boost/algorithm/string.hpp>
#include <cmath>

#include "app/config/config_file.hpp"
#include "app/report/page/numbers.hpp"
#include "app/report/page/run_sections.hpp"
#include "app/text/screen_facts.hpp"

namespace modebank::app::report {
namespace {

using nlohmann::json;

/// Replaces "+-" by the sign that the page uses: "0.3 ± 0.1".
std::string with_signs(const std::string& text) { return boost::replace_all_copy(text, " +- ", " ± "); }

json card(const std::string& key, const std::string& name, const json& big, const std::string& unit,
          const std::string& said) {
  return {{"key", key}, {"name", name}, {"big", big}, {"unit", unit}, {"said", said}};
}

std::string competitor_words(const std::string& words) { return words.empty() ? "no competitor was scored" : words; }

json gain_card(const FirstScreen& screen) {
  if (std::isnan(screen.gain)) return nullptr;
  const std::string known =
      std::isfinite(screen.gain_error) ? "above 0 the bank predicts better" : "its error is unknown";
  // Rounds like the sentence of the finding, so that a number is the same everywhere on the screen.
  const std::string error = std::isfinite(screen.gain_error) ? fmt::format(" ± {:.3f}", screen.gain_error) : "";
  const json gain = number(screen.gain, fmt::format("{:+.3f}{}", screen.gain, error));
  return card("gain", "Gain over " + screen.competitor, gain, "nats per sample", known);
}

json coverage_card(const FirstScreen& screen) {
  if (std::isnan(screen.coverage)) return nullptr;
  return card("coverage", "In the 95 % band", number(screen.coverage, fmt::format("{:.1f} %", 100 * screen.coverage)),
              fmt::format("[{:.1f}, {:.1f}]", 100 * screen.coverage_lower, 100 * screen.coverage_upper),
              screen.verdict_words);
}

json error_card(const ErrorAhead& error) {
  const std::string name = error.steps == 1 ? "RMSE one step ahead" : fmt::format("RMSE {} steps ahead", error.steps);
  json big = number_list(error.rmse);
  big["t"] = error.words;
  return card("error", name, big, "", competitor_words(error.other_words));
}

json fit_card(const FirstScreen& screen) {
  json big = number_list(screen.fit);
  big["t"] = fit_words(screen.fit);
  return card("fit", "FIT of the free run", big, "", competitor_words(screen.other_fit_words));
}

json cards_of(const FirstScreen& screen) {
  json cards = json::array();
  for (const json& made : {coverage_card(screen), gain_card(screen)})
    if (!made.is_null()) cards.push_back(made);
  for (const ErrorAhead& error : screen.errors) cards.push_back(error_card(error));
  if (screen.errors.size() == 1)
    cards.push_back(card("error", "RMSE ten steps ahead", nullptr, "", "not computed; run with --filter.horizon 10"));
  if (screen.free_run_start > 0) cards.push_back(fit_card(screen));
  return cards;
}

json modes_of(const Archive& archive, const FirstScreen& screen) {
  if (screen.modes.rows.empty()) return nullptr;
  json rows = json::array();
  for (const ModeTable::Row& row : screen.modes.rows) {
    json cells = json::array();
    for (const std::string& cell : row.cells) cells.push_back(with_signs(cell));
    rows.push_back({{"modes", row.modes}, {"cells", cells}});
  }
  const ModeTable& modes = screen.modes;
  const std::string others = modes.others == 0 ? ""
                                               : fmt::format("and {} other{}, used {:.1f} % together", modes.others,
                                                             modes.others == 1 ? "" : "s", 100 * modes.others_use);
  return {{"title", motion_words(*archive.bank)},
          {"headings", modes.headings},
          {"rows", rows},
          {"others", others},
          {"gain_unit", modes.gain_unit}};
}

/// true for evidence and a reliable band; null if undecided
json goodness(const FirstScreen& screen) {
  if (!screen.answer || *screen.answer == Answer::cannot_tell || *screen.answer == Answer::not_comparable ||
      *screen.answer == Answer::not_yet)
    return nullptr;
  if (*screen.answer == Answer::one_mode) return screen.verdict == Calibration::calibrated ? json(true) : json(nullptr);
  return *screen.answer == Answer::evidence && screen.verdict == Calibration::calibrated;
}

std::string headline(const Archive& archive, const FirstScreen& screen) {
  if (!screen.answer) return "nothing was judged";
  if (*screen.answer == Answer::one_mode) return answer_words(*screen.answer);
  // Without evidence for modes, the text only states how many modes the bank has.
  return fmt::format("{} ({}{})", answer_words(*screen.answer),
                     *screen.answer == Answer::evidence ? "" : "the bank has ", counted_words(*archive.bank));
}

}  // namespace

nlohmann::json verdict_section(const Archive& archive) {
  const FirstScreen screen = make_first_screen(archive, resolved_values(archive.config));
  return {{"headline", headline(archive, screen)},
          {"answer", screen.answer ? json(name_of(*screen.answer)) : json()},
          {"good", goodness(screen)},
          {"equations", archive.finding ? archive.finding->equations : std::vector<std::string>()},
          {"text", screen.answer ? with_signs(screen.finding)
                                 : std::string("No bank was scored, so there is nothing to judge yet.")},
          {"use", screen.use},
          {"warning", screen.warning},
          {"read", screen.read},
          {"cards", cards_of(screen)},
          {"modes", modes_of(archive, screen)}};
}

}  // namespace modebank::app::report
