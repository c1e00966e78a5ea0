#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "app/config/config.hpp"
#include "app/report/page/write_page.hpp"

namespace modebank::app::report {

/// Result of a run over a folder of archives.
struct SiteResult {
  std::size_t archives = 0;                                   ///< and studies, each one line of the index
  std::vector<std::pair<std::string, std::string>> problems;  ///< name of an archive, why it has no page
  std::vector<std::string> removed;                           ///< pages whose archive went, or has fewer
};

/// Whether a folder is that of one study, merged or not, rather than one of archives.
bool holds_a_study(const std::filesystem::path& folder);

/// The archives (*.h5) of `folder` and of those below it, by name relative to it; of a study's folder the study alone.
/// Hidden files are left out.
std::vector<std::filesystem::path> archives_below(const std::filesystem::path& folder);

/// Writes SITE/index.html, a line for each archive, and their pages below SITE/pages, those that changed since the last
/// time. A page is made again where its archive's content, modebank's revision, or a setting of [report] changed; one
/// whose archive went is removed. An archive that cannot be read is a line that says why. Each file is written under a
/// temporary name and renamed. Throws ConfigurationError where `folder` holds no archive, and as read_site_record does.
SiteResult report_folder(const std::filesystem::path& folder, const std::filesystem::path& site,
                         const ReportConfig& options, Written& written);

}  // namespace modebank::app::report
