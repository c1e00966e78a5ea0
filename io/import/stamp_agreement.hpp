#pragma once

#include <string>
#include <vector>

#include "io/import/import_plan.hpp"
#include "io/table/stamp_form.hpp"

namespace modebank {

/// The form of one file's stamps.
struct FileStamps {
  std::string file, column;
  std::size_t path = 0;  ///< position in FilePlan::paths: inputs, states
  StampForm form;
};

/// One form for all files that one pattern matches. Where some were read otherwise, sets it in the requests of `plans`
/// and returns true: they are to be read again. Throws DataError, showing both readings and the key that decides, where
/// the files' stamps contradict each other or allow several readings.
bool agree_on_stamps(const std::vector<FileStamps>& forms, std::vector<FilePlan>& plans);

}  // namespace modebank
