#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace modebank::app::report {

/// The pages of one archive in a site, and their origin.
struct SitePages {
  std::string archive;             ///< SHA-256 of the archive's content; empty while pages are being made
  std::string maker;               ///< program and settings, from site_maker
  std::vector<std::string> files;  ///< paths relative to the site; the archive's own page first
};

/// The pages of a site, by the archive's name relative to its folder. The record is pages.json beside index.html. It
/// has two purposes: `report` makes a page again only after a change of archive, program or setting, and removes only
/// pages that `report` made.
using SiteRecord = std::map<std::string, SitePages>;

/// Reads the record; empty for a new site. Throws ConfigurationError if the path is a file or a folder with other
/// files, and DataError if the record is unreadable.
SiteRecord read_site_record(const std::filesystem::path& site);
void write_site_record(const std::filesystem::path& site, const SiteRecord& record);

}  // namespace modebank::app::report
