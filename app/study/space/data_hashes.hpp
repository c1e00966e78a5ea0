#pragma once

#include <map>
#include <string>
#include <vector>

#include "app/config/config.hpp"
#include "io/files/input_file.hpp"

namespace modebank::app {

/// Hashes of the data of all trials. A file that several trials use is read only once.
class DataHashes {
 public:
  /// Adds the files of this [data] section.
  void add(const Config& config) { sections_.try_emplace(section_of(config), config.data); }
  /// Reads all added files. Throws the exceptions of data_files (io/import/import.hpp) and of the readers.
  void read();

  /// The hash of the files of this [data] section.
  const std::string& of(const Config& config) const { return hashes_.at(section_of(config)); }
  const std::vector<InputFile>& files() const { return files_; }

 private:
  std::map<std::string, DataOptions> sections_;
  std::map<std::string, std::string> hashes_;  ///< hash for each [data] section
  std::vector<InputFile> files_;               ///< one entry for each path and list of tables

  static std::string section_of(const Config& config);
};

}  // namespace modebank::app
