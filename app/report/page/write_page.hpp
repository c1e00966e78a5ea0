#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "app/config/config.hpp"
#include "app/report/page/html_page.hpp"
#include "app/study/answers/study_table.hpp"
#include "io/archive/study_file.hpp"

namespace modebank::app::report {

/// Throws ConfigurationError if `path` cannot be written, or if the page is made from this file.
void check_page_path(const std::filesystem::path& path, const std::vector<std::filesystem::path>& sources);

/// Reports each written file as soon as it exists.
struct Written {
  std::function<void(const std::string& text)> say;
  std::vector<std::string> files;
};

/// Writes the page under a temporary name, renames the file and reports its size.
void write_page(const std::filesystem::path& path, const Page& page, Written& written);

/// A study and the folder of its archives.
struct FoundStudy {
  std::filesystem::path name;  ///< path as on the command line: the folder of the study, or its study.h5
  std::filesystem::path file;  ///< path of study.h5, which may not exist yet
  StudyFile content;
  std::size_t runs = 0, done = 0;
  bool whole = false;  ///< whether study.h5 contains all planned runs
};

/// The study in a folder, read from study.h5. If that file lacks finished runs, the study is read from its finished
/// runs, and their number is printed.
FoundStudy find_study(const std::filesystem::path& folder, Written& written);
/// The study of a study.h5 that is already open.
FoundStudy find_study(const OpenArchive& file);

/// The page of a study.
void report_study(const FoundStudy& study, const std::filesystem::path& page, const ReportConfig& options,
                  Written& written);

/// The page that compares two archives. It states which archive predicts better, and lists the
/// scores, the different settings, and the modes of both.
void report_comparison(const std::filesystem::path& file, const std::filesystem::path& other,
                       const std::filesystem::path& page, Written& written);

/// Whether an open file is the study.h5 of a study.
bool is_study(const OpenArchive& file);

}  // namespace modebank::app::report
