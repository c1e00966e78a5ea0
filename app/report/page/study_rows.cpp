#include <fmt/format.h>

#include "app/report/page/study_page.hpp"
#include "io/files/sha256.hpp"
#include "modebank/base/error.hpp"
#include "modebank/base/names.hpp"

namespace modebank::app::report {
namespace {

/// A column of the study file. The columns between the varied keys and the scores are those that `merge` writes.
const NamedColumn& column(const StudyFile& file, const std::string& name) {
  for (const NamedColumn& candidate : file.columns)
    if (candidate.name == name) return candidate;
  throw DataError(fmt::format("the table of runs has no column {}, so it is not a study's", name));
}

template <class T>
const std::vector<T>& values(const NamedColumn& column) {
  if (const auto* found = std::get_if<std::vector<T>>(&column.values)) return *found;
  throw DataError(fmt::format("column {} of the table of runs has another type than a study's", column.name));
}

/// Numbers with all their digits.
std::vector<std::string> texts_of(const NamedColumn& column) {
  return std::visit(
      [](const auto& list) {
        std::vector<std::string> texts;
        for (const auto& value : list) texts.push_back(fmt::format("{}", value));
        return texts;
      },
      column.values);
}

}  // namespace

StudyTable study_table_of(const StudyFile& file) {
  StudyTable table;
  const auto& keys = values<std::string>(column(file, "key"));
  const auto& statuses = values<std::string>(column(file, "status"));
  const auto& messages = values<std::string>(column(file, "message"));
  const auto& evidence = values<std::string>(column(file, "evidence"));
  const auto& repeats = values<std::int64_t>(column(file, "repeat"));
  const auto& seeds = values<std::uint64_t>(column(file, "seed"));
  table.rows.resize(keys.size());
  for (std::size_t i = 0; i < keys.size(); ++i) {
    TrialRow& row = table.rows[i];
    row.key = keys[i];
    row.repeat = repeats[i];
    row.seed = seeds[i];
    row.message = messages[i];
    row.evidence = evidence[i];
    const auto status = parse_name<TrialStatus>(statuses[i]);
    if (!keys[i].empty() && !is_sha256(keys[i]))
      throw DataError(fmt::format("run {} has the key {}, which is not 64 hexadecimal digits", i, keys[i]));
    if (!status) throw DataError(fmt::format("run {} has the unknown status {}", i, statuses[i]));
    row.status = *status;
  }
  bool varied = true;  // true for the columns before "repeat"
  for (const NamedColumn& candidate : file.columns) {
    varied = varied && candidate.name != "repeat";
    if (varied) {
      table.varied_keys.push_back(candidate.name);
      const std::vector<std::string> texts = texts_of(candidate);
      for (std::size_t i = 0; i < texts.size(); ++i) table.rows[i].varied.push_back(texts[i]);
    } else if (const auto* scores = std::get_if<std::vector<double>>(&candidate.values)) {
      table.score_names.push_back(candidate.name);
      for (std::size_t i = 0; i < scores->size(); ++i) table.rows[i].scores.push_back((*scores)[i]);
    }
  }
  return table;
}

}  // namespace modebank::app::report
