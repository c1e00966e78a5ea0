#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace modebank::app::report {

/// The pages of one archive in a site, and what they were made from.
struct SitePages {
  std::string archive;             ///< SHA-256 of the archive's content; empty while the pages are being made
  std::string maker;               ///< text from site_maker
  std::vector<std::string> files;  ///< paths relative to the site; the first is the archive's own page
};

/// The pages of a site. The key is the archive's name relative to the folder. The record is the file pages.json beside
/// index.html. With it, `report` makes a page again only after a change, and removes only pages that `report` made.
using SiteRecord = std::map<std::string, SitePages>;

/// Reads the record; empty for a new site. Throws ConfigurationError if the path is a file, or a folder with other
/// files. Throws DataError if the record is unreadable.
SiteRecord read_site_record(const std::filesystem::path& site);
void write_site_record(const std::filesystem::path& site, const SiteRecord& record);

}  // namespace modebank::app::report
