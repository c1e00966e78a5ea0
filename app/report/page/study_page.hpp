#pragma once

#include <limits>
#include <string>
#include <vector>

#include "app/report/page/html_page.hpp"
#include "app/study/answers/study_table.hpp"
#include "io/archive/study_file.hpp"

namespace modebank::app::report {

/// Reads study.h5 back into the table that it was made of. Throws as read_study_file does, and DataError when columns
/// of a study are missing.
StudyTable study_table_of(const StudyFile& file);

/// Where a run of the study can be looked at.
struct TrialPlace {
  std::string page;     ///< relative to the study's page; empty: none
  std::string archive;  ///< empty: not there
};

/// How much better one setting scores than another, paired by repeat: repeats of one number share their seed.
struct RepeatGain {
  Eigen::Index repeats = 0;
  double gain = std::numeric_limits<double>::quiet_NaN();
  double standard_error = gain, margin = gain;  ///< NaN below two repeats; t(0.975, repeats - 1) standard errors
};
RepeatGain repeat_gain(const StudyTable& table, const std::vector<std::size_t>& best,
                       const std::vector<std::size_t>& other, std::size_t score);

/// Whether the best setting is better than the next ones: its gain in log score over each, the mean over repeats, with
/// an error paired by run where the archives hold the same runs (of the first repeat), and by repeat. Null without two
/// settings.
nlohmann::json better_section(const StudyTable& table, const std::vector<TrialPlace>& places,
                              const std::string& headline);

/// The page of a study: `places` holds one entry per row of `table`.
Page study_page(const StudyFile& file, const StudyTable& table, const std::vector<TrialPlace>& places,
                const std::string& name);

}  // namespace modebank::app::report
