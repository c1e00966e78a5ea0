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

/// A table of runs in a file with the root of an archive: the study's resolved /config, /provenance with the inputs,
/// and the hash in the user block. The file has one compound dataset and the tables of answers.
struct StudyFile {
  Provenance provenance;
  std::string config;
  std::string table;  ///< name of the dataset
  std::vector<NamedColumn> columns;
  std::vector<std::pair<std::string, std::filesystem::path>> archives;  ///< stored as /trials/<name>
  std::vector<NamedTable> answers;  ///< computed from the table; stored as /answers/<name>
};

/// Whether /trials/<name> are external links, relative to the file's folder, or copies of the archives' content.
enum class ArchiveUse { link, copy };

/// Writes under a temporary name, hashes and renames, as write_archive does.
void write_study_file(const std::filesystem::path& path, const StudyFile& study, ArchiveUse use = ArchiveUse::link);

/// Reads everything except the archives. Throws as read_archive does, and DataError if the table does not exist.
StudyFile read_study_file(const OpenArchive& file, const std::string& table);

/// The parts of a trial's archive that a study's table contains.
struct TrialScores {
  std::string modebank_version, config_hash, data_hash;
  std::int64_t modes = 0;  ///< number of the bank's modes
  std::string evidence;    ///< the finding's answer; empty without a finding
  std::vector<std::pair<std::string, double>>
      pooled;  ///< <filter>_<role>_<score>, ..._rmse_<state>: the summary's rows for run "*"
};

/// Reads only these parts. Throws as read_archive does.
TrialScores read_trial_scores(const OpenArchive& archive);

/// The names and values of pooled scores, from a summary in memory.
std::vector<std::pair<std::string, double>> pooled_scores(const std::vector<SummaryRow>& summary,
                                                          const std::vector<std::string>& state_names);

}  // namespace modebank
