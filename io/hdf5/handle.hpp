#pragma once

#include <hdf5.h>

#include <mutex>
#include <string>
#include <utility>
#include <vector>

namespace modebank::hdf5 {

/// Owns an HDF5 identifier. If a call failed, its identifier is negative. The constructor then throws DataError with
/// the action and HDF5's reason.
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

/// Throws DataError "cannot <what>: <HDF5's innermost reason>" if `status` is negative.
void check(herr_t status, const std::string& what);

/// An object of this class must exist while a function calls HDF5. Unless HDF5 is thread-safe, other threads wait.
/// Meanwhile HDF5 prints no error stack in this thread. Afterwards the application's own setting is restored, but not
/// after a failure: HDF5 1.10 leaks memory at a wrong metadata checksum, and would print messages when the process
/// ends.
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

/// Opens an existing file for reading, without a lock. Archives never change under their final name, and many file
/// systems have no locks.
Handle open_file(const std::string& path);
/// A member group. The name "/" means the root.
Handle open_group(hid_t parent, const std::string& name);
/// Names of a group's members and of an object's attributes, in byte order.
std::vector<std::string> member_names(hid_t group);
std::vector<std::string> attribute_names(hid_t object);
bool has_link(hid_t group, const std::string& name);
bool has_attribute(hid_t object, const std::string& name);

}  // namespace modebank::hdf5
