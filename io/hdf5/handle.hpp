#pragma once

#include <hdf5.h>

#include <mutex>
#include <string>
#include <utility>
#include <vector>

namespace modebank::hdf5 {

/// Owns one HDF5 identifier. A failed open arrives here as a negative identifier and becomes a DataError that says
/// what was tried and why HDF5 refused.
class Handle {
 public:
  using Closer = herr_t (*)(hid_t);

  Handle() = default;
  Handle(hid_t id, Closer close, const std::string& what);
  ~Handle() { reset(); }
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, H5I_INVALID_HID)), close_(other.close_) {}
  Handle& operator=(Handle&& other) noexcept;
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;

  hid_t id() const { return id_; }
  void reset() noexcept;

 private:
  hid_t id_ = H5I_INVALID_HID;
  Closer close_ = nullptr;
};

/// Throws DataError "cannot <what>: <HDF5's innermost reason>" when the status is negative.
void check(herr_t status, const std::string& what);

/// Lives as long as a function of ours works with HDF5, whatever the library was built with: other threads wait unless
/// it is thread-safe. While one lives, this thread's HDF5 prints no error stack; the application's own setting comes
/// back afterwards. After an HDF5 failure it does not: HDF5 1.10 leaks inside when a metadata checksum is wrong, and
/// would complain about itself on stderr when the process ends.
class Quiet {
 public:
  Quiet();
  ~Quiet();
  Quiet(const Quiet&) = delete;
  Quiet& operator=(const Quiet&) = delete;

 private:
  std::unique_lock<std::recursive_mutex> lock_;
  H5E_auto2_t function_ = nullptr;
  void* data_ = nullptr;
};

/// Opens an existing file for reading. No lock is taken (archives never change under their final name, and many file
/// systems refuse locks).
Handle open_file(const std::string& path);
/// A member group; "/": the root.
Handle open_group(hid_t parent, const std::string& name);
/// Names of a group's members and of an object's attributes, in byte order.
std::vector<std::string> member_names(hid_t group);
std::vector<std::string> attribute_names(hid_t object);
bool has_link(hid_t group, const std::string& name);
bool has_attribute(hid_t object, const std::string& name);

}  // namespace modebank::hdf5
