#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "ident/check/stream_check.hpp"
#include "io/import/options.hpp"

namespace modebank::app {

/// Repeated values of so many samples mean that an instrument is slower than the file's rows.
constexpr double most_repeated = 0.5;

/// One channel of a file, looked at.
struct SurveyedChannel {
  std::string name, unit, type;
  ChannelCheck check = {};
  Eigen::VectorXd values = {};  ///< one per row, NaN where missing; empty for text
  std::string why_text = {};    ///< of a column of text that changes: the value that is not a number
  bool counts = false;          ///< rises in steps as even as those of times and counters

  bool is_number() const { return values.size() > 0; }
  bool moves() const { return is_number() && check.largest > check.least; }
};

/// One table of a file with its times, as data.time and data.run would take them.
struct SurveyedTable {
  std::string name, type;
  std::vector<SurveyedChannel> channels = {};
  std::vector<std::string> time = {};  ///< data.time; empty: none was found
  bool time_guessed = false;           ///< by its values alone
  std::string time_problem = {};       ///< why what is called a time is none
  std::string run = {};                ///< a column whose value separates runs; empty: none is needed
  Eigen::VectorXd time_s = {};         ///< of the rows, from their first; the row's number where there is no time
  std::int64_t origin_ns = 0;
  StampForm form = {};                       ///< of the stamps
  std::vector<std::string> time_notes = {};  ///< what their reader says of them
  std::size_t unset_rows = 0;                ///< left out: stamped before the clock was set
  SamplingCheck sampling = {};               ///< of one run

  const SurveyedChannel* find(const std::string& channel) const;
};

struct SurveyedFile {
  std::filesystem::path path;
  std::vector<SurveyedTable> tables;
  std::vector<std::string> notes;  ///< what its reader found out
  std::size_t skipped = 0;         ///< lines of a title above the table of text
  bool skipped_alike = true;       ///< of several files: whether all have as many
};

/// Reads all tables of a file that hold numbers. Throws as open_table and TableReader::read do, but for columns that
/// are no numbers, which are text then.
SurveyedFile survey_file(const std::filesystem::path& path);

/// All columns of a file by name, without reading it: files of one kind have the same.
std::vector<std::string> all_columns(const std::filesystem::path& path);

}  // namespace modebank::app
