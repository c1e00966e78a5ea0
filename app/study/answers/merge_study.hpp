#pragma once

#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "app/study/answers/answers.hpp"
#include "app/study/run/trial_store.hpp"
#include "app/study/space/study_plan.hpp"
#include "io/archive/study_file.hpp"

namespace modebank::app {

/// The plan's rows with their results: scores from archives, failures from their records; the others are missing. An
/// archive counts when its hash is right. `whole`: archives already checked.
StudyTable collect_table(const TrialStore& store, const StudyPlan& plan, const std::set<std::string>& whole = {});

/// The rows with these scores, one entry per row; nullopt where a trial has none yet.
StudyTable with_scores(StudyTable table, const std::vector<std::optional<TrialScores>>& scores);

/// Content of study.h5 for a table.
StudyFile study_file_of(const StudyPlan& plan, const StudyTable& table, const Answers& answers);

/// Writes study.h5 (with the answers, and links to the archives or copies of them), study.csv, and the status of rows
/// into plan.h5.
void write_study(const TrialStore& store, const StudyPlan& plan, const StudyTable& table, const Answers& answers,
                 ArchiveUse use);

/// Columns of the table: varied keys (as numbers if all are), repeat, seed, status, message, key, scores.
std::vector<NamedColumn> table_columns(const StudyTable& table);

/// The same columns as CSV (RFC 4180), numbers with all their digits, NaN empty.
std::string table_csv(const StudyTable& table);

}  // namespace modebank::app
