#include "io/archive/groups/group_reader.hpp"

#include <new>
#include <stdexcept>

namespace modebank {

namespace {

/// A problem whose text already contains its path. Enclosing groups do not add their own paths.
struct PlacedError : DataError {
  using DataError::DataError;
};

}  // namespace

void GroupReader::guarded(const std::string& name, const std::function<void()>& step) {
  const auto report = [&](const std::string& problem) {
    const std::string placed = path_ + "/" + name + ": " + problem;
    if (!problems_) throw PlacedError(placed);
    problems_->push_back(placed);
  };
  try {
    step();
  } catch (const PlacedError&) {
    throw;
  } catch (const DataError& error) {
    report(error.what());
  } catch (const std::invalid_argument& error) {
    report(error.what());
  } catch (const std::bad_alloc&) {
    report("is too large for this machine's memory");
  }
}

void GroupReader::finish(const std::function<void()>& step) {
  if (!problems_ || problems_->size() == problems_before_) guarded("", step);
}

GroupReader GroupReader::open_member(const std::string& name) const {
  if (!has(name)) throw DataError("is missing");
  GroupReader member(hdf5::open_group(group_.id(), name), problems_, path_ + "/" + name);
  member.left_out_ = left_out_;
  return member;
}

hdf5::StoredArray GroupReader::open_array(const std::string& name) const {
  if (!has(name)) throw DataError("is missing");
  return {group_.id(), hdf5::Place::dataset, name};
}

void GroupReader::check_numbers(const hdf5::StoredArray& array, const Letters& letters, H5T_class_t kind) {
  if (array.type_class() != kind) throw DataError("has values of another type");
  const std::string problem = sizes_.agree(letters, array.shape());
  if (!problem.empty()) throw DataError("has " + problem);
}

hdf5::StoredArray GroupReader::open_attribute(const std::string& name, H5T_class_t kind, bool scalar) const {
  if (!hdf5::has_attribute(group_.id(), name)) throw DataError("the attribute is missing");
  hdf5::StoredArray array(group_.id(), hdf5::Place::attribute, name);
  if (array.type_class() != kind || array.shape().size() != (scalar ? 0 : 1) || (scalar && array.elements() != 1))
    throw DataError("the attribute has a value of another type");
  return array;
}

void GroupReader::read_attribute(const std::string& name, std::string& value) const {
  value = open_attribute(name, H5T_STRING, true).texts().front();
}

void GroupReader::constant_attribute(const std::string& name, const std::string& expected) {
  guarded(name, [&] {
    std::string found;
    read_attribute(name, found);
    if (found != expected)
      throw DataError("the attribute is '" + found + "', this version supports '" + expected + "'");
  });
}

void GroupReader::attribute_texts(const std::string& name, std::vector<std::string>& texts) {
  guarded(name, [&] {
    texts = open_attribute(name, H5T_STRING, false).texts();
    if (const std::string problem = verifies() ? broken_text(texts) : ""; !problem.empty()) throw DataError(problem);
  });
}

void GroupReader::attributes(std::vector<std::pair<std::string, std::string>>& pairs) {
  std::vector<std::string> names;
  guarded("", [&] { names = hdf5::attribute_names(group_.id()); });
  for (const std::string& name : names) {
    pairs.emplace_back(name, "");
    attribute(name, pairs.back().second);
  }
}

void GroupReader::text(const std::string& name, std::string& value) {
  guarded(name, [&] {
    const hdf5::StoredArray array = open_array(name);
    if (array.elements() != 1) throw DataError("is not one text");
    value = array.texts().front();
    check(rule::any, value);
  });
}

void GroupReader::texts(const std::string& name, std::vector<std::string>& values, const Letters& letters) {
  guarded(name, [&] {
    const hdf5::StoredArray array = open_array(name);
    const std::string problem = sizes_.agree(letters, array.shape());
    if (!problem.empty()) throw DataError("has " + problem);
    values = array.texts();
    if (const std::string text = verifies() ? broken_text(values) : ""; !text.empty()) throw DataError(text);
  });
}

}  // namespace modebank
