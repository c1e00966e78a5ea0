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

/// The content of a run's first screen, in words and numbers: for a terminal (first_screen.hpp) and for the report's
/// page.
namespace modebank::app {

/// Whether the archive contains a bank and its scores, which the screen needs.
bool has_first_screen(const Archive& archive);

/// The screen's content, computed once. first_screen prints it, the report's page shows it. A sentence is empty if it
/// does not apply.
struct FirstScreen {
  std::string read, structure, finding, band, mean, warning, next;
  std::string use;                       ///< the filter that explains the motion, and the filter to predict with
  std::vector<NamedForecast> forecasts;  ///< the filter to predict with, as numbers
  bool inputs_ahead = false;             ///< whether the stamps of the inputs are late
  Role role = Role::test;                ///< role of the judged runs
  std::string competitor;  ///< competitor with the highest log score, with which the gain is compared; empty without
  std::optional<Answer> answer;
  double gain = 0.0, gain_error = 0.0;  ///< of log score over the competitor [nats/sample]; NaN if unknown
  double coverage = 0.0, coverage_lower = 0.0, coverage_upper = 0.0;  ///< coverage of the 95 % band; NaN if unknown
  Calibration verdict = Calibration::undecided;
  std::string verdict_words;       ///< verdict on the band and the number of samples; empty if the bank was not scored
  std::vector<ErrorAhead> errors;  ///< one step ahead, and at the longest scored horizon
  Index free_run_start = 0;        ///< measured samples at the start of free runs; 0: there are no free runs
  Eigen::VectorXd fit, other_fit;  ///< n_y, FIT of the bank's free runs [%], and the best FIT of the competitors
  std::string other_fit_words;     ///< the best competitor's free run, with its name
  Index mode_count = 0;
  ModeTable modes;  ///< filled if the bank was scored
};
FirstScreen make_first_screen(const Archive& archive, const Settings& settings);

/// "evidence for modes of motion": the answer as a headline.
std::string answer_words(Answer answer);

}  // namespace modebank::app
