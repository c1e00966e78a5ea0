#include <set>

#include "app/report/page/compare_page.hpp"
#include "app/report/page/write_page.hpp"
#include "io/archive/archive.hpp"

namespace modebank::app::report {

void report_comparison(const std::vector<std::filesystem::path>& files, const std::filesystem::path& page,
                       const ReportConfig& options, Written& written) {
  check_page_path(page, files);
  std::vector<Archive> archives;
  std::set<std::filesystem::path> names;
  for (const std::filesystem::path& file : files) {
    archives.push_back(read_archive(file, Evaluations::in_file));
    names.insert(file.filename());
  }
  std::vector<ComparedRun> runs;
  // Names of the archives. If two file names are equal, the names are whole paths.
  for (std::size_t i = 0; i < files.size(); ++i)
    runs.push_back({archives[i], (names.size() < files.size() ? files[i] : files[i].filename()).string()});
  write_page(page, compare_page(runs, options), written);
}

}  // namespace modebank::app::report
