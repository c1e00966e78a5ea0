#include "ident/terms/find_terms.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <utility>

#include "ident/terms/dictionary.hpp"
#include "ident/terms/selection.hpp"
#include "ident/terms/term_rows.hpp"

namespace modebank {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index most_entries = 6'000'000;    // largest number of entries in all candidate columns
constexpr Index fewest_rows_per_column = 5;  // least number of rows per column of the linear model, in each fold of a
                                             // half

std::vector<LinearStructure> structures_of(const LinearStructure& widest) {
  std::vector<LinearStructure> all;
  for (const Index lags : {Index{1}, Index{2}, std::max(widest.state_lags, widest.input_lags)}) {
    LinearStructure s = widest;
    s.state_lags = std::min(lags, widest.state_lags);
    s.input_lags = std::min(lags, widest.input_lags);
    if (std::find(all.begin(), all.end(), s) == all.end()) all.push_back(s);
  }
  return all;
}

Index columns_of(const SelectedTerms& selected) { return selected.structure.regressors() + selected.terms.count(); }

/// The smallest number of columns whose loss relative to the best number is within one standard error.
std::size_t chosen_of(const std::vector<SelectedTerms>& all, const TermRows& rows) {
  const auto best = std::max_element(all.begin(), all.end(), [](const SelectedTerms& a, const SelectedTerms& b) {
    return a.log_score() < b.log_score();
  });
  std::size_t chosen = static_cast<std::size_t>(best - all.begin());
  for (std::size_t i = 0; i < all.size(); ++i) {
    const PartGain loss = gain_over_parts(best->left_out - all[i].left_out, rows);
    if (loss.mean <= loss.standard_error && columns_of(all[i]) < columns_of(all[chosen])) chosen = i;
  }
  return chosen;
}

VectorXd densities_of(const TermRows& on, const LinearStructure& structure, const MotionTerms& terms,
                      const MatrixXd& coefficients) {
  return student_densities(on.Y - design_of(on, structure, terms) * coefficients);
}

/// Gain of this structure's terms over the linear model on each half of the runs. The terms are chosen and fitted on
/// the other half.
PartGain measured_gain(const TermRows& rows, const LinearStructure& structure, const FitOptions& options) {
  std::array<VectorXd, 2> gained;
  std::array<std::vector<bool>, 2> half;
  for (Index p = 0; p < rows.parts; ++p)
    for (std::size_t h = 0; h < 2; ++h) half[h].push_back(static_cast<std::size_t>(p % 2) == h);
  tbb::parallel_for(std::size_t{0}, std::size_t{2}, [&](std::size_t h) {
    const TermRows of = rows.some(half[1 - h]), on = rows.some(half[h]);
    const SelectedTerms bent = select_terms(of, structure, options);
    gained[h] = densities_of(on, structure, bent.terms, fit_terms(of, structure, bent.terms, options)) -
                densities_of(on, rows.widest, {}, fit_terms(of, rows.widest, {}, options));
  });
  VectorXd difference(rows.count());
  std::array<Index, 2> next{0, 0};
  for (Index k = 0; k < rows.count(); ++k) {
    const auto h = static_cast<std::size_t>(rows.part[static_cast<std::size_t>(k)] % 2);
    difference(k) = gained[h](next[h]++);
  }
  return gain_over_parts(difference, rows);
}

}  // namespace

FoundTerms find_terms(const Recording& recording, const LinearStructure& structure, const FitOptions& options) {
  FoundTerms found;
  found.structure = structure;
  const TermRows rows =
      gather_term_rows(recording, structure, most_entries / (structure.regressors() + most_dictionary_terms));
  if (rows.count() < 2 * fewest_rows_per_column * structure.regressors()) return found;
  const std::vector<LinearStructure> structures = structures_of(structure);
  std::vector<SelectedTerms> all(structures.size());
  tbb::parallel_for(std::size_t{0}, structures.size(),
                    [&](std::size_t i) { all[i] = select_terms(rows, structures[i], options); });
  for (const SelectedTerms& one : all) found.tried.push_back({one.structure, one.terms.count(), one.log_score()});
  SelectedTerms& chosen = all[chosen_of(all, rows)];
  if (chosen.terms.empty()) return found;
  const PartGain gain = measured_gain(rows, chosen.structure, options);
  found.terms_asked = chosen.terms.count();
  found.gain = gain.mean;
  found.gain_standard_error = gain.standard_error;
  if (gain.mean < std::max(least_terms_gain, 2.0 * gain.standard_error)) return found;
  found.structure = chosen.structure;
  found.terms = std::move(chosen.terms);
  return found;
}

}  // namespace modebank
