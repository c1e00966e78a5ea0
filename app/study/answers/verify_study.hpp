#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace modebank::app {

/// Something wrong in a study's folder.
struct StudyProblem {
  std::filesystem::path file;
  std::string what;
  std::string redo;        ///< the trial that it costs, in words; empty: none
  bool removable = false;  ///< the file is broken or a leftover: without it the study goes on
};

struct StudyVerification {
  std::size_t whole = 0;  ///< trials whose archives are right
  std::vector<StudyProblem> problems;
};

/// Whether a path is a study's folder: it holds plan.h5 or trials/.
bool is_study_folder(const std::filesystem::path& path);

/// Checks plan.h5, study.h5 and every planned trial: that its archive is there, its whole-file hash, format and schema,
/// that it holds what a run leaves, and that its configuration and data are those of its name.
StudyVerification verify_study(const std::filesystem::path& folder);

/// Removes the files of removable problems, but for what a living process is writing. The next `modebank study` makes
/// them again.
void repair_study(const std::filesystem::path& folder, const StudyVerification& verification);

}  // namespace modebank::app
