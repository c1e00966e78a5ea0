#pragma once

#include <nlohmann/json.hpp>

#include "app/report/page/write_page.hpp"
#include "io/archive/bank/open_archive.hpp"

namespace modebank::app::report {

/// One archive in a line of the index, read from its small parts alone:
///   kind           run or study
///   created        UTC, ISO 8601
///   data           name of the file that was read, or of the folder and the number of files
///   answer, text   the verdict in a word and in its sentence; null without one, as all below. Of a study the text
///                  states how many of its runs are done
///   modes, gain, standard_error [nats/sample]
///   samples, log_score [nats/sample], coverage_95   of the bank on held-out runs
nlohmann::json index_row(const OpenArchive& archive);
nlohmann::json index_row(const FoundStudy& study);

}  // namespace modebank::app::report
