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

/// Throws ConfigurationError when the page cannot be written to `path`, or `path` is one of the files it is made from.
void check_page_path(const std::filesystem::path& path, const std::vector<std::filesystem::path>& sources);

/// What was written, said as soon as it is there.
struct Written {
  std::function<void(const std::string& text)> say;
  std::vector<std::string> files;
};

/// Writes the page under a temporary name and renames it; says how large it is.
void write_page(const std::filesystem::path& path, const Page& page, Written& written);

/// A study, and where its archives lie.
struct FoundStudy {
  std::filesystem::path name;  ///< as the command line has it: its folder, or study.h5
  std::filesystem::path file;  ///< study.h5, which need not be there
  StudyFile content;
  std::size_t runs = 0, done = 0;
  std::string digest = {};  ///< of study.h5; empty where it does not hold every run of the plan
};

/// The study of a folder: what study.h5 holds, or, where the study still runs or was not merged since, the runs that
/// are done; then their number is printed.
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
