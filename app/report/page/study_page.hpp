#pragma once

#include <string>
#include <vector>

#include "app/report/figures/run_figures.hpp"
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

/// The page of a study: `places` holds one entry per row of `table`.
Page study_page(const StudyFile& file, const StudyTable& table, const std::vector<TrialPlace>& places,
                const std::string& name);

/// coverage: the paper's figure 5 over K, shares of samples outside the interval of the baseline, of noise only and of
/// the banks with each number of components; effects: the best that each value of each key reaches; pareto: log score
/// over the number of modes.
FigureSet study_figures(const StudyTable& table);

}  // namespace modebank::app::report
