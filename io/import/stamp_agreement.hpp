#pragma once

#include <string>
#include <vector>

#include "io/import/import_plan.hpp"
#include "io/table/stamp_form.hpp"

namespace modebank {

/// The stamp format of one file.
struct FileStamps {
  std::string file, column;
  std::size_t path = 0;  ///< index in FilePlan::paths (inputs, states)
  StampForm form;
};

/// Finds one stamp format for all files of one pattern. If some files were read in another format, sets the format in
/// the requests of `plans` and returns true. These files must then be read again. Throws DataError if files contradict
/// each other or several readings remain. The message contains both readings and the deciding key.
bool agree_on_stamps(const std::vector<FileStamps>& forms, std::vector<FilePlan>& plans);

}  // namespace modebank
