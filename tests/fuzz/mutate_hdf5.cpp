#include "tests/fuzz/mutate_hdf5.hpp"

#include <hdf5.h>

#include <algorithm>
#include <vector>

#include "io/archive/bank/open_archive.hpp"
#include "io/files/sha256.hpp"
#include "tests/fuzz/mutate.hpp"
#include "tests/fuzz/scratch.hpp"

namespace modebank::fuzz {

namespace {

/// An identifier that is closed; negative ones are what HDF5 refused, and all functions below refuse them in turn.
class Id {
 public:
  Id(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
  ~Id() {
    if (id_ >= 0) close_(id_);
  }
  Id(const Id&) = delete;
  Id& operator=(const Id&) = delete;
  operator hid_t() const { return id_; }  // NOLINT: it stands where HDF5 takes one

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

struct Object {
  std::string path;
  bool is_dataset = false;
};

std::vector<Object> objects_of(hid_t file) {
  std::vector<Object> objects;
  const auto visit = [](hid_t, const char* name, const H5O_info_t* info, void* list) -> herr_t {
    static_cast<std::vector<Object>*>(list)->push_back({name, info->type == H5O_TYPE_DATASET});
    return 0;
  };
  H5Ovisit2(file, H5_INDEX_NAME, H5_ITER_NATIVE, visit, &objects, H5O_INFO_BASIC);
  return objects;
}

/// Overwrites one value of this type at `at`, which has `room` bytes.
void odd_value(Random& random, hid_t type, char* at, std::size_t room) {
  const std::size_t bytes = std::min(H5Tget_size(type), room);
  const auto put = [&](const void* value, std::size_t size) {
    std::copy_n(static_cast<const char*>(value), std::min(size, bytes), at);
  };
  switch (H5Tget_class(type)) {
    case H5T_FLOAT: {
      const double wide = odd_double(random);
      const auto narrow = static_cast<float>(wide);
      bytes == sizeof narrow ? put(&narrow, sizeof narrow) : put(&wide, sizeof wide);
      break;
    }
    case H5T_STRING: {
      if (H5Tis_variable_str(type) > 0) break;  // a pointer
      const std::string text =
          mutated_text(random, {std::string(at, bytes)}, {"..", "/", "run", "bank", "\x1b[2J", "0", "done"});
      std::fill_n(at, bytes, '\0');
      put(text.data(), text.size());
      break;
    }
    case H5T_COMPOUND: {
      const int members = H5Tget_nmembers(type);
      if (members <= 0) break;
      const auto member = static_cast<unsigned>(random.below(static_cast<std::size_t>(members)));
      const std::size_t offset = H5Tget_member_offset(type, member);
      const Id inner(H5Tget_member_type(type, member), H5Tclose);
      if (offset < bytes) odd_value(random, inner, at + offset, bytes - offset);
      break;
    }
    case H5T_INTEGER:
    case H5T_ENUM: {
      const std::uint64_t whole = odd_whole(random);
      put(&whole, sizeof whole);
      break;
    }
    default:
      break;
  }
}

/// Changes values in a buffer of `count` elements, some or all alike.
void odd_values(Random& random, hid_t type, std::vector<char>& values, std::size_t count) {
  const std::size_t bytes = H5Tget_size(type);
  if (count == 0 || bytes == 0) return;
  for (std::size_t left = random.one_in(4) ? count : 1 + random.below(3); left > 0; --left) {
    const std::size_t at = random.below(count) * bytes;
    odd_value(random, type, values.data() + at, values.size() - at);
  }
}

/// Of values that are read to be changed; what only declares to be large holds none.
constexpr std::size_t most_values = 1'000'000;

void edit_dataset(Random& random, hid_t file, const std::string& path) {
  const Id data(H5Dopen2(file, path.c_str(), H5P_DEFAULT), H5Dclose);
  const Id type(H5Dget_type(data), H5Tclose), space(H5Dget_space(data), H5Sclose);
  const auto count = static_cast<std::size_t>(std::max<hssize_t>(0, H5Sget_simple_extent_npoints(space)));
  if (count > most_values || H5Tdetect_class(type, H5T_VLEN) > 0 || H5Tis_variable_str(type) > 0 ||
      H5Tdetect_class(type, H5T_REFERENCE) > 0)
    return;
  std::vector<char> values(count * H5Tget_size(type));
  if (values.empty() || H5Dread(data, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0) return;
  odd_values(random, type, values, count);
  H5Dwrite(data, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
}

void edit_attribute(Random& random, hid_t file, const std::string& path) {
  const Id object(H5Oopen(file, path.c_str(), H5P_DEFAULT), H5Oclose);
  H5O_info_t info{};
  if (H5Oget_info2(object, &info, H5O_INFO_NUM_ATTRS) < 0 || info.num_attrs == 0) return;
  const auto n = static_cast<hsize_t>(random.below(info.num_attrs));
  const Id attribute(H5Aopen_by_idx(object, ".", H5_INDEX_NAME, H5_ITER_NATIVE, n, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  if (random.one_in(5)) {
    H5Adelete_by_idx(object, ".", H5_INDEX_NAME, H5_ITER_NATIVE, n, H5P_DEFAULT);
    return;
  }
  const Id type(H5Aget_type(attribute), H5Tclose), space(H5Aget_space(attribute), H5Sclose);
  const auto count = static_cast<std::size_t>(std::max<hssize_t>(0, H5Sget_simple_extent_npoints(space)));
  if (H5Tis_variable_str(type) > 0 || H5Tdetect_class(type, H5T_VLEN) > 0) return;
  std::vector<char> values(count * H5Tget_size(type));
  if (values.empty() || H5Aread(attribute, type, values.data()) < 0) return;
  odd_values(random, type, values, count);
  H5Awrite(attribute, type, values.data());
}

/// A dataset of the same name, kind or another, with another shape, which may hold nothing.
void reshape(Random& random, hid_t file, const std::string& path) {
  const Id data(H5Dopen2(file, path.c_str(), H5P_DEFAULT), H5Dclose);
  const Id type(H5Dget_type(data), H5Tclose), space(H5Dget_space(data), H5Sclose);
  std::vector<hsize_t> shape(8);
  const int rank = H5Sget_simple_extent_dims(space, shape.data(), nullptr);
  if (rank < 0 || rank > 7) return;
  shape.resize(static_cast<std::size_t>(rank));
  if (random.one_in(5)) shape.push_back(1 + random.below(3));
  if (!shape.empty() && random.one_in(5)) shape.pop_back();
  for (hsize_t& extent : shape)
    if (random.one_in(2))
      extent =
          random.pick({hsize_t{0}, hsize_t{1}, extent + 1, extent > 0 ? extent - 1 : 0, extent * 2, hsize_t{1} << 40});
  const Id creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  const bool chunked = !shape.empty() && std::find(shape.begin(), shape.end(), 0) == shape.end();
  const std::vector<hsize_t> chunk(shape.size(), 1);
  if (chunked) H5Pset_chunk(creation, static_cast<int>(chunk.size()), chunk.data());
  if (chunked && random.one_in(3)) H5Pset_deflate(creation, 6);
  const Id other(H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr), H5Sclose);
  const hid_t kind = random.one_in(3)
                         ? random.pick({H5T_IEEE_F64LE, H5T_STD_I32LE, H5T_STD_U64LE, H5T_C_S1, H5T_IEEE_F32BE})
                         : static_cast<hid_t>(type);
  H5Ldelete(file, path.c_str(), H5P_DEFAULT);
  const Id made(H5Dcreate2(file, path.c_str(), kind, other, H5P_DEFAULT, creation, H5P_DEFAULT), H5Dclose);
}

void edit_once(Random& random, hid_t file, const std::vector<Object>& objects) {
  const Object& object = random.pick(objects);
  const Object& other = random.pick(objects);
  const char *path = object.path.c_str(), *at = other.path.c_str();
  switch (random.below(10)) {
    case 0:
      H5Ldelete(file, path, H5P_DEFAULT);
      break;
    case 1:
      H5Lmove(file, path, file, (object.path + random.pick({"2", "x", "/x", " "})).c_str(), H5P_DEFAULT, H5P_DEFAULT);
      break;
    case 2:
      H5Ldelete(file, path, H5P_DEFAULT);
      if (random.one_in(3))
        H5Lcreate_soft(at, file, path, H5P_DEFAULT, H5P_DEFAULT);
      else if (random.one_in(2))
        H5Lcreate_external("other.h5", at, file, path, H5P_DEFAULT, H5P_DEFAULT);
      else
        H5Lcreate_hard(file, random.one_in(3) ? "/" : at, file, path, H5P_DEFAULT, H5P_DEFAULT);
      break;
    case 3:
      if (object.is_dataset) reshape(random, file, object.path);
      break;
    case 4:
      H5Ldelete(file, path, H5P_DEFAULT);
      H5Ocopy(file, at, file, path, H5P_DEFAULT, H5P_DEFAULT);
      break;
    case 5:
    case 6:
      edit_attribute(random, file, object.path);
      break;
    default:
      if (object.is_dataset) edit_dataset(random, file, object.path);
  }
}

}  // namespace

std::string edited_hdf5(Random& random, const std::string& content) {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  const std::filesystem::path path = scratch_file("edited.h5", content);
  {
    const Id access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
    H5Pset_fclose_degree(access, H5F_CLOSE_STRONG);
    const Id file(H5Fopen(path.c_str(), H5F_ACC_RDWR, access), H5Fclose);
    if (file < 0) return {};
    for (std::size_t edits = 1 + random.below(3); edits > 0; --edits) {
      std::vector<Object> objects = objects_of(file);
      std::erase_if(objects, [](const Object& object) { return object.path == "."; });
      if (objects.empty()) break;
      edit_once(random, file, objects);
    }
  }
  return content_of(path);
}

std::string mutated_archive(Random& random, const std::string& content) {
  std::string bytes = random.one_in(5) ? content : edited_hdf5(random, content);
  if (bytes == content || random.one_in(8)) bytes = mutated_bytes(random, bytes);
  if (bytes.size() < user_block_bytes || random.one_in(40)) return bytes;
  const UserBlock block = make_user_block(sha256_hex(std::string_view(bytes).substr(user_block_bytes)));
  std::copy(block.begin(), block.end(), bytes.begin());
  return bytes;
}

}  // namespace modebank::fuzz
