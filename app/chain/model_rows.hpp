#pragma once

#include <algorithm>
#include <iterator>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "filter/judge/finding.hpp"
#include "io/archive/archive.hpp"

/// Functions on the rows that an archive's evaluation has for each model.
namespace modebank {

/// Order of models in an archive's rows: the global model, the bank, then the competitors in their own order.
inline std::size_t model_rank(const std::string& model) {
  if (model == "global") return 0;
  if (model == "bank") return 1;
  return 2 + static_cast<std::size_t>(std::find(competitor_names.begin(), competitor_names.end(), model) -
                                      competitor_names.begin());
}

template <class Row>
const std::string& model_of(const Row& row) {
  if constexpr (std::is_same_v<Row, ResidualTestSet>)
    return row.model;
  else
    return row.filter;
}

/// Replaces all rows of one model.
template <class Row>
void put_rows(const std::string& model, std::vector<Row> rows, std::vector<Row>& all) {
  std::erase_if(all, [&](const Row& row) { return model_of(row) == model; });
  all.insert(all.end(), std::make_move_iterator(rows.begin()), std::make_move_iterator(rows.end()));
  std::stable_sort(all.begin(), all.end(),
                   [](const Row& a, const Row& b) { return model_rank(model_of(a)) < model_rank(model_of(b)); });
}

/// Removes the rows of these models.
template <class Row>
std::vector<Row> rows_out_of(std::vector<Row>& all, const std::vector<std::string>& models) {
  const auto others = std::stable_partition(all.begin(), all.end(), [&](const Row& row) {
    return std::find(models.begin(), models.end(), model_of(row)) == models.end();
  });
  std::vector<Row> rows(std::make_move_iterator(others), std::make_move_iterator(all.end()));
  all.erase(others, all.end());
  return rows;
}

/// Moves all results on these models, and the recording, into a new archive. An archive of scores contains both.
inline Archive scores_out_of(Archive& archive, const std::vector<std::string>& models) {
  Archive part;
  part.recording = std::exchange(archive.recording, {});
  part.evaluations = rows_out_of(archive.evaluations, models);
  part.summary = rows_out_of(archive.summary, models);
  part.free_runs = rows_out_of(archive.free_runs, models);
  part.diagnostics = rows_out_of(archive.diagnostics, models);
  part.residual_tests = rows_out_of(archive.residual_tests, models);
  return part;
}

/// If a part is stored together with the recording, moves the recording back. A part from a file has its own recording
/// with the same data.
inline void put_back_recording(Archive& part, Archive& archive) {
  if (!archive.recording) archive.recording = std::move(part.recording);
}

}  // namespace modebank
