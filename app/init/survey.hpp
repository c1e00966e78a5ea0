#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "ident/check/stream_check.hpp"
#include "io/import/options.hpp"

namespace modebank::app {

/// If this share of the values is repeated, the instrument is slower than the file's rows.
constexpr double most_repeated = 0.5;

/// Survey of one channel.
struct SurveyedChannel {
  std::string name, unit, type;
  ChannelCheck check = {};
  Eigen::VectorXd values = {};  ///< one per row, NaN where missing; empty for text
  std::string why_text = {};    ///< for a column of text that changes: the value that is not a number
  bool counts = false;          ///< rises in even steps, as times and counters do

  bool is_number() const { return values.size() > 0; }
  bool moves() const { return is_number() && check.largest > check.least; }
};

/// One table of a file, with times as data.time and data.run would read them.
struct SurveyedTable {
  std::string name, type;
  std::vector<SurveyedChannel> channels = {};
  std::vector<std::string> time = {};  ///< data.time; empty if none was found
  bool time_guessed = false;           ///< found by its values alone
  std::string time_problem = {};       ///< reason why a column with the name of a time is not one
  std::string run = {};                ///< column whose value separates runs; empty if none is needed
  Eigen::VectorXd time_s = {};         ///< times of the rows, from the first; the row's number without a time column
  std::int64_t origin_ns = 0;
  StampForm form = {};                       ///< format of the stamps
  std::vector<std::string> time_notes = {};  ///< remarks on reading them
  std::size_t unset_rows = 0;                ///< number of rows left out, stamped before the clock was set
  SamplingCheck sampling = {};               ///< sampling of one run

  const SurveyedChannel* find(const std::string& channel) const;
};

struct SurveyedFile {
  std::filesystem::path path;
  std::vector<SurveyedTable> tables;
  std::vector<std::string> notes;  ///< remarks of the file's reader
  std::size_t skipped = 0;         ///< number of title lines above the table of text
  bool skipped_alike = true;       ///< for several files: whether all have the same number
};

/// Reads all tables with numbers in a file. Throws as open_table and TableReader::read do, except for columns that are
/// not numbers: these become text.
SurveyedFile survey_file(const std::filesystem::path& path);

/// Names of all columns of a file, without reading the values. Files of one kind have equal columns.
std::vector<std::string> all_columns(const std::filesystem::path& path);

}  // namespace modebank::app
