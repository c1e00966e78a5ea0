#include <pybind11/stl.h>

#include <string>
#include <vector>

#include "app/config/config_file.hpp"
#include "app/text/first_screen.hpp"
#include "app/text/summary_text.hpp"
#include "io/archive/archive.hpp"
#include "io/archive/bank/load_bank.hpp"
#include "io/archive/bank/open_archive.hpp"
#include "io/hdf5/array.hpp"
#include "io/hdf5/links.hpp"
#include "modebank/base/error.hpp"
#include "python/bindings/arrays.hpp"
#include "python/bindings/bindings.hpp"

namespace modebank::python {

namespace {

/// numpy's word for a type of the file; archives are little-endian.
py::object type_of(hid_t type);

py::object record_of(hid_t type) {
  py::list names, formats, offsets;
  for (int i = 0; i < H5Tget_nmembers(type); ++i) {
    const auto member = static_cast<unsigned>(i);
    char* const name = H5Tget_member_name(type, member);
    names.append(py::str(name));
    H5free_memory(name);
    const hdf5::Handle of_member(H5Tget_member_type(type, member), H5Tclose, "look at a column");
    formats.append(type_of(of_member.id()));
    offsets.append(H5Tget_member_offset(type, member));
  }
  py::dict record;
  record["names"] = names;
  record["formats"] = formats;
  record["offsets"] = offsets;
  record["itemsize"] = H5Tget_size(type);
  return record;
}

py::object type_of(hid_t type) {
  const std::string size = std::to_string(H5Tget_size(type));
  switch (H5Tget_class(type)) {
    case H5T_INTEGER:
      return py::str((H5Tget_sign(type) == H5T_SGN_2 ? "<i" : "<u") + size);
    case H5T_FLOAT:
      return py::str("<f" + size);
    case H5T_STRING:
      if (H5Tis_variable_str(type) == 0) return py::str("S" + size);
      break;
    case H5T_COMPOUND:
      return record_of(type);
    case H5T_ARRAY: {
      std::vector<hsize_t> shape(static_cast<std::size_t>(H5Tget_array_ndims(type)));
      H5Tget_array_dims2(type, shape.data());
      const hdf5::Handle element(H5Tget_super(type), H5Tclose, "look at a column");
      return py::make_tuple(type_of(element.id()), py::tuple(py::cast(shape)));
    }
    default:
      break;
  }
  throw DataError("holds a type of value that archives do not have");
}

py::array values_of(const hdf5::StoredArray& stored) {
  const py::dtype type = py::dtype::from_args(type_of(stored.type()));
  py::array array(type, Shape(stored.shape().begin(), stored.shape().end()));
  if (stored.elements() > 0) stored.read(stored.type(), array.mutable_data());
  return array;
}

/// An archive whose hash was checked. It is opened for each look at it: open, it would keep h5py in the same process
/// from opening it.
class ArchiveFile {
 public:
  explicit ArchiveFile(const std::string& path) : path_(path) {
    const hdf5::Quiet quiet;
    open_archive(path, HashCheck::before);
    digest_ = archive_digest(path);
  }

  /// Of a dataset its values, of a group the names of its members.
  py::object read(const std::string& path) const {
    return at(path, [](const hdf5::Handle& object, const hdf5::Handle& root, const std::string& name) -> py::object {
      if (H5Iget_type(object.id()) == H5I_GROUP) return py::cast(hdf5::member_names(object.id()));
      return values_of(hdf5::StoredArray(root.id(), hdf5::Place::dataset, name));
    });
  }
  py::object attributes(const std::string& path) const {
    return at(path, [](const hdf5::Handle& object, const hdf5::Handle&, const std::string&) -> py::object {
      py::dict result;
      for (const std::string& name : hdf5::attribute_names(object.id()))
        result[py::str(name)] = values_of(hdf5::StoredArray(object.id(), hdf5::Place::attribute, name));
      return result;
    });
  }

 private:
  /// Calls `body` with the object of that path. Throws py::key_error where there is none.
  template <class Body>
  py::object at(const std::string& path, Body body) const {
    const hdf5::Quiet quiet;
    if (archive_digest(path_) != digest_) throw DataError(path_ + ": is another archive now");
    const hdf5::Handle file = open_archive(path_, HashCheck::unchecked), root = open_root(file);
    const std::string relative = path.substr(std::min(path.find_first_not_of('/'), path.size()));
    if (relative.empty()) return body(root, root, ".");
    for (std::size_t end = relative.find('/');; end = relative.find('/', end + 1)) {
      const std::string part = relative.substr(0, end);
      if (!hdf5::has_link(root.id(), part)) throw py::key_error(path_ + " holds no " + path);
      hdf5::require_hard(root.id(), part);  // those above it are by now
      if (end == std::string::npos) break;
    }
    try {
      const hdf5::Handle object(H5Oopen(root.id(), relative.c_str(), H5P_DEFAULT), H5Oclose, "open '" + path + "'");
      return body(object, root, relative);
    } catch (const DataError& error) {
      throw DataError(path_ + ": " + path + ": " + error.what());
    }
  }

  std::string path_, digest_;
};

std::string screen(const std::string& path, int width) {
  const py::gil_scoped_release unlocked;
  const Archive archive = read_archive(path);
  return app::has_first_screen(archive) ? app::first_screen(archive, app::resolved_values(archive.config), path, width)
                                        : app::summary_text(archive, width);
}

std::string summary(const std::string& path, int width) {
  const py::gil_scoped_release unlocked;
  return app::summary_text(read_archive(path), width);
}

}  // namespace

void bind_archive_file(py::module_& module) {
  py::class_<ArchiveFile>(module, "ArchiveFile", "An archive whose hash was checked.")
      .def(py::init<const std::string&>(), py::arg("path"))
      .def("read", &ArchiveFile::read, py::arg("path"))
      .def("attributes", &ArchiveFile::attributes, py::arg("path"));
  module.def("screen", &screen, py::arg("path"), py::arg("width"));
  module.def("summary", &summary, py::arg("path"), py::arg("width"));
}

}  // namespace modebank::python
