#include "app/study/space/data_hashes.hpp"

#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <utility>

#include "app/config/option_table.hpp"
#include "app/study/run/child_process.hpp"
#include "io/import/import.hpp"

namespace modebank::app {
namespace {

using Described = std::map<std::pair<std::string, std::vector<std::string>>, InputFile>;  // by path and tables

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
  using nlohmann::json;
  const std::string answer = in_own_process([&] {
    Described described;
    json hashes = json::array(), files = json::array();
    for (const auto& [section, data] : sections_) hashes.push_back(hash_of(data, described));
    for (const auto& [use, file] : described) files.push_back(json::array({file.path, file.bytes, file.sha256}));
    std::string bytes;
    json::to_cbor(json{{"hashes", hashes}, {"files", files}}, bytes);  // names of files need not be UTF-8
    return bytes;
  });
  const json read = json::from_cbor(answer);
  std::size_t next = 0;
  for (const auto& [section, data] : sections_) hashes_[section] = read.at("hashes").at(next++).get<std::string>();
  for (const json& file : read.at("files"))
    files_.push_back({file.at(0).get<std::string>(), file.at(1).get<std::uint64_t>(), file.at(2).get<std::string>()});
}

}  // namespace modebank::app
