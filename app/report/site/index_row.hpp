#pragma once

#include <nlohmann/json.hpp>

#include "app/report/page/write_page.hpp"
#include "io/archive/bank/open_archive.hpp"

namespace modebank::app::report {

/// The index's row for an archive, read only from small parts of the archive.
/// - kind: run or study
/// - created: UTC, ISO 8601
/// - data: name of the data file, or folder and number of files
/// - answer, text: the verdict as a word and as a sentence. Both are null without a verdict, like all members below.
///   The text of a study is the number of finished runs.
/// - modes, gain, standard_error [nats/sample]
/// - samples, log_score [nats/sample], coverage_95 of the bank on held-out runs
nlohmann::json index_row(const OpenArchive& archive);
nlohmann::json index_row(const FoundStudy& study);

}  // namespace modebank::app::report
