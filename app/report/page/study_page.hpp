#pragma once

#include <limits>
#include <string>
#include <vector>

#include "app/report/page/html_page.hpp"
#include "app/study/answers/study_table.hpp"
#include "io/archive/study_file.hpp"

namespace modebank::app::report {

/// The table from which study.h5 was made. Throws the exceptions of read_study_file, and DataError if columns of a
/// study are missing.
StudyTable study_table_of(const StudyFile& file);

/// Files of a trial.
struct TrialPlace {
  std::string page;     ///< path relative to the page of the study; empty if the file does not exist
  std::string archive;  ///< empty: missing
};

/// Gain of one setting over another in a score. Repeats with the same number have the same seed, so they are paired.
struct RepeatGain {
  Eigen::Index repeats = 0;
  double gain = std::numeric_limits<double>::quiet_NaN();
  double standard_error = gain,
         margin = gain;  ///< NaN for a single repeat; margin: t(0.975, repeats - 1) standard errors
};
RepeatGain repeat_gain(const StudyTable& table, const std::vector<std::size_t>& best,
                       const std::vector<std::size_t>& other, std::size_t score);

/// Whether the best setting is better than the next ones, by its mean gain in log score over each of them. One standard
/// error is over the runs, if the archives of the first repeat have runs in common. Another is over the repeats. Null
/// for fewer than two settings.
nlohmann::json better_section(const StudyTable& table, const std::vector<TrialPlace>& places,
                              const std::string& headline);

/// The page of a study. `places`: one entry per row of `table`.
Page study_page(const StudyFile& file, const StudyTable& table, const std::vector<TrialPlace>& places,
                const std::string& name);

}  // namespace modebank::app::report
