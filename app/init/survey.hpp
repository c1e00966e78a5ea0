#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "ident/check/stream_check.hpp"
#include "io/import/options.hpp"

namespace modebank::app {

/// If more than this share of the values is repeated, the instrument is slower than the rows of the file.
constexpr double most_repeated = 0.5;

/// Survey of one channel.
struct SurveyedChannel {
  std::string name, unit, type;
  ChannelCheck check = {};
  Eigen::VectorXd values = {};  ///< one per row, NaN if missing; empty for a text column
  std::string why_text = {};    ///< for a text column that changes: the first value that is not a number
  bool counts = false;          ///< whether the values increase as clocks and counters do
  bool rests = false;           ///< whether the value is constant in every run, so that it explains nothing in one

  bool is_number() const { return values.size() > 0; }
  bool moves() const { return is_number() && check.largest > check.least && !rests; }
};

/// One table of a file, with its times as data.time and data.run would read them.
struct SurveyedTable {
  std::string name, type;
  std::vector<SurveyedChannel> channels = {};
  std::vector<std::string> time = {};  ///< value for data.time; empty if no times were found
  bool time_guessed = false;           ///< whether the times were found by their values alone
  std::string time_problem = {};       ///< reason why a column is not a time although its name is that of a time
  std::string run = {};                ///< column whose values separate runs; empty if none is needed
  Eigen::VectorXd time_s = {};         ///< time of each row since the first row; without a time column, the row's
                                       ///< number
  std::int64_t origin_ns = 0;
  StampForm form = {};                       ///< format of the stamps
  std::vector<std::string> time_notes = {};  ///< remarks of the reader on the stamps
  std::size_t unset_rows = 0;                ///< number of rows left out because their stamps precede the setting of
                                             ///< the clock
  SamplingCheck sampling = {};               ///< sampling of one run

  const SurveyedChannel* find(const std::string& channel) const;
};

struct SurveyedFile {
  std::filesystem::path path;
  std::vector<SurveyedTable> tables;
  std::vector<std::string> notes;  ///< remarks of the reader on the file
  std::size_t skipped = 0;         ///< number of title lines above the table in a text file
  bool skipped_alike = true;       ///< whether all files of a set have the same number of title lines
};

/// Reads all tables with numbers in a file. Columns that are not numbers become text. Throws the other exceptions of
/// open_table and TableReader::read.
SurveyedFile survey_file(const std::filesystem::path& path);

/// Names of all columns of a file. The values are not read. Files of one kind have equal columns.
std::vector<std::string> all_columns(const std::filesystem::path& path);

}  // namespace modebank::app
