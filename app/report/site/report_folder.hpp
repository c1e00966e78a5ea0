#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "app/config/config.hpp"
#include "app/report/page/write_page.hpp"

namespace modebank::app::report {

/// Result of a run over a folder of archives.
struct SiteResult {
  std::size_t archives = 0;  ///< archives and studies, one row of the index each
  std::vector<std::pair<std::string, std::string>>
      problems;                      ///< name of an archive, and the reason of its missing page
  std::vector<std::string> removed;  ///< number of removed pages: the archive is gone, or has fewer pages now
};

/// Whether a folder contains a single study, merged or not, and not archives.
bool holds_a_study(const std::filesystem::path& folder);

/// The archives (*.h5) in `folder` and the folders below it, with names relative to it. A study's folder counts as one
/// study. Hidden files are ignored.
std::vector<std::filesystem::path> archives_below(const std::filesystem::path& folder);

/// Writes SITE/index.html, with a row for each archive, and pages below SITE/pages.
/// - A page is made again only after a change of its archive's content, of modebank's revision or of a setting of
///   [report].
/// - A page without its archive is removed.
/// - The row of an unreadable archive states the reason.
/// - Each file is written under a temporary name and then renamed.
///
/// Throws ConfigurationError if `folder` has no archive, and as read_site_record does.
SiteResult report_folder(const std::filesystem::path& folder, const std::filesystem::path& site,
                         const ReportConfig& options, Written& written);

}  // namespace modebank::app::report
