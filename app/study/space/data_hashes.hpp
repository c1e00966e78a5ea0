#pragma once

#include <map>
#include <string>
#include <vector>

#include "app/config/config.hpp"
#include "io/files/input_file.hpp"

namespace modebank::app {

/// Tells apart the data of trials, read once for all trials that read the same.
class DataHashes {
 public:
  /// Adds the files that such a [data] section reads.
  void add(const Config& config) { sections_.try_emplace(section_of(config), config.data); }
  /// Reads all that was added. Throws as data_files does (io/import/import.hpp), and as readers do.
  void read();

  /// The hash of the files that such a [data] section reads.
  const std::string& of(const Config& config) const { return hashes_.at(section_of(config)); }
  const std::vector<InputFile>& files() const { return files_; }

 private:
  std::map<std::string, DataOptions> sections_;
  std::map<std::string, std::string> hashes_;  ///< by section
  std::vector<InputFile> files_;               ///< by path and tables

  static std::string section_of(const Config& config);
};

}  // namespace modebank::app
