#pragma once

#include <Eigen/Core>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "app/text/errors_ahead.hpp"
#include "app/text/mode_tables.hpp"
#include "app/text/named_forecasts.hpp"
#include "io/archive/archive.hpp"

/// Content of the first screen of a run, in words and numbers. It is printed on a terminal (first_screen.hpp) and shown
/// on the report's page.
namespace modebank::app {

/// Resolved keys and their values, from the configuration in the archive.
using Settings = std::map<std::string, std::string>;

/// Whether the archive contains a bank and the bank's scores. The screen needs both.
bool has_first_screen(const Archive& archive);

/// Content of the screen, computed once. first_screen prints it, and the report's page shows it. A sentence that does
/// not apply is empty.
struct FirstScreen {
  std::string read, structure, finding, band, mean, warning;
  std::string point, doubt;              ///< operating_words and level_doubt of the single linear model
  std::string use;                       ///< text: the filter that explains the motion, and the filter to predict with
  std::vector<NamedForecast> forecasts;  ///< the filters to predict with, with their numbers
  bool inputs_ahead = false;             ///< whether the inputs' stamps are late
  Role role = Role::test;                ///< role of the runs on which the filters are judged
  std::string filter;      ///< filter that `use` names one step ahead; band, errors and free runs are its own
  std::string competitor;  ///< competitor with the highest log score; the gain is over this competitor. Empty if there
                           ///< is none
  std::optional<Answer> answer;
  double gain = 0.0, gain_error = 0.0;  ///< gain of log score over the competitor [nats/sample]; NaN if unknown
  double coverage = 0.0, coverage_lower = 0.0, coverage_upper = 0.0;  ///< coverage of the 95 % band with its interval;
                                                                      ///< NaN if unknown
  Calibration verdict = Calibration::undecided;
  std::string verdict_words;  ///< verdict on the band, and the number of samples; empty if the filter was not scored
  std::vector<ErrorAhead> errors;  ///< errors one step ahead and at the longest scored horizon
  Index free_run_start = 0;        ///< number of measured samples at the start of free runs; 0 if there are no free
                                   ///< runs
  Eigen::VectorXd fit;             ///< n_y, FIT of the filter's free runs [%]
  std::string other_fit_words;     ///< FIT of another filter's free runs, with its name: the bank's or the competitor's
  Index mode_count = 0;
  ModeTable modes;  ///< empty if the bank was not scored, or if the finding describes the runs without modes
};
FirstScreen make_first_screen(const Archive& archive, const Settings& settings);

/// The answer as a headline, such as "evidence for modes of motion".
std::string answer_words(Answer answer);

}  // namespace modebank::app
