#include "app/study/space/data_hashes.hpp"

#include <filesystem>
#include <utility>

#include "app/config/option_table.hpp"
#include "io/import/import.hpp"

namespace modebank::app {
namespace {

using Described =
    std::map<std::pair<std::string, std::vector<std::string>>, InputFile>;  // key: path and tables of a file

std::string hash_of(const DataOptions& data, Described& described) {
  std::vector<InputFile> files;
  for (const DataFile& file : data_files(data)) {
    auto [known, fresh] = described.try_emplace({std::filesystem::absolute(file.path).string(), file.tables});
    if (fresh) known->second = file.describe();
    files.push_back(known->second);
  }
  return data_hash(files);
}

}  // namespace

std::string DataHashes::section_of(const Config& config) {
  std::string section;
  for (const Option& option : option_table())
    if (option.section() == "data") section += "\n" + option.get(config);
  return section;
}

void DataHashes::read() {
  Described described;
  for (const auto& [section, data] : sections_) hashes_[section] = hash_of(data, described);
  for (const auto& [use, file] : described) files_.push_back(file);
}

}  // namespace modebank::app
