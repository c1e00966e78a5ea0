#include "app/report/page/compare_page.hpp"
#include "app/report/page/write_page.hpp"
#include "io/archive/archive.hpp"

namespace modebank::app::report {

void report_comparison(const std::filesystem::path& first, const std::filesystem::path& second,
                       const std::filesystem::path& page, const ReportConfig& options) {
  check_page_path(page, {first, second});
  const Archive a = read_archive(first), b = read_archive(second);
  // Names of their own where the files are called the same.
  const bool alike = first.filename() == second.filename();
  const auto name = [&](const std::filesystem::path& path) { return (alike ? path : path.filename()).string(); };
  write_page(page, compare_page({ComparedRun{a, name(first)}, ComparedRun{b, name(second)}}, options));
}

}  // namespace modebank::app::report
