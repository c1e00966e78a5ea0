#pragma once

#include <nlohmann/json.hpp>

#include "app/report/page/write_page.hpp"
#include "io/archive/bank/open_archive.hpp"

namespace modebank::app::report {

/// The row of the index for an archive. Only small parts of the archive are read.
/// - kind: run or study
/// - created: UTC, ISO 8601
/// - data: name of the data file, or folder and number of files
/// - answer, text: the verdict as a word and as a sentence. For a study, `text` is the number of finished runs.
/// - modes, gain, standard_error [nats/sample]
/// - samples, log_score [nats/sample], coverage_95: of the bank on held-out runs
/// Without a verdict, `answer` and all later members are null.
nlohmann::json index_row(const OpenArchive& archive);
nlohmann::json index_row(const FoundStudy& study);

}  // namespace modebank::app::report
