#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "app/study/answers/answers.hpp"
#include "app/study/run/trial_store.hpp"
#include "app/study/space/study_plan.hpp"
#include "io/archive/study_file.hpp"

namespace modebank::app {

/// The rows of the plan with their results. Scores come from archives and failures from their records. All other rows
/// are missing. An archive counts if its hash is right. `whole`: archives that were already checked.
StudyTable collect_table(const TrialStore& store, const StudyPlan& plan, const std::set<std::string>& whole = {});

/// The rows with these scores. `scores` has one entry per row; nullopt for a trial without scores.
StudyTable with_scores(StudyTable table, const std::vector<std::optional<TrialScores>>& scores);

/// Tables of /answers in study.h5: main_effects, influence, best. `trial`: keys of trials.
std::vector<NamedTable> answer_tables(const StudyTable& table, const Answers& answers);

/// Content of study.h5 for a table.
StudyFile study_file_of(const StudyPlan& plan, const StudyTable& table, const Answers& answers);

/// Writes study.h5 (with the answers, and links to the archives), study.csv, and the status of each row into plan.h5.
void write_study(const TrialStore& store, const StudyPlan& plan, const StudyTable& table, const Answers& answers);

/// Columns of the table: varied keys, repeat, seed, status, message, key, scores. The values of a varied key are
/// numbers if all of them are numbers.
std::vector<NamedColumn> table_columns(const StudyTable& table);

/// The same columns as CSV (RFC 4180). Numbers have all digits; NaN is an empty field.
std::string table_csv(const StudyTable& table);

}  // namespace modebank::app
