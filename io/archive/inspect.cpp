#include "io/archive/inspect.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <string>
#include <variant>
#include <vector>

#include "ident/base/nearest_name.hpp"
#include "io/archive/array_json.hpp"
#include "io/hdf5/table.hpp"
#include "modebank/base/error.hpp"

namespace modebank {

namespace {

using nlohmann::json;

json attributes_of(hid_t object) {
  json attributes = json::object();
  for (const std::string& name : hdf5::attribute_names(object))
    attributes[hdf5::text_json(name).get<std::string>()] =
        hdf5::to_json(hdf5::StoredArray(object, hdf5::Place::attribute, name));
  return attributes;
}

hdf5::Handle open_object(const hdf5::Handle& group, const std::string& name) {
  return {H5Oopen(group.id(), name.c_str(), H5P_DEFAULT), H5Oclose, "open '" + name + "'"};
}

bool is_hard_link(const hdf5::Handle& group, const std::string& name) {
  H5L_info_t info;
  hdf5::check(H5Lget_info(group.id(), name.c_str(), &info, H5P_DEFAULT), "look at '" + name + "'");
  return info.type == H5L_TYPE_HARD;
}

/// The requested run, if any. Contains its row of /data/runs and its rows in arrays over samples.
struct AskedRun {
  std::string name;
  json row;
  hdf5::Rows rows;

