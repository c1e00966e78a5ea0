#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "ident/data/run_labels.hpp"
#include "ident/data/streams.hpp"
#include "ident/data/trajectory.hpp"
#include "ident/lag/report.hpp"
#include "io/files/input_file.hpp"
#include "io/import/memory_tables.hpp"
#include "io/import/options.hpp"
#include "io/import/run_streams.hpp"

namespace modebank {

struct ImportedData {
  Recording recording;              ///< runs sorted by name (byte order), roles set
  std::vector<InputFile> files;     ///< in run order, inputs before states
  std::vector<std::string> notes;   ///< what the user should know of the data
  std::optional<RunLabels> labels;  ///< with DataOptions::label
  std::optional<LagReport> lag;     ///< with DataOptions::lag_auto: what was found and applied
  double step_scatter = 0.0;        ///< LogSampling::step_scatter
  std::string data_hash;            ///< of files, see io/files/input_file.hpp
};

/// Finds, checks and reads all runs. Throws ConfigurationError for what can be seen before any sample is read (pattern
/// without a match, a run without its states file, empty file, missing column: lists those that exist, unknown run
/// name) and DataError, naming file and line, for content (text in a number, NaN, time not increasing, too few samples,
/// streams that do not overlap, row counts that differ under Join::row).
/// With `memory` the runs are those tables: data.root, data.inputs and data.states do not count. `learned`: as in
/// choose_sampling (io/import/sampling.hpp), for data that a bank of other data is to read.
ImportedData import_data(const DataOptions& options, const MemoryTables* memory = nullptr,
                         const AveragedColumns* learned = nullptr);

/// All runs' streams as they stand in the files, for advice on them: nothing is sorted, missing values are NaN (missing
/// times too), roles are set, runs are sorted by name. Throws as import_data does, but for what data.missing and
/// data.disorder treat.
std::vector<RunStreams> read_streams(const DataOptions& options);

/// A file that import_data would read.
struct DataFile {
  std::filesystem::path path;
  std::vector<std::string> tables = {};      ///< those that are read, sorted: what identifies it depends on them
  std::function<InputFile()> describe = {};  ///< as ImportedData::files has it; throws when it cannot be read
};

/// All of them, in the order of ImportedData::files. Throws ConfigurationError as import_data does.
std::vector<DataFile> data_files(const DataOptions& options);

}  // namespace modebank
