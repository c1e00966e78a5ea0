#include "io/archive/study_file.hpp"

#include <algorithm>

#include "io/archive/archive_file.hpp"
#include "io/archive/bank/open_archive.hpp"
#include "io/archive/groups/group_reader.hpp"
#include "io/archive/groups/group_writer.hpp"
#include "io/archive/layout.hpp"
#include "io/files/replace_file.hpp"
#include "io/files/sha256.hpp"
#include "io/hdf5/table.hpp"
#include "modebank/base/error.hpp"

namespace modebank {

namespace {

constexpr const char *trials_group = "trials", *answers_group = "answers";

void write_columns(hid_t group, const std::string& name, const std::vector<NamedColumn>& named) {
  std::vector<hdf5::TableColumn> columns;
  for (const NamedColumn& column : named)
    columns.push_back(
        {column.name, std::visit([](const auto& values) { return hdf5::TableColumn::Values(values); }, column.values)});
  const std::size_t rows =
      named.empty() ? 0 : std::visit([](const auto& values) { return values.size(); }, named.front().values);
  hdf5::write_table(group, name, columns, rows);
}

hdf5::Handle make_group(const hdf5::Handle& file, const char* name) {
  const std::string what = std::string("create the group ") + name;
  const hdf5::Handle creation(H5Pcreate(H5P_GROUP_CREATE), H5Pclose, what);
  hdf5::check(H5Pset_obj_track_times(creation.id(), false), what);
  return {H5Gcreate2(file.id(), name, H5P_DEFAULT, creation.id(), H5P_DEFAULT), H5Gclose, what};
}

/// Writes all parts of the file except the archives.
void write_table_of_runs(const hdf5::Handle& file, const StudyFile& study) {
  Archive origin;
  origin.provenance = study.provenance;
  origin.config = study.config;
  GroupWriter root(open_root(file));
  layout::exchange_origin(root, origin);
  write_columns(open_root(file).id(), study.table, study.columns);
  if (study.answers.empty()) return;
  const hdf5::Handle group = make_group(file, answers_group);
  for (const NamedTable& answer : study.answers) write_columns(group.id(), answer.name, answer.columns);
}

void link_archives(const hdf5::Handle& file, const StudyFile& study, const std::filesystem::path& folder) {
  const hdf5::Handle trials = make_group(file, trials_group);
  for (const auto& [name, path] : study.archives)
    hdf5::check(H5Lcreate_external(std::filesystem::proximate(path, folder).c_str(), "/", trials.id(), name.c_str(),
                                   H5P_DEFAULT, H5P_DEFAULT),
                "link to " + path.string());
}

NamedColumn::Values empty_column(const hdf5::StoredArray& table, unsigned member) {
  const hdf5::Handle type(H5Tget_member_type(table.type(), member), H5Tclose, "read a column's type");
  switch (H5Tget_class(type.id())) {
    case H5T_FLOAT:
      return std::vector<double>();
    case H5T_STRING:
      return std::vector<std::string>();
    default:
      if (H5Tget_sign(type.id()) == H5T_SGN_NONE) return std::vector<std::uint64_t>();
      return std::vector<std::int64_t>();
  }
}

std::string member_name(const hdf5::StoredArray& table, unsigned member) {
  char* name = H5Tget_member_name(table.type(), member);
  const std::string text = name ? name : "";
  H5free_memory(name);
  return text;
}

std::vector<NamedColumn> read_columns(const hdf5::StoredArray& table) {
  const hdf5::TableRows rows = hdf5::read_all_rows(table);
  std::vector<NamedColumn> columns;
  for (unsigned member = 0; member < static_cast<unsigned>(H5Tget_nmembers(table.type())); ++member) {
    NamedColumn column{member_name(table, member), empty_column(table, member)};
    std::visit(
        [&](auto& values) {
          hdf5::TableColumn stored{column.name, values};
          hdf5::read_column(rows, stored);
          values = std::get<std::decay_t<decltype(values)>>(stored.values);
        },
        column.values);
    columns.push_back(std::move(column));
  }
  return columns;
}

}  // namespace

/// The file is made in memory, so a full disk cannot interrupt HDF5.
void write_study_file(const std::filesystem::path& path, const StudyFile& study) {
  const hdf5::Quiet quiet;
  const ArchiveImage image;
  write_table_of_runs(image.file(), study);
  link_archives(image.file(), study, std::filesystem::absolute(path).parent_path());
  const std::string_view content = image.content();
  const UserBlock block = make_user_block(sha256_hex(content));
  replace_file(path, {std::string_view(block.data(), block.size()), content});
}

StudyFile read_study_file(const OpenArchive& file, const std::string& table) {
  const hdf5::Quiet quiet;
  try {
    Archive origin;
    GroupReader root(file.root(), nullptr);
    layout::exchange_origin(root, origin);
    StudyFile study{std::move(origin.provenance), std::move(origin.config), table, {}, {}, {}};
    study.columns = read_columns(hdf5::StoredArray(file.root().id(), hdf5::Place::dataset, table));
    return study;
  } catch (const DataError& error) {
    throw DataError(file.path().string() + ": " + error.what());
  }
}

namespace {

/// Collects the summary's scores through the layout, so the scores have the names of the columns.
struct ScoreCollector {
  const std::vector<std::string>& states;
  std::vector<std::pair<std::string, double>> scores = {};

