#include "tests/io/archive/archive_patch.hpp"

#include <hdf5.h>

#include <stdexcept>

#include "io/archive/bank/open_archive.hpp"
#include "io/files/read_file.hpp"
#include "io/files/sha256.hpp"
#include "tests/support/paths.hpp"

namespace modebank::test {

namespace {

hid_t must(hid_t id) {
  if (id < 0) throw std::runtime_error("HDF5 refuses the test's change");
  return id;
}

hid_t open_for_change(const std::filesystem::path& path) {
  return must(H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT));
}

hid_t type_of(Kind kind) {
  if (kind == Kind::real) return H5T_IEEE_F64LE;
  return kind == Kind::integer ? H5T_STD_I32LE : H5T_C_S1;
}

void replace(const std::filesystem::path& path, const std::string& member, Kind kind,
             const std::vector<unsigned long long>& shape, hid_t creation) {
  const hid_t file = open_for_change(path);
  must(H5Ldelete(file, member.c_str(), H5P_DEFAULT));
  const std::vector<hsize_t> extents(shape.begin(), shape.end());
  const hid_t space = must(H5Screate_simple(static_cast<int>(extents.size()), extents.data(), nullptr));
  H5Dclose(must(H5Dcreate2(file, member.c_str(), type_of(kind), space, H5P_DEFAULT, creation, H5P_DEFAULT)));
  H5Sclose(space);
  must(H5Fclose(file));
}

}  // namespace

void sign(const std::filesystem::path& path) {
  const std::string bytes = read_file(path);
  const std::string content = bytes.substr(user_block_bytes);
  const UserBlock block = make_user_block(sha256_hex(content));
  write_file(path, std::string(block.data(), block.size()) + content);
}

void write_foreign_hdf5(const std::filesystem::path& path, unsigned long long user_block_bytes) {
  const hid_t creation = must(H5Pcreate(H5P_FILE_CREATE));
  must(H5Pset_userblock(creation, user_block_bytes));
  const hid_t file = must(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, creation, H5P_DEFAULT));
  H5Gclose(must(H5Gcreate2(file, "somewhere", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT)));
  must(H5Fclose(file));
  H5Pclose(creation);
}

namespace {

/// `space`: the attribute's dataspace, which this function closes.
void replace_attribute(const std::filesystem::path& path, const std::string& object, const std::string& name,
                       const std::string& value, hid_t space) {
  const hid_t file = open_for_change(path);
  const hid_t holder = must(H5Oopen(file, object.c_str(), H5P_DEFAULT));
  must(H5Adelete(holder, name.c_str()));
  const hid_t type = must(H5Tcopy(H5T_C_S1));
  must(H5Tset_size(type, value.size()));
  const hid_t attribute = must(H5Acreate2(holder, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT));
  must(H5Awrite(attribute, type, value.data()));
  H5Aclose(attribute);
  H5Sclose(space);
  H5Tclose(type);
  H5Oclose(holder);
  must(H5Fclose(file));
  sign(path);
}

}  // namespace

void patch_text_attribute(const std::filesystem::path& path, const std::string& object, const std::string& name,
                          const std::string& value) {
  replace_attribute(path, object, name, value, must(H5Screate(H5S_SCALAR)));
}

void empty_text_attribute(const std::filesystem::path& path, const std::string& object, const std::string& name) {
  const hsize_t none = 0;
  replace_attribute(path, object, name, "x", must(H5Screate_simple(1, &none, nullptr)));
}

void remove_member(const std::filesystem::path& path, const std::string& member) {
  const hid_t file = open_for_change(path);
  must(H5Ldelete(file, member.c_str(), H5P_DEFAULT));
  must(H5Fclose(file));
  sign(path);
}

