#pragma once

#include <algorithm>
#include <iterator>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "filter/judge/decide/finding.hpp"
#include "io/archive/archive.hpp"

/// An archive's rows on evaluation, model by model.
namespace modebank {

/// The order of models in the rows of an archive: the global model, the bank, its competitors in theirs.
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

/// Replaces the rows of a model.
template <class Row>
void put_rows(const std::string& model, std::vector<Row> rows, std::vector<Row>& all) {
  std::erase_if(all, [&](const Row& row) { return model_of(row) == model; });
  all.insert(all.end(), std::make_move_iterator(rows.begin()), std::make_move_iterator(rows.end()));
  std::stable_sort(all.begin(), all.end(),
                   [](const Row& a, const Row& b) { return model_rank(model_of(a)) < model_rank(model_of(b)); });
}

template <class Row>
std::vector<Row> rows_of(const std::vector<std::string>& models, const std::vector<Row>& all) {
  std::vector<Row> rows;
  rows.reserve(all.size());  // growing copies evaluations once more
  for (const Row& row : all)
    if (std::find(models.begin(), models.end(), model_of(row)) != models.end()) rows.push_back(row);
  return rows;
}

/// Everything that was found out about these models.
inline Archive scores_of(const std::vector<std::string>& models, const Archive& archive) {
  Archive part;
  part.recording = archive.recording;
  part.evaluations = rows_of(models, archive.evaluations);
  part.summary = rows_of(models, archive.summary);
  part.free_runs = rows_of(models, archive.free_runs);
  part.diagnostics = rows_of(models, archive.diagnostics);
  part.residual_tests = rows_of(models, archive.residual_tests);
  return part;
}

}  // namespace modebank
