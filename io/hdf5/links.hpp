#pragma once

#include <functional>
#include <string>
#include <vector>

#include "io/hdf5/handle.hpp"

namespace modebank::hdf5 {

/// How a group names a member: by a link to the object itself (hard), or to a path here or in another file.
struct Link {
  std::string name;
  bool hard = true;
};

/// In byte order of the names. Nothing is opened.
std::vector<Link> links_of(hid_t group);

/// Whether a link to another file may be there: its path in this file, the other file's path and the path in that.
using LinkAllowed = std::function<bool(const std::string& place, const std::string& file, const std::string& object)>;

/// Throws DataError for a link that is not hard, unless it leads to another file and is allowed.
void check_link(hid_t group, const std::string& path, const Link& link, const LinkAllowed& elsewhere);
/// The same for all that lies below a member of the group at `path`; and for objects that are neither group nor
/// dataset, that two links lead to, or whose values lie elsewhere.
void check_below(hid_t group, const std::string& path, const std::string& name, const LinkAllowed& elsewhere);

// An archive is a tree, all of it in one file.
/// Throws DataError when the member is no hard link. "/" is the root itself.
void require_hard(hid_t parent, const std::string& name);
/// Throws DataError when an open object has several names.
void require_single(hid_t object, const std::string& name);

}  // namespace modebank::hdf5
