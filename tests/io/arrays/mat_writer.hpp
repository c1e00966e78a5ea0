#pragma once

#include <matio.h>

#include <array>
#include <filesystem>
#include <string>
#include <vector>

namespace modebank::test {

/// Writes MATLAB files of any version with libmatio.
class MatWriter {
 public:
  MatWriter(const std::filesystem::path& path, mat_ft version, matio_compression compression = MAT_COMPRESSION_ZLIB)
      : file_(Mat_CreateVer(path.c_str(), nullptr, version)), compression_(compression) {}
  ~MatWriter() { Mat_Close(file_); }
  MatWriter(const MatWriter&) = delete;
  MatWriter& operator=(const MatWriter&) = delete;

  /// A matrix, given as its columns one after another.
  static matvar_t* matrix(const char* name, std::vector<double> values, std::size_t rows) {
    std::array<std::size_t, 2> shape{rows, values.size() / rows};
    return Mat_VarCreate(name, MAT_C_DOUBLE, MAT_T_DOUBLE, 2, shape.data(), values.data(), 0);
  }
  static matvar_t* whole(const char* name, std::vector<std::int64_t> values) {
    std::array<std::size_t, 2> shape{values.size(), 1};
    return Mat_VarCreate(name, MAT_C_INT64, MAT_T_INT64, 2, shape.data(), values.data(), 0);
  }
  static matvar_t* text(const char* name, std::string value) {
    std::array<std::size_t, 2> shape{1, value.size()};
    return Mat_VarCreate(name, MAT_C_CHAR, MAT_T_UTF8, 2, shape.data(), value.data(), 0);
  }
  /// `elements`: the fields of each struct in the array.
  static matvar_t* structure(const char* name, std::vector<const char*> fields,
                             const std::vector<std::vector<matvar_t*>>& elements) {
    std::array<std::size_t, 2> shape{1, elements.size()};
    matvar_t* result = Mat_VarCreateStruct(name, 2, shape.data(), fields.data(), static_cast<unsigned>(fields.size()));
    for (std::size_t e = 0; e < elements.size(); ++e)
      for (std::size_t f = 0; f < fields.size(); ++f) Mat_VarSetStructFieldByName(result, fields[f], e, elements[e][f]);
    return result;
  }
  void write(matvar_t* variable) {
    Mat_VarWrite(file_, variable, compression_);
    Mat_VarFree(variable);
  }

 private:
  mat_t* file_;
  matio_compression compression_;
};

}  // namespace modebank::test
