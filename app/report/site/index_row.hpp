#pragma once

#include <string>

#include "app/report/page/write_page.hpp"
#include "io/archive/bank/open_archive.hpp"

namespace modebank::app::report {

/// A row of the index of a folder.
struct IndexRow {
  std::string name;     ///< path of the archive or study in its folder
  std::string page;     ///< path of its page in the site; empty if it has none
  std::string data;     ///< name of the data file, or folder and number of files
  std::string text;     ///< the verdict, the number of finished runs of a study, or why there is no page
  std::string created;  ///< ISO 8601, UTC
};

/// Fill data, text and created. Of an archive only small parts are read.
void describe(const OpenArchive& archive, IndexRow& row);
void describe(const FoundStudy& study, IndexRow& row);

}  // namespace modebank::app::report
