#pragma once

#include <string>
#include <vector>

#include "app/report/html_page.hpp"
#include "app/study/study_table.hpp"
#include "io/study_file.hpp"

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

}  // namespace modebank::app::report
