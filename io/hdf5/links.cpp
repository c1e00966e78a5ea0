#include "io/hdf5/links.hpp"

#include <algorithm>

#include "io/hdf5/array.hpp"
#include "modebank/base/error.hpp"

namespace modebank::hdf5 {

namespace {

herr_t append_link(hid_t, const char* name, const H5L_info_t* info, void* list) {
  static_cast<std::vector<Link>*>(list)->push_back({name, info->type == H5L_TYPE_HARD});
  return 0;
}

H5L_info_t link_info(hid_t group, const std::string& name) {
  H5L_info_t info;
  check(H5Lget_info(group, name.c_str(), &info, H5P_DEFAULT), "look at '" + name + "'");
  return info;
}

/// The file and the path in it that an external link names.
std::pair<std::string, std::string> far_end(hid_t group, const std::string& name, std::size_t bytes) {
  std::string value(bytes, '\0');
  check(H5Lget_val(group, name.c_str(), value.data(), value.size(), H5P_DEFAULT), "read the link '" + name + "'");
  const char *file = nullptr, *object = nullptr;
  unsigned flags = 0;
  check(H5Lunpack_elink_val(value.data(), value.size(), &flags, &file, &object), "read the link '" + name + "'");
  return {file, object};
}

[[noreturn]] void refuse_link() { throw DataError("is a link to another place; an archive holds all that is its own"); }

}  // namespace

std::vector<Link> links_of(hid_t group) {
  std::vector<Link> links;
  check(H5Literate(group, H5_INDEX_NAME, H5_ITER_NATIVE, nullptr, append_link, &links), "list the members");
  std::sort(links.begin(), links.end(), [](const Link& a, const Link& b) { return a.name < b.name; });
  return links;
}

void check_link(hid_t group, const std::string& path, const Link& link, const LinkAllowed& elsewhere) {
  if (link.hard) return;
  const H5L_info_t info = link_info(group, link.name);
  if (info.type == H5L_TYPE_EXTERNAL && elsewhere) {
    const auto [file, object] = far_end(group, link.name, info.u.val_size);
    if (elsewhere(path + "/" + link.name, file, object)) return;
  }
  refuse_link();
}

void check_below(hid_t group, const std::string& path, const std::string& name, const LinkAllowed& elsewhere) {
  require_hard(group, name);
  const Handle object(H5Oopen(group, name.c_str(), H5P_DEFAULT), H5Oclose, "open '" + name + "'");
  require_single(object.id(), name);
  switch (H5Iget_type(object.id())) {
    case H5I_DATASET:
      if (lies_outside(object.id())) throw DataError("keeps its content in another file");
      return;
    case H5I_GROUP:
      for (const Link& link : links_of(object.id())) {
        const std::string below = path + "/" + name;
        if (link.hard)
          check_below(object.id(), below, link.name, elsewhere);
        else
          check_link(object.id(), below, link, elsewhere);
      }
      return;
    default:
      throw DataError("'" + name + "' is neither a group nor a dataset");
  }
}

void require_hard(hid_t parent, const std::string& name) {
  if (name != "/" && link_info(parent, name).type != H5L_TYPE_HARD) refuse_link();
}

void require_single(hid_t object, const std::string& name) {
  H5O_info_t info;
  check(H5Oget_info2(object, &info, H5O_INFO_BASIC), "look at '" + name + "'");
  if (info.rc > 1) throw DataError("'" + name + "' has several names in the file, as nothing in an archive has");
}

}  // namespace modebank::hdf5
