#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace modebank {

/// One CSV file: its name, and a row of values per column.
struct SimulationTable {
  std::vector<std::string> names;
  Eigen::MatrixXd values;                            ///< columns x samples
  std::vector<std::vector<std::string>> texts = {};  ///< text columns, with the last of the names
};

/// The two files of a run.
struct SimulationTables {
  SimulationTable inputs;  ///< pro_NN.csv
  SimulationTable states;  ///< imu_NN.csv
};

/// Throws ConfigurationError if a column's name is empty or occurs twice.
void check_column_names(const std::vector<std::string>& names);

/// Whether a file name is one of a run: pro_*.csv or imu_*.csv.
bool is_run_file(const std::string& name);

/// Writes pro_NN.csv and imu_NN.csv of `runs` runs, with numbers in the shortest form that reads back exactly. Either
/// all files are written or none: they are complete in a folder beside the old files before they are moved. The folder
/// is created if its parent exists. Throws ConfigurationError if the folder cannot be created, or contains other pro_
/// or imu_ files, which `run` would read as further runs.
void write_simulation_files(const std::filesystem::path& folder, std::size_t runs,
                            const std::function<SimulationTables(std::size_t)>& tables_of);

}  // namespace modebank
