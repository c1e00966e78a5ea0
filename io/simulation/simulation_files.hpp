#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace modebank {

/// One CSV file: its name, its columns' names, and a row of values for each column.
struct SimulationTable {
  std::vector<std::string> names;
  Eigen::MatrixXd values;                            ///< columns x samples
  std::vector<std::vector<std::string>> texts = {};  ///< columns of text; they have the last names
};

/// The two files of a run.
struct SimulationTables {
  SimulationTable inputs;  ///< pro_NN.csv
  SimulationTable states;  ///< imu_NN.csv
};

/// Throws ConfigurationError if a column's name is empty or occurs twice.
void check_column_names(const std::vector<std::string>& names);

/// Whether a file name is that of a run's file: pro_*.csv or imu_*.csv.
bool is_run_file(const std::string& name);

/// Writes pro_NN.csv and imu_NN.csv for `runs` runs. Numbers have the shortest form that is read back exactly. Either
/// all files are written or none: they are completed in a temporary folder and then moved.
/// The folder is created if its parent exists. Throws ConfigurationError if the folder cannot be created. Also throws
/// it if the folder contains other pro_ or imu_ files, because `run` would read these as further runs.
void write_simulation_files(const std::filesystem::path& folder, std::size_t runs,
                            const std::function<SimulationTables(std::size_t)>& tables_of);

}  // namespace modebank
