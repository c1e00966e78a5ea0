#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace modebank::app {

/// A fault in a study's folder.
struct StudyProblem {
  std::filesystem::path file;
  std::string what;
  std::string redo;        ///< description of the trial to run again; empty: none
  bool removable = false;  ///< whether the file can be removed and made again, because it is broken or a leftover
};

struct StudyVerification {
  std::size_t whole = 0;  ///< number of trials whose archives are right
  std::vector<StudyProblem> problems;
};

/// Whether a path is a study's folder: it contains plan.h5 or trials/.
bool is_study_folder(const std::filesystem::path& path);

/// Checks plan.h5, study.h5 and every planned trial. Its archive must exist, with the right hash, format, schema and
/// parts of a run, and with the configuration and data of its name.
StudyVerification verify_study(const std::filesystem::path& folder);

/// Removes the files of removable problems, except files that a living process is writing. The next `modebank study`
/// makes them again.
void repair_study(const std::filesystem::path& folder, const StudyVerification& verification);

}  // namespace modebank::app
