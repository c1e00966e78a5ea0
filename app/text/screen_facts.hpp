#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "app/text/errors_ahead.hpp"
#include "app/text/mode_tables.hpp"
#include "app/text/named_forecasts.hpp"
#include "app/text/next_step.hpp"
#include "io/archive/archive.hpp"

/// What the first screen of a run says, in words and numbers: on a terminal (first_screen.hpp) and on the report's
/// page.
namespace modebank::app {

/// Whether the archive holds what the screen is about: a bank and its scores.
bool has_first_screen(const Archive& archive);

/// What the screen says, computed once: first_screen prints it, the report's page shows it. Sentences are empty where
/// there is nothing to say.
struct FirstScreen {
  std::string read, structure, finding, band, mean, warning, next;
  std::string use;                       ///< which filter to understand the motion by, and which to predict with
  std::vector<NamedForecast> forecasts;  ///< the latter in numbers
  bool inputs_ahead = false;             ///< the stamps of the inputs are late
  Role role = Role::test;                ///< of the judged runs
  std::string competitor;                ///< that of highest log score, which the gain is over; empty without
  std::optional<Answer> answer;
  double gain = 0.0, gain_error = 0.0;  ///< of log score over the competitor [nats/sample]; NaN where not known
  double coverage = 0.0, coverage_lower = 0.0, coverage_upper = 0.0;  ///< of the 95 % band; NaN where not known
  Calibration verdict = Calibration::undecided;
  std::string verdict_words;       ///< with what it rests on; empty where the bank was not scored
  std::vector<ErrorAhead> errors;  ///< one step ahead, and as far as filter.horizon looks
  Index free_run_start = 0;        ///< measured samples that free runs begin with; 0: there are none
  Eigen::VectorXd fit, other_fit;  ///< n_y, of the free runs [%], and the best of the competitors'
  std::string other_fit_words;     ///< that of the competitor with its name
  Index mode_count = 0;
  ModeTable modes;  ///< of a scored bank
};
FirstScreen make_first_screen(const Archive& archive, const Settings& settings);

/// "evidence for modes of motion": the answer as a headline has it.
std::string answer_words(Answer answer);

}  // namespace modebank::app
