#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "io/archive/archive.hpp"

namespace modebank {

/// One column of a table whose columns are known only at run time.
struct NamedColumn {
  using Values = std::variant<std::vector<double>, std::vector<std::int64_t>, std::vector<std::uint64_t>,
                              std::vector<std::string>>;
  std::string name;
  Values values;
};

struct NamedTable {
  std::string name;
  std::vector<NamedColumn> columns;
};

/// A table of runs in a file. The file's root is like an archive's: the study's resolved /config, /provenance with the
/// inputs, and the hash in the user block. The file has one compound dataset and the tables of answers.
struct StudyFile {
  Provenance provenance;
  std::string config;
  std::string table;  ///< name of the dataset
  std::vector<NamedColumn> columns;
  std::vector<std::pair<std::string, std::filesystem::path>> archives;  ///< stored as /trials/<name>
  std::vector<NamedTable> answers;  ///< computed from the table and stored as /answers/<name>
};

/// Writes the file under a temporary name, hashes it and renames it, like write_archive. /trials/<name> are external
/// links, relative to the file's folder.
void write_study_file(const std::filesystem::path& path, const StudyFile& study);

/// Reads everything except the archives. Throws the same exceptions as read_archive, and DataError if the table does
/// not exist.
StudyFile read_study_file(const OpenArchive& file, const std::string& table);

/// The parts of a trial's archive that a study's table contains.
struct TrialScores {
  std::string modebank_version, config_hash, data_hash;
  std::int64_t modes = 0;  ///< number of the bank's modes
  std::string evidence;    ///< the finding's answer; empty if the archive has no finding
  std::vector<std::pair<std::string, double>>
      pooled;  ///< <filter>_<role>_<score> and <filter>_<role>_rmse_<state>, from the summary's rows for run "*"
};

/// Reads only these parts. Throws the same exceptions as read_archive.
TrialScores read_trial_scores(const OpenArchive& archive);

/// The names and values of pooled scores, from a summary in memory.
std::vector<std::pair<std::string, double>> pooled_scores(const std::vector<SummaryRow>& summary,
                                                          const std::vector<std::string>& state_names);

}  // namespace modebank
