#pragma once

#include <map>
#include <string>
#include <vector>

#include "app/config/config.hpp"
#include "io/files/input_file.hpp"

namespace modebank::app {

/// Hashes of the trials' data. Files that several trials use are read once.
class DataHashes {
 public:
  /// Adds the files of this [data] section.
  void add(const Config& config) { sections_.try_emplace(section_of(config), config.data); }
  /// Reads all added files. Throws as data_files does (io/import/import.hpp), and as readers do.
  void read();

  /// The hash of the files of this [data] section.
  const std::string& of(const Config& config) const { return hashes_.at(section_of(config)); }
  const std::vector<InputFile>& files() const { return files_; }

 private:
  std::map<std::string, DataOptions> sections_;
  std::map<std::string, std::string> hashes_;  ///< hashes by section
  std::vector<InputFile> files_;               ///< files by path and tables

  static std::string section_of(const Config& config);
};

}  // namespace modebank::app
