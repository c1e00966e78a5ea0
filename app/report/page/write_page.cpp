#include "app/report/page/write_page.hpp"

#include <fmt/format.h>

#include "io/files/output_file.hpp"
#include "io/files/replace_file.hpp"

namespace modebank::app::report {

void check_page_path(const std::filesystem::path& path, const std::vector<std::filesystem::path>& sources) {
  constexpr std::size_t front_bytes = 100;
  check_output({"-o", path, form_by_front("a page", "<!DOCTYPE html>", front_bytes)}, sources);
}

void write_page(const std::filesystem::path& path, const Page& page, Written& written) {
  constexpr double bytes_per_MB = 1e6;
  const std::string html = html_of(page);
  replace_file(path, {html});
  written.files.push_back(path.string());
  const double size_MB = static_cast<double>(html.size()) / bytes_per_MB;
  written.say(fmt::format("{}: {}; open it in a browser\n", path.string(),
                          size_MB < 0.1 ? fmt::format("{:.0f} kB", 1e3 * size_MB) : fmt::format("{:.1f} MB", size_MB)));
}

}  // namespace modebank::app::report
