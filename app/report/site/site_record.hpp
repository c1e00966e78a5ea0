#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace modebank::app::report {

/// The pages of one archive in a site, and what they were made from.
struct SitePages {
  std::string archive;             ///< SHA-256 of the archive's content; empty: being made
  std::string maker;               ///< program and settings, see site_maker
  std::vector<std::string> files;  ///< relative to the site, the archive's own page first
};

/// The pages of a site, by the archive's name relative to its folder. The record stands in pages.json beside
/// index.html, so that a page is made again only where its archive, the program or a setting changed, and a page whose
/// archive went is removed only where `report` made it.
using SiteRecord = std::map<std::string, SitePages>;

/// Empty for a new site. Throws ConfigurationError if the path leads to a file or to a folder of other files, and
/// DataError where the record cannot be read.
SiteRecord read_site_record(const std::filesystem::path& site);
void write_site_record(const std::filesystem::path& site, const SiteRecord& record);

}  // namespace modebank::app::report
