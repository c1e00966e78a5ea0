#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "app/config/config.hpp"
#include "app/report/page/write_page.hpp"

namespace modebank::app::report {

/// Result of `report` for a folder of archives.
struct SiteResult {
  std::size_t archives = 0;  ///< number of archives and studies; each has one row in the index
  std::vector<std::pair<std::string, std::string>> problems;  ///< name of an archive, and the reason why it has no page
};

/// Whether a folder contains a single study, merged or not, instead of archives.
bool holds_a_study(const std::filesystem::path& folder);

/// The archives (*.h5) in `folder` and its subfolders, with names relative to `folder`. A study's folder counts as one
/// study. Hidden files are ignored.
std::vector<std::filesystem::path> archives_below(const std::filesystem::path& folder);

/// Writes SITE/index.html, a table of links with a row for each archive, and the pages in SITE/pages.
/// - A page is kept while it has the time of its archive. Pages of archives that are gone stay, without a link.
/// - The row of an unreadable archive states the reason.
/// - Each file is written under a temporary name and then renamed.
///
/// Throws ConfigurationError if `folder` has no archive, or if `site` has files but no index of `report`.
SiteResult report_folder(const std::filesystem::path& folder, const std::filesystem::path& site,
                         const ReportConfig& options, Written& written);

}  // namespace modebank::app::report
