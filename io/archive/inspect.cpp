#include "io/archive/inspect.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <vector>

#include "io/archive/array_json.hpp"
#include "io/archive/bank/open_archive.hpp"
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

json members_of(const hdf5::Handle& group, int levels);

/// How a member appears in the listing of its group.
json listing(const hdf5::Handle& group, const std::string& name, int levels) {
  if (!is_hard_link(group, name)) return {{"kind", "link"}};
  const hdf5::Handle object = open_object(group, name);
  switch (H5Iget_type(object.id())) {
    case H5I_GROUP: {
      json entry = {{"kind", "group"}};
      if (levels > 1) entry["members"] = members_of(hdf5::open_group(group.id(), name), levels - 1);
      return entry;
    }
    case H5I_DATASET: {
      const hdf5::StoredArray array(group.id(), hdf5::Place::dataset, name);
      json entry = {{"kind", array.type_class() == H5T_COMPOUND ? "table" : "dataset"}, {"shape", array.shape()}};
      if (hdf5::has_attribute(object.id(), "units"))
        entry["units"] = hdf5::to_json(hdf5::StoredArray(object.id(), hdf5::Place::attribute, "units"));
      return entry;
    }
    default:
      return {{"kind", "other"}};
  }
}

json members_of(const hdf5::Handle& group, int levels) {
  json members = json::object();
  for (const std::string& name : hdf5::member_names(group.id()))
    members[hdf5::text_json(name).get<std::string>()] = listing(group, name, levels);
  return members;
}

json dataset_json(const hdf5::Handle& group, const std::string& name) {
  const hdf5::StoredArray array(group.id(), hdf5::Place::dataset, name);
  json dataset = {
      {"attributes", attributes_of(array.object())}, {"shape", array.shape()}, {"value", hdf5::to_json(array)}};
  if (array.type_class() == H5T_COMPOUND) dataset["columns"] = hdf5::column_names(array);
  return dataset;
}

json group_json(const hdf5::Handle& group) {
  constexpr int listed_levels = 2;
  return {{"attributes", attributes_of(group.id())}, {"members", members_of(group, listed_levels)}};
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

/// Goes down group by group, so that a wrong path can be answered with what is there.
json json_at(const hdf5::Handle& file, const std::string& path) {
  hdf5::Handle group = open_root(file);
  std::string so_far = "/";
  const std::vector<std::string> parts = components(path);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const bool found = parts[i] != "." && hdf5::has_link(group.id(), parts[i]);
    if (!found)
      throw ConfigurationError(fmt::format("there is no '{}' in {}, which holds: {}", parts[i], so_far,
                                           fmt::join(hdf5::member_names(group.id()), ", ")));
    if (H5Iget_type(open_object(group, parts[i]).id()) == H5I_DATASET) {
      if (i + 1 < parts.size())
        throw ConfigurationError(fmt::format("'{}' in {} is a dataset and has no members", parts[i], so_far));
      return dataset_json(group, parts[i]);
    }
    group = hdf5::open_group(group.id(), parts[i]);
    so_far += (i == 0 ? "" : "/") + parts[i];
  }
  return group_json(group);
}

}  // namespace

nlohmann::json inspect(const std::filesystem::path& archive, const std::string& path) {
  const hdf5::Quiet quiet;
  const hdf5::Handle file = open_archive(archive, HashCheck::before);
  try {
    return json_at(file, path);
  } catch (const DataError& error) {
    throw DataError(archive.string() + ": " + error.what());
  } catch (const ConfigurationError& error) {
    throw ConfigurationError(archive.string() + ": " + error.what());
  }
}

}  // namespace modebank
