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

/// Throws ConfigurationError if `path` cannot be written, or is one of the files from which the page is made.
void check_page_path(const std::filesystem::path& path, const std::vector<std::filesystem::path>& sources);

/// Reports written files, each as soon as it exists.
struct Written {
  std::function<void(const std::string& text)> say;
  std::vector<std::string> files;
};

/// Writes the page under a temporary name, renames it and reports its size.
void write_page(const std::filesystem::path& path, const Page& page, Written& written);

/// A study and the location of its archives.
struct FoundStudy {
  std::filesystem::path name;  ///< path as on the command line: the study's folder, or study.h5
  std::filesystem::path file;  ///< path of study.h5, which may not exist yet
  StudyFile content;
  std::size_t runs = 0, done = 0;
  std::string digest = {};  ///< content of study.h5; empty unless it contains all planned runs
};

/// The study in a folder, from study.h5. If the study still runs or was not merged since, from its finished runs; then
/// prints their number.
FoundStudy find_study(const std::filesystem::path& folder, Written& written);
/// The study of an open study.h5.
FoundStudy find_study(const OpenArchive& file);

/// The page of a study.
void report_study(const FoundStudy& study, const std::filesystem::path& page, const ReportConfig& options,
                  Written& written);

/// The page of two or more archives.
void report_comparison(const std::vector<std::filesystem::path>& files, const std::filesystem::path& page,
                       const ReportConfig& options, Written& written);

/// Whether an open file is a study's table.
bool is_study(const OpenArchive& file);

}  // namespace modebank::app::report
