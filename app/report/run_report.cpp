#include <fmt/format.h>

#include <filesystem>

#include "app/commands.hpp"
#include "app/config_file.hpp"
#include "app/report/run_page.hpp"
#include "ident/error.hpp"
#include "io/archive.hpp"
#include "io/replace_file.hpp"

namespace modebank::app {
namespace {

/// Where the page goes: -o, else the archive's name with .html in the current folder.
std::filesystem::path page_path(const CommandLine& line) {
  if (!line.output.empty()) return line.output;
  std::filesystem::path named = std::filesystem::path(line.files.front()).lexically_normal();
  if (!named.has_filename()) named = named.parent_path();
  return named.stem().string() + ".html";
}

void write_page(const std::filesystem::path& path, const report::Page& page) {
  constexpr double bytes_per_MB = 1e6;
  const std::string html = report::html_of(page);
  replace_file(path, {html});
  fmt::print("{}: {:.1f} MB; open it in a browser\n", path.string(), static_cast<double>(html.size()) / bytes_per_MB);
}

}  // namespace

int run_report(const CommandLine& line) {
  if (line.files.size() != 1)
    throw ConfigurationError("report needs one archive: modebank report ARCHIVE [-o page.html]");
  const Config config = stored_config("", line.overrides);
  const std::filesystem::path path = page_path(line), file = line.files.front();
  if (const std::string obstacle = write_obstacle(path); !obstacle.empty()) throw ConfigurationError("-o: " + obstacle);
  std::error_code none;
  if (std::filesystem::equivalent(path, file, none))
    throw ConfigurationError(fmt::format("-o: {} is the archive itself", path.string()));
  write_page(path, report::run_page(read_archive(file), file.filename().string(), config.report));
  return 0;
}

}  // namespace modebank::app