  explicit operator bool() const { return !name.empty(); }
};

/// Whether the group has arrays over the samples of all runs. This holds for /data and /evaluation/FILTER.
bool is_of_samples(const std::string& group) {
  return group == "/data" || (group.starts_with("/evaluation/") && group.find('/', 1) == group.rfind('/') &&
                              group != "/evaluation/evidence");
}

/// Whether an array of such a group has one row per sample.
bool has_samples(const std::string& group, const std::string& name) {
  return is_of_samples(group) && !(group == "/data" && (name == "runs" || name == "quantum"));
}

json members_of(const hdf5::Handle& group, const std::string& path, const AskedRun& run, int levels);

/// Describes a member in the listing of its group.
json listing(const hdf5::Handle& group, const std::string& path, const std::string& name, const AskedRun& run,
             int levels) {
  if (!is_hard_link(group, name)) return {{"kind", "link"}};
  const hdf5::Handle object = open_object(group, name);
  switch (H5Iget_type(object.id())) {
    case H5I_GROUP: {
      json entry = {{"kind", "group"}};
      const std::string below = (path == "/" ? "" : path) + "/" + name;
      if (levels > 1) entry["members"] = members_of(hdf5::open_group(group.id(), name), below, run, levels - 1);
      return entry;
    }
    case H5I_DATASET: {
      const hdf5::StoredArray array(group.id(), hdf5::Place::dataset, name);
      hdf5::Shape shape = array.shape();
      if (run) shape.front() = run.rows.count;
      json entry = {{"kind", array.type_class() == H5T_COMPOUND ? "table" : "dataset"}, {"shape", shape}};
      if (hdf5::has_attribute(object.id(), "units"))
        entry["units"] = hdf5::to_json(hdf5::StoredArray(object.id(), hdf5::Place::attribute, "units"));
      return entry;
    }
    default:
      return {{"kind", "other"}};
  }
}

json members_of(const hdf5::Handle& group, const std::string& path, const AskedRun& run, int levels) {
  json members = json::object();
  for (const std::string& name : hdf5::member_names(group.id()))
    if (!run || has_samples(path, name))
      members[hdf5::text_json(name).get<std::string>()] = listing(group, path, name, run, levels);
  return members;
}

[[noreturn]] void refuse_run(const std::string& path) {
  throw ConfigurationError(
      path +
      " has nothing by run; --run works with /data, /evaluation/FILTER, their members, and tables with the column run");
}

/// The rows of a table that belong to the run.
json rows_of_run(const json& rows, const std::string& path, const AskedRun& run) {
  const char* const key = path == "/data" ? "name" : "run";
  json kept = json::array();
  for (const json& row : rows)
    if (row.value(key, "") == run.name) kept.push_back(row);
  return kept;
}

json dataset_json(const hdf5::Handle& group, const std::string& path, const std::string& name, const AskedRun& run) {
  const hdf5::StoredArray array(group.id(), hdf5::Place::dataset, name);
  const bool of_samples = has_samples(path, name), is_table = array.type_class() == H5T_COMPOUND;
  json dataset = {{"attributes", attributes_of(array.object())}};
  dataset["value"] = run && of_samples ? hdf5::to_json(array, run.rows) : hdf5::to_json(array);
  hdf5::Shape shape = array.shape();
  if (is_table) dataset["columns"] = hdf5::column_names(array);
  if (run && is_table && (hdf5::has_column(array, "run") || path == "/data"))
    dataset["value"] = rows_of_run(dataset["value"], path, run);
  else if (run && !of_samples)
    refuse_run((path == "/" ? "" : path) + "/" + name);
  if (run) shape.front() = dataset["value"].size();
  dataset["shape"] = shape;
  return dataset;
}

json group_json(const hdf5::Handle& group, const std::string& path, const AskedRun& run) {
  constexpr int listed_levels = 2;
  if (run && !is_of_samples(path)) refuse_run(path);
  return {{"attributes", attributes_of(group.id())}, {"members", members_of(group, path, run, listed_levels)}};
}

std::vector<std::string> components(const std::string& path) {
  std::vector<std::string> parts;
  for (std::size_t begin = 0; begin <= path.size();) {
    const std::size_t end = std::min(path.find('/', begin), path.size());
    if (end > begin) parts.push_back(path.substr(begin, end - begin));
    begin = end + 1;
  }
  return parts;
}

/// Opens one group after another, so that the error for a wrong path lists the members of the last existing group.
json json_at(hdf5::Handle group, const std::string& path, const AskedRun& run) {
  std::string so_far = "/";
  const std::vector<std::string> parts = components(path);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const bool found = parts[i] != "." && hdf5::has_link(group.id(), parts[i]);
    if (!found)
      throw ConfigurationError(fmt::format("there is no '{}' in {}; its members are: {}", parts[i], so_far,
                                           fmt::join(hdf5::member_names(group.id()), ", ")));
    if (H5Iget_type(open_object(group, parts[i]).id()) == H5I_DATASET) {
      if (i + 1 < parts.size())
        throw ConfigurationError(fmt::format("'{}' in {} is a dataset, which has no members", parts[i], so_far));
      return dataset_json(group, so_far, parts[i], run);
    }
    group = hdf5::open_group(group.id(), parts[i]);
    so_far += (i == 0 ? "" : "/") + parts[i];
  }
  return group_json(group, so_far, run);
}

AskedRun asked_run(const hdf5::Handle& root, const std::string& name) {
  if (name.empty()) return {};
  if (!hdf5::has_link(root.id(), "data")) throw ConfigurationError("has no data, and so no run " + name);
  const hdf5::Handle data = hdf5::open_group(root.id(), "data");
  const hdf5::StoredArray runs(data.id(), hdf5::Place::dataset, "runs");
  hdf5::TableColumn column{"name", std::vector<std::string>()};
  hdf5::read_column(hdf5::read_all_rows(runs), column);
  const auto& names = std::get<std::vector<std::string>>(column.values);
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end())
    throw ConfigurationError(
        fmt::format("has no run '{}'{}; its runs are {}", name, did_you_mean(name, names), fmt::join(names, ", ")));
  const json row = hdf5::to_json(runs, {static_cast<hsize_t>(found - names.begin()), 1}).front();
  return {name, row, {row.at("first").get<hsize_t>(), row.at("samples").get<hsize_t>()}};
}

/// All arrays and table rows of a run.
json overview_of(const hdf5::Handle& root, const AskedRun& run) {
  json members = json::object();
  const auto add = [&](const std::string& path) {
    members[path] = members_of(hdf5::open_group(root.id(), path), path, run, 1);
  };
  add("/data");
  if (hdf5::has_link(root.id(), "evaluation"))
    for (const std::string& name : hdf5::member_names(hdf5::open_group(root.id(), "evaluation").id()))
      if (is_of_samples("/evaluation/" + name) &&
          H5Iget_type(open_object(root, "evaluation/" + name).id()) == H5I_GROUP)
        add("/evaluation/" + name);
  return {{"run", run.row}, {"members", members}};
}

}  // namespace

nlohmann::json inspect(const OpenArchive& archive, const std::string& path, const std::string& run) {
  const hdf5::Quiet quiet;
  const std::string place = archive.path().string() + ": ";
  try {
    hdf5::Handle root = archive.root();
    const AskedRun asked = asked_run(root, run);
    if (asked && components(path).empty()) return overview_of(root, asked);
    return json_at(std::move(root), path, asked);
  } catch (const DataError& error) {
    throw DataError(place + error.what());
  } catch (const ConfigurationError& error) {
    throw ConfigurationError(place + error.what());
  }
}

}  // namespace modebank
