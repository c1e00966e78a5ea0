#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace modebank::app {

/// A fault that was found in a study's folder.
struct StudyProblem {
  std::filesystem::path file;
  std::string what;
  std::string redo;        ///< description of the trial to run again; empty if no trial is affected
  bool removable = false;  ///< whether the file can be removed and made again, because it is broken or no longer needed
};

struct StudyVerification {
  std::size_t whole = 0;  ///< number of trials whose archives are right
  std::vector<StudyProblem> problems;
};

/// Whether a path is the folder of a study, which contains plan.h5 or trials/.
bool is_study_folder(const std::filesystem::path& path);

/// Checks plan.h5, study.h5 and the archive of every planned trial. The archive must exist, and its hash, format,
/// schema and parts must be right. Its configuration and data must be those of its name.
StudyVerification verify_study(const std::filesystem::path& folder);

/// Removes the files of removable problems, except files that a running process writes. The next `modebank study` makes
/// them again.
void repair_study(const std::filesystem::path& folder, const StudyVerification& verification);

}  // namespace modebank::app