void keep_columns(const std::filesystem::path& path, const std::string& table, unsigned columns) {
  const hid_t file = open_for_change(path);
  const hid_t old = must(H5Dopen2(file, table.c_str(), H5P_DEFAULT));
  const hid_t whole = must(H5Dget_type(old)), space = must(H5Dget_space(old));
  const hid_t kept = must(H5Tcreate(H5T_COMPOUND, H5Tget_member_offset(whole, columns)));
  for (unsigned i = 0; i < columns; ++i) {
    char* const name = H5Tget_member_name(whole, i);
    const hid_t member = must(H5Tget_member_type(whole, i));
    must(H5Tinsert(kept, name, H5Tget_member_offset(whole, i), member));
    H5Tclose(member);
    H5free_memory(name);
  }
  std::vector<char> rows(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)) * H5Tget_size(kept));
  must(H5Dread(old, kept, H5S_ALL, H5S_ALL, H5P_DEFAULT, rows.data()));
  H5Dclose(old);
  must(H5Ldelete(file, table.c_str(), H5P_DEFAULT));
  const hid_t shorter = must(H5Dcreate2(file, table.c_str(), kept, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
  must(H5Dwrite(shorter, kept, H5S_ALL, H5S_ALL, H5P_DEFAULT, rows.data()));
  H5Dclose(shorter);
  for (const hid_t type : {kept, whole}) H5Tclose(type);
  H5Sclose(space);
  must(H5Fclose(file));
  sign(path);
}

void replace_by_zeros(const std::filesystem::path& path, const std::string& member,
                      const std::vector<unsigned long long>& shape, Kind kind) {
  const hid_t creation = must(H5Pcreate(H5P_DATASET_CREATE));
  // Chunks that were never written take no space, whatever the declared shape is.
  must(H5Pset_alloc_time(creation, H5D_ALLOC_TIME_LATE));
  replace(path, member, kind, shape, creation);
  H5Pclose(creation);
  sign(path);
}

void patch_text_in_list(const std::filesystem::path& path, const std::string& object, const std::string& name,
                        std::size_t index, const std::string& value) {
  craft(path, [&](hid_t file) {
    const hid_t attribute = must(H5Aopen_by_name(file, object.c_str(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT));
    const hid_t type = must(H5Aget_type(attribute)), space = must(H5Aget_space(attribute));
    const std::size_t bytes = H5Tget_size(type);
    std::string texts(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)) * bytes, '\0');
    must(H5Aread(attribute, type, texts.data()));
    std::string text = value.substr(0, bytes);
    text.resize(bytes, '\0');
    texts.replace(index * bytes, bytes, text);
    H5Aclose(attribute);
    must(H5Adelete_by_name(file, object.c_str(), name.c_str(),
                           H5P_DEFAULT));  // HDF5 cannot overwrite an attribute of an object that has many attributes
    const hid_t made =
        must(H5Acreate_by_name(file, object.c_str(), name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
    must(H5Awrite(made, type, texts.data()));
    H5Aclose(made);
    H5Tclose(type);
    H5Sclose(space);
  });
}

void replace_by_chunks(const std::filesystem::path& path, const std::string& member,
                       const std::vector<unsigned long long>& shape) {
  const hid_t creation = must(H5Pcreate(H5P_DATASET_CREATE));
  const std::vector<hsize_t> chunk(shape.size(), 1);
  must(H5Pset_chunk(creation, static_cast<int>(chunk.size()), chunk.data()));
  replace(path, member, Kind::real, shape, creation);
  H5Pclose(creation);
  sign(path);
}

void replace_by_external(const std::filesystem::path& path, const std::string& member, const std::string& elsewhere) {
  const hid_t creation = must(H5Pcreate(H5P_DATASET_CREATE));
  must(H5Pset_external(creation, elsewhere.c_str(), 0, H5F_UNLIMITED));
  replace(path, member, Kind::real, {9}, creation);
  H5Pclose(creation);
  sign(path);
}

void craft(const std::filesystem::path& path, const std::function<void(hid_t file)>& change) {
  const hid_t file = open_for_change(path);
  change(file);
  must(H5Fclose(file));
  sign(path);
}

namespace {

/// Changes one element of a dataset. The element is read and written as `type`.
void patch_element(hid_t file, const std::string& dataset, hid_t type, std::size_t index, double value) {
  const hid_t data = must(H5Dopen2(file, dataset.c_str(), H5P_DEFAULT)), space = must(H5Dget_space(data));
  std::vector<double> values(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)));
  must(H5Dread(data, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()));
  values.at(index) = value;
  must(H5Dwrite(data, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()));
  H5Sclose(space);
  H5Dclose(data);
}

}  // namespace

void patch_number(const std::filesystem::path& path, const std::string& dataset, std::size_t index, double value) {
  craft(path, [&](hid_t file) { patch_element(file, dataset, H5T_NATIVE_DOUBLE, index, value); });
}

void patch_cell(const std::filesystem::path& path, const std::string& table, const std::string& column, std::size_t row,
                double value) {
  craft(path, [&](hid_t file) {
    const hid_t cell = must(H5Tcreate(H5T_COMPOUND, sizeof(double)));
    must(H5Tinsert(cell, column.c_str(), 0, H5T_NATIVE_DOUBLE));
    patch_element(file, table, cell, row, value);
    H5Tclose(cell);
  });
}

void patch_number_attribute(const std::filesystem::path& path, const std::string& object, const std::string& name,
                            double value) {
  craft(path, [&](hid_t file) {
    // Deletes and recreates the attribute, because HDF5 1.10 cannot find attributes in dense storage for writing.
    const hid_t holder = must(H5Oopen(file, object.c_str(), H5P_DEFAULT));
    const hid_t old = must(H5Aopen(holder, name.c_str(), H5P_DEFAULT)), type = must(H5Aget_type(old));
    H5Aclose(old);
    must(H5Adelete(holder, name.c_str()));
    const hid_t space = must(H5Screate(H5S_SCALAR));
    const hid_t attribute = must(H5Acreate2(holder, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT));
    must(H5Awrite(attribute, H5T_NATIVE_DOUBLE, &value));
    H5Aclose(attribute);
    H5Sclose(space);
    H5Tclose(type);
    H5Oclose(holder);
  });
}

}  // namespace modebank::test
