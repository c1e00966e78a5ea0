// Files of arrays: MATLAB's of versions 4 to 7.3, plain HDF5 and pandas'.
#include <hdf5.h>
#include <zlib.h>

#include <cstring>

#include "tests/fuzz/mutate.hpp"
#include "tests/fuzz/read_table.hpp"
#include "tests/fuzz/scratch.hpp"
#include "tests/fuzz/target.hpp"
#include "tests/io/arrays/mat_writer.hpp"
#include "tests/support/paths.hpp"

namespace modebank::fuzz {

namespace {

using test::MatWriter;

std::string written(mat_ft version, matio_compression compression, int kind) {
  const std::filesystem::path path = scratch("seed.mat");
  std::filesystem::remove(path);
  {
    MatWriter file(path, version, compression);
    if (kind == 0 || kind == 2) {
      file.write(MatWriter::matrix("t", {0, 0.5, 1, 1.5}, 4));
      file.write(MatWriter::matrix("pose", {1, 2, 3, 4, 5, 6, 7, 8}, 4));
      file.write(MatWriter::whole("stamp", {1'700'000'000'000'000'001, 1'700'000'000'500'000'002}));
    }
    if (kind == 1 || kind == 2) {
      matvar_t* imu = MatWriter::structure(
          "imu", {"t", "wz"}, {{MatWriter::matrix("t", {0, 1, 2}, 3), MatWriter::matrix("wz", {0.1, 0.2, 0.3}, 3)}});
      file.write(MatWriter::structure("log", {"imu", "v"}, {{imu, MatWriter::matrix("v", {4, 5, 6}, 3)}}));
      const auto signal = [](const char* label) {
        return std::vector<matvar_t*>{MatWriter::matrix("values", {1, 2, 3}, 3), MatWriter::text("label", label)};
      };
      matvar_t* signals = MatWriter::structure("signals", {"values", "label"}, {signal("speed"), signal("pose")});
      file.write(
          MatWriter::structure("scope", {"time", "signals"}, {{MatWriter::matrix("time", {0, 1, 2}, 3), signals}}));
    }
  }
  return content_of(path);
}

template <class T>
T number_at(const std::string& bytes, std::size_t at) {
  T value{};
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

void put_number(std::string& bytes, std::size_t at, std::uint32_t value) {
  std::memcpy(bytes.data() + at, &value, sizeof value);
}

constexpr std::size_t mat_header_bytes = 128, tag_bytes = 8;
constexpr std::uint32_t mat_matrix = 14, mat_compressed = 15;

/// Where the elements of a file of versions 6 and 7 begin, those inside matrices too.
void find_tags(const std::string& bytes, std::size_t begin, std::size_t end, std::vector<std::size_t>& tags) {
  for (std::size_t at = begin; at + tag_bytes <= end;) {
    const auto type = number_at<std::uint32_t>(bytes, at);
    tags.push_back(at);
    if (type >> 16 != 0) {  // a small element: its data are in the tag
      at += tag_bytes;
      continue;
    }
    const std::size_t data = at + tag_bytes, count = number_at<std::uint32_t>(bytes, at + 4);
    if (count > end - data) return;
    if (type == mat_matrix) find_tags(bytes, data, data + count, tags);
    at = data + (count + 7) / 8 * 8;
  }
}

std::string deflated(const std::string& content) {
  uLongf bytes = compressBound(content.size());
  std::string packed(bytes, '\0');
  compress(reinterpret_cast<Bytef*>(packed.data()), &bytes, reinterpret_cast<const Bytef*>(content.data()),
           content.size());
  packed.resize(bytes);
  return packed;
}

/// Packs the outermost elements, as version 7 has them.
std::string packed_elements(const std::string& bytes) {
  std::string result = bytes.substr(0, mat_header_bytes);
  for (std::size_t at = mat_header_bytes; at + tag_bytes <= bytes.size();) {
    const std::size_t count =
        std::min<std::size_t>(number_at<std::uint32_t>(bytes, at + 4), bytes.size() - at - tag_bytes);
    const std::string content = deflated(bytes.substr(at, tag_bytes + count));
    std::string tag(tag_bytes, '\0');
    put_number(tag, 0, mat_compressed);
    put_number(tag, 4, static_cast<std::uint32_t>(content.size()));
    result += tag + content;
    at += tag_bytes + count;
  }
  return result;
}

void change_tag(Random& random, std::string& bytes) {
  std::vector<std::size_t> tags;
  find_tags(bytes, mat_header_bytes, bytes.size(), tags);
  if (tags.empty()) return;
  const std::size_t at = random.pick(tags);
  const std::size_t data = std::min(at + tag_bytes, bytes.size());
  switch (random.below(4)) {
    case 0:
      put_number(bytes, at, static_cast<std::uint32_t>(random.below(20)));
      break;
    case 1:
      put_number(bytes, at + 4, static_cast<std::uint32_t>(odd_whole(random)));
      break;
    case 2:
      put_number(bytes, at + 4,
                 static_cast<std::uint32_t>(number_at<std::uint32_t>(bytes, at + 4) + random.below(17) - 8));
      break;
    default: {
      const std::size_t count = std::min<std::size_t>(64, bytes.size() - data);
      bytes.replace(data, count, mutated_bytes(random, bytes.substr(data, count)).substr(0, count));
    }
  }
}

std::string mat5(Random& random) {
  static const std::vector<std::string> seeds{written(MAT_FT_MAT5, MAT_COMPRESSION_NONE, 0),
                                              written(MAT_FT_MAT5, MAT_COMPRESSION_NONE, 1)};
  std::string bytes = random.pick(seeds);
  for (std::size_t changes = random.below(5); changes > 0; --changes) change_tag(random, bytes);
  if (random.one_in(2)) bytes = packed_elements(bytes);
  return random.one_in(3) ? mutated_bytes(random, bytes) : bytes;
}

/// Version 4: type, rows, columns, whether complex, length of the name, then name and values.
std::string mat4(Random& random) {
  std::string bytes;
  for (std::size_t variables = 1 + random.below(3); variables > 0; --variables) {
    const std::string name =
        random.pick({std::string("t"), std::string("x"), std::string("pose"), std::string("a.b")}) + '\0';
    const auto odd = [&](std::uint32_t value) {
      return random.one_in(12) ? static_cast<std::uint32_t>(odd_whole(random)) : value;
    };
    const auto rows = static_cast<std::uint32_t>(random.below(6)),
               columns = static_cast<std::uint32_t>(1 + random.below(2));
    const std::uint32_t head[5]{odd(random.pick({0u, 10u, 20u, 30u, 50u, 1u, 1000u})), odd(rows), odd(columns),
                                odd(random.one_in(9) ? 1 : 0), odd(static_cast<std::uint32_t>(name.size()))};
    bytes.append(reinterpret_cast<const char*>(head), sizeof head).append(name);
    for (std::uint32_t k = 0; k < rows * columns; ++k) {
      const double value = random.one_in(9) ? odd_double(random) : static_cast<double>(k);
      bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
    }
  }
  return random.one_in(2) ? mutated_bytes(random, bytes) : bytes;
}

/// Groups with datasets of several kinds and layouts.
std::string plain_hdf5() {
  const std::filesystem::path path = scratch("seed.h5");
  const hid_t file = H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  const hid_t group = H5Gcreate2(file, "imu", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  const auto dataset = [&](const char* name, hid_t type, std::vector<hsize_t> shape, bool packed) {
    const hid_t space = H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr),
                creation = H5Pcreate(H5P_DATASET_CREATE);
    if (packed) {
      H5Pset_chunk(creation, static_cast<int>(shape.size()), shape.data());
      H5Pset_shuffle(creation);
      H5Pset_deflate(creation, 6);
    }
    const hid_t data = H5Dcreate2(group, name, type, space, H5P_DEFAULT, creation, H5P_DEFAULT);
    const std::vector<double> values{0, 0.5, 1, 1.5, 2, 2.5, 3, 3.5, 4, 4.5};
    H5Dwrite(data, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
    H5Dclose(data);
    H5Pclose(creation);
    H5Sclose(space);
  };
  dataset("t", H5T_IEEE_F64LE, {5}, false);
  dataset("gyro", H5T_IEEE_F32BE, {5, 2}, true);
  dataset("across", H5T_STD_I16LE, {2, 5}, false);
  dataset("count", H5T_STD_U64LE, {5}, true);
  H5Gclose(group);
  H5Fclose(file);
  return content_of(path);
}

std::string hdf5_log(Random& random) {
  static const std::vector<std::string> seeds = [] {
    std::vector<std::string> all{plain_hdf5(), plain_hdf5(), written(MAT_FT_MAT73, MAT_COMPRESSION_NONE, 2),
                                 written(MAT_FT_MAT73, MAT_COMPRESSION_ZLIB, 2)};
    for (const char* name :
         {"pandas_fixed.h5", "pandas_table.h5", "pandas_columns.h5", "pandas_stamped.h5", "pandas_blosc.h5"})
      all.push_back(content_of(test::golden_dir() / name));
    return all;
  }();
  return random.pick(seeds);  // unchanged: libhdf5 decodes these bytes, and a damaged file may end the program
}

constexpr char mat_name[] = "fuzz.mat", h5_name[] = "fuzz.h5";

}  // namespace

std::vector<Target> array_targets() {
  constexpr std::uint64_t inputs = 100'000;
  return {{"mat4", inputs, mat4, read_as_file<mat_name>},
          {"mat5", inputs, mat5, read_as_file<mat_name>},
          {"hdf5", inputs, hdf5_log, read_as_file<h5_name>}};
}

}  // namespace modebank::fuzz
