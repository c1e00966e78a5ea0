#include "io/hdf5/handle.hpp"

#include <algorithm>

#include "modebank/base/error.hpp"

namespace modebank::hdf5 {

namespace {

/// HDF5 visits its error stack from the innermost record (n = 0) outwards. The innermost record is the reason.
herr_t keep_innermost(unsigned n, const H5E_error2_t* record, void* text) {
  if (n == 0 && record->desc) *static_cast<std::string*>(text) = record->desc;
  return 0;
}

std::string innermost_reason() {
  std::string text = "unknown reason";
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, keep_innermost, &text);
  // HDF5's file drivers write times and addresses around the system's message. Users do not need them.
  const std::string mark = "error message = '";
  const auto begin = text.find(mark);
  if (begin == std::string::npos) return text;
  const auto end = text.find('\'', begin + mark.size());
  return text.substr(begin + mark.size(), end == std::string::npos ? end : end - begin - mark.size());
}

thread_local bool failed = false;  ///< whether HDF5 has failed in this thread

[[noreturn]] void fail(const std::string& what) {
  failed = true;
  throw DataError("cannot " + what + ": " + innermost_reason());
}

}  // namespace

Handle::Handle(hid_t id, Closer close, const std::string& what) : id_(id), close_(close) {
  if (id < 0) fail(what);
}

Handle& Handle::operator=(Handle&& other) noexcept {
  if (this == &other) return *this;
  reset();
  id_ = std::exchange(other.id_, H5I_INVALID_HID);
  close_ = other.close_;
  return *this;
}

void Handle::reset() noexcept {
  if (id_ >= 0) close_(id_);
  id_ = H5I_INVALID_HID;
}

void check(herr_t status, const std::string& what) {
  if (status < 0) fail(what);
}

namespace {

/// Lets only one thread at a time call HDF5, if HDF5 was built without thread safety.
std::unique_lock<std::recursive_mutex> one_thread() {
  static std::recursive_mutex mutex;
  static const bool has_its_own = [] {
    hbool_t safe = false;
    return H5is_library_threadsafe(&safe) >= 0 && safe;
  }();
  return has_its_own ? std::unique_lock<std::recursive_mutex>() : std::unique_lock(mutex);
}

}  // namespace

Quiet::Quiet() : lock_(one_thread()) {
  H5Eget_auto2(H5E_DEFAULT, &function_, &data_);
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

Quiet::~Quiet() {
  if (!failed) H5Eset_auto2(H5E_DEFAULT, function_, data_);
}

Handle open_file(const std::string& path) {
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "prepare the file access");
  check(H5Pset_file_locking(access.id(), false, true), "switch file locking off");
  hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDONLY, access.id());
  // h5py may have opened the file in the same process. HDF5 then requires the same lock setting, which is the default.
  if (file < 0) file = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  return {file, H5Fclose, "open the file"};
}

Handle open_group(hid_t parent, const std::string& name) {
  return {H5Gopen2(parent, name.c_str(), H5P_DEFAULT), H5Gclose, "open the group '" + name + "'"};
}

namespace {

/// Callback for H5Literate and H5Aiterate2.
template <class Info>
herr_t append_name(hid_t, const char* name, const Info*, void* list) {
  static_cast<std::vector<std::string>*>(list)->emplace_back(name);
  return 0;
}

}  // namespace

// The functions below sort both lists themselves. If HDF5 1.10 is asked for an order, it builds a table. It crashes
// when it frees the half-filled table of a damaged file.
std::vector<std::string> member_names(hid_t group) {
  std::vector<std::string> names;
  check(H5Literate(group, H5_INDEX_NAME, H5_ITER_NATIVE, nullptr, append_name<H5L_info_t>, &names), "list the members");
  std::sort(names.begin(), names.end());
  return names;
}

std::vector<std::string> attribute_names(hid_t object) {
  std::vector<std::string> names;
  check(H5Aiterate2(object, H5_INDEX_NAME, H5_ITER_NATIVE, nullptr, append_name<H5A_info_t>, &names),
        "list the attributes");
  std::sort(names.begin(), names.end());
  return names;
}

bool has_link(hid_t group, const std::string& name) {
  const htri_t found = H5Lexists(group, name.c_str(), H5P_DEFAULT);
  check(found, "look for '" + name + "'");
  return found > 0;
}

bool has_attribute(hid_t object, const std::string& name) {
  const htri_t found = H5Aexists(object, name.c_str());
  check(found, "look for the attribute '" + name + "'");
  return found > 0;
}

}  // namespace modebank::hdf5
