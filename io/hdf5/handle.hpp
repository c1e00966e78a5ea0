#pragma once

#include <hdf5.h>

#include <mutex>
#include <string>
#include <utility>
#include <vector>

namespace modebank::hdf5 {

/// Owns an HDF5 identifier. A negative identifier of a failed call becomes a DataError with the action and HDF5's
/// reason.
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

/// Throws DataError "cannot <what>: <HDF5's innermost reason>" if the status is negative.
void check(herr_t status, const std::string& what);

/// Must live while a function calls HDF5. Unless HDF5 is thread-safe, other threads wait. Meanwhile HDF5 prints no
/// error stack in this thread; afterwards the application's own setting returns. After a failure it does not return:
/// HDF5 1.10 leaks memory at a wrong metadata checksum, and would print messages when the process ends.
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

/// Opens an existing file for reading. Takes no lock: archives never change under their final name, and many file
/// systems have no locks.
Handle open_file(const std::string& path);
/// A member group; "/": the root.
Handle open_group(hid_t parent, const std::string& name);
/// Names of a group's members and of an object's attributes, in byte order.
std::vector<std::string> member_names(hid_t group);
std::vector<std::string> attribute_names(hid_t object);
bool has_link(hid_t group, const std::string& name);
bool has_attribute(hid_t object, const std::string& name);

}  // namespace modebank::hdf5