  template <class... Columns>
  void optional_table(const std::string&, const std::vector<SummaryRow>& rows, const Columns&... columns) {
    for (const SummaryRow& row : rows)
      if (row.run == "*") (add(row, columns), ...);
  }

  template <class T>
  void add(const SummaryRow& row, const Column<SummaryRow, T>& column) {
    const std::string name = row.filter + "_" + std::string(name_of(row.role)) + "_" + column.name;
    if constexpr (std::is_same_v<T, Eigen::VectorXd>) {
      const Eigen::VectorXd& values = row.*column.member;
      if (values.size() != std::ssize(states))
        throw DataError("the summary's " + column.name + " has " + std::to_string(values.size()) + " entries for " +
                        std::to_string(states.size()) + " states");
      for (Eigen::Index i = 0; i < values.size(); ++i)
        scores.emplace_back(name + "_" + states[static_cast<std::size_t>(i)], values(i));
    } else if constexpr (std::is_arithmetic_v<T>) {
      scores.emplace_back(name, static_cast<double>(row.*column.member));
    }
  }
};

}  // namespace

std::vector<std::pair<std::string, double>> pooled_scores(const std::vector<SummaryRow>& summary,
                                                          const std::vector<std::string>& state_names) {
  ScoreCollector collector{state_names};
  layout::exchange_summary(collector, summary, {});
  return std::move(collector.scores);
}

TrialScores read_trial_scores(const OpenArchive& archive) {
  const hdf5::Quiet quiet;
  try {
    const hdf5::Handle root = archive.root();
    const hdf5::Handle data = hdf5::open_group(root.id(), "data");
    const hdf5::Handle bank = hdf5::open_group(root.id(), "bank");
    std::vector<SummaryRow> summary;
    GroupReader evaluation(hdf5::open_group(root.id(), "evaluation"), nullptr);
    layout::exchange_summary(evaluation, summary, {});
    const std::vector<std::string> states = hdf5::StoredArray(data.id(), hdf5::Place::attribute, "state_names").texts();
    const hdf5::StoredArray weights(bank.id(), hdf5::Place::dataset, "weight");
    TrialScores scores;
    scores.modes = static_cast<std::int64_t>(weights.elements());
    scores.pooled = pooled_scores(summary, states);
    evaluation.optional_group("evidence", true, {}, [&](auto& member) { member.attribute("answer", scores.evidence); });
    GroupReader attributes(archive.root(), nullptr);
    attributes.attribute("modebank_version", scores.modebank_version);
    attributes.attribute("config_hash", scores.config_hash);
    attributes.attribute("data_hash", scores.data_hash);
    return scores;
  } catch (const DataError& error) {
    throw DataError(archive.path().string() + ": " + error.what());
  }
}

}  // namespace modebank
