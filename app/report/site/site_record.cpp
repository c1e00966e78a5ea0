#include "app/report/site/site_record.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "io/files/read_file.hpp"
#include "io/files/replace_file.hpp"
#include "modebank/base/error.hpp"

namespace modebank::app::report {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

const char* const record_name = "pages.json";

/// All pages are in pages/. Without this check, `report` could remove other files if a user has edited the record.
bool is_below_pages(const std::string& file) {
  const fs::path path = file;
  return !path.empty() && *path.begin() == "pages" && std::find(path.begin(), path.end(), "..") == path.end();
}

SitePages pages_in(const json& entry) {
  SitePages pages{entry.at("archive"), entry.at("maker"), entry.at("files")};
  if (!std::all_of(pages.files.begin(), pages.files.end(), is_below_pages))
    throw DataError("it names a file outside of pages/");
  return pages;
}

}  // namespace

SiteRecord read_site_record(const fs::path& site) {
  const fs::path file = site / record_name;
  if (!fs::exists(site)) return {};
  if (!fs::is_directory(site)) throw ConfigurationError(fmt::format("-o {}: this is not a folder", site.string()));
  if (!fs::exists(file)) {
    if (fs::is_empty(site)) return {};
    throw ConfigurationError(
        fmt::format("-o {}: the folder has files that report did not write; name a new folder", site.string()));
  }
  try {
    const json stored = json::parse(read_file(file));
    SiteRecord record;
    for (const auto& [name, entry] : stored.at("pages").items()) record[name] = pages_in(entry);
    return record;
  } catch (const std::exception& error) {
    throw DataError(fmt::format("{}: {}; remove the folder, or name another", file.string(), error.what()));
  }
}

void write_site_record(const fs::path& site, const SiteRecord& record) {
  json pages = json::object();
  for (const auto& [name, made] : record)
    pages[name] = {{"archive", made.archive}, {"maker", made.maker}, {"files", made.files}};
  constexpr int indent = 1;
  replace_file(site / record_name,
               {json({{"pages", pages}}).dump(indent, ' ', false, json::error_handler_t::replace) + "\n"});
}

}  // namespace modebank::app::report
