#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "app/config/config.hpp"
#include "app/report/page/html_page.hpp"
#include "app/study/run/live_page.hpp"

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

/// The page of a study. `file`: its study.h5, which `study` or this file in its folder names.
void report_study(const std::filesystem::path& study, const OpenArchive& file, const std::filesystem::path& page,
                  const ReportConfig& options, Written& written);
/// Writes study.html into a study's folder, by renaming, and says where it is when the study has ended; see
/// StudyPageWriter.
void write_running_study(const std::filesystem::path& folder, const StudyFile& file, const StudyTable& table,
                         const StudyState& state, Written& written);

/// The page of two or more archives.
void report_comparison(const std::vector<std::filesystem::path>& files, const std::filesystem::path& page,
                       const ReportConfig& options, Written& written);

/// The file that a name of the command line stands for: study.h5 of a folder.
std::filesystem::path study_file(const std::filesystem::path& study);
/// Whether an open file is a study's table.
bool is_study(const OpenArchive& file);

}  // namespace modebank::app::report
