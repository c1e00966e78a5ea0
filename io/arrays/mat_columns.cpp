#include <fmt/format.h>
#include <fmt/ranges.h>
#include <matio.h>

#include <algorithm>
#include <boost/algorithm/string/replace.hpp>
#include <memory>

#include "io/arrays/stored_columns.hpp"
#include "modebank/base/error.hpp"

namespace modebank {

namespace {

struct CloseFile {
  void operator()(mat_t* file) const { Mat_Close(file); }
};
struct FreeVariable {
  void operator()(matvar_t* variable) const { Mat_VarFree(variable); }
};
using MatFile = std::unique_ptr<mat_t, CloseFile>;
using Variable = std::unique_ptr<matvar_t, FreeVariable>;

thread_local std::string last_reason;  ///< matio's last message in this thread

/// This is a template, because the text is `const` in matio 1.5.28.
template <class Text>
void keep_reason(int, Text* text) {
  last_reason = text;
}

/// Throws DataError with the reason that matio gives.
MatFile open_mat(const std::string& path) {
  Mat_LogInitFunc("modebank", keep_reason);
  last_reason.clear();
  MatFile file(Mat_Open(path.c_str(), MAT_ACC_RDONLY));
  if (file) return file;
  throw DataError(
      fmt::format("{}: matio cannot read this MATLAB file{}{}; in MATLAB or Octave: s = load('{}'); save plain "
                  "-struct s -v7",
                  path, last_reason.empty() ? "" : ": ", last_reason, path));
}

bool is_number(const matvar_t& v) {
  return v.class_type >= MAT_C_DOUBLE && v.class_type <= MAT_C_UINT64 && v.isComplex == 0;
}

std::string type_name(const matvar_t& v) {
  constexpr const char* names[]{"double", "single", "int8",   "uint8", "int16",
                                "uint16", "int32",  "uint32", "int64", "uint64"};
  return v.isLogical ? "logical" : names[v.class_type - MAT_C_DOUBLE];
}

/// The product of the extents. If it overflows, the largest number.
std::uint64_t elements(const matvar_t& v) {
  std::uint64_t product = v.rank > 0 && v.dims ? 1 : 0;
  for (int i = 0; product > 0 && i < v.rank; ++i)
    if (__builtin_mul_overflow(product, v.dims[i], &product)) return ~std::uint64_t{0};
  return product;
}

/// One step from a variable to a part of it: a field of a struct. In a struct array, also the index of the element.
struct MatStep {
  std::string field;
  std::size_t element = 0;
};

struct MatPlace {
  std::string variable;
  std::vector<MatStep> steps;
  std::size_t first = 0;  ///< index of the first value; the values of a column are contiguous
};

matvar_t* follow(matvar_t* v, const std::vector<MatStep>& steps) {
  for (const MatStep& step : steps) {
    if (!v || v->class_type != MAT_C_STRUCT) return nullptr;
    v = Mat_VarGetStructFieldByName(v, step.field.c_str(), step.element);
  }
  return v;
}

constexpr auto from_modelica = R"py({0} is the result of a Modelica simulator, which is not read: python3 -c "
import scipy.io, numpy as np; m = scipy.io.loadmat('{0}'); i = m['dataInfo']
assert len(i) == 4, 'binNormal: save it as binTrans'; d = i[1] * (i[0] != 1)
head = ';'.join(''.join(c).strip() for c, k in zip(zip(*m['name']), d) if k)
x = m['data_2'][abs(d[d != 0]) - 1].T * np.sign(d[d != 0])
np.savetxt('{0}.csv', x, delimiter=';', comments='', header=head)")py";

/// Lists the columns. Only the variables' headers are read.
class MatWalk {
 public:
  explicit MatWalk(const std::string& file) : file_(file) {}

  std::vector<StoredColumn> columns;
  std::vector<MatPlace> places;
  std::map<std::string, MatPlace> sample_time_places;
  std::vector<std::string> left_out;

  void variable(const matvar_t& v) {
    if (v.class_type == MAT_C_OPAQUE) return left_out.push_back(matlab_objects_without_name());
    if (!v.name) return;
    if (std::string_view(v.name) == "dataInfo") throw ConfigurationError(fmt::format(from_modelica, file_));
    part(v, "", v.name, {v.name, {}}, 0);
  }

 private:
  const std::string& file_;

  void part(const matvar_t& v, const std::string& group, const std::string& name, const MatPlace& place, int depth) {
    const std::string path = group.empty() ? name : group + "." + name;
    if (v.class_type == MAT_C_STRUCT) return fields(v, path, place, depth);
    if (v.class_type == MAT_C_OBJECT || v.class_type == MAT_C_OPAQUE)
      return left_out.push_back(matlab_object("", path, file_));
    const bool in_rows = v.rank == 2 && v.dims[0] > 1 && v.dims[1] > 10 * v.dims[0];
    if (v.class_type == MAT_C_CELL || (is_number(v) && (v.rank > 2 || in_rows))) {
      constexpr auto read = "import scipy.io; a = scipy.io.loadmat('{}', simplify_cells=True)['{}']";
      const std::string names = boost::replace_all_copy(path, ".", "']['");
      return left_out.push_back(not_a_table(path, fmt::format(read, file_, names), "a"));
    }
    if (!is_number(v)) return;
    if (name == "Ts" && elements(v) == 1) sample_time_places[group] = place;
    if (v.rank != 2 || elements(v) < 2) return;
    const std::size_t rows = v.dims[0], wide = v.dims[1];
    const bool vector = rows == 1 || wide == 1;
    const std::size_t length = vector ? rows * wide : rows,
                      count = vector ? 1 : std::min(wide, std::size_t{most_columns});
    for (std::size_t j = 0; j < count; ++j) {
      StoredColumn column{group, vector ? name : fmt::format("{}[{}]", name, j), type_name(v), "", length};
      column.whole = v.class_type >= MAT_C_INT8 && !v.isLogical;
      columns.push_back(std::move(column));
      places.push_back(place);
      places.back().first = j * length;
    }
  }

  void fields(const matvar_t& v, const std::string& path, const MatPlace& place, int depth) {
    const std::uint64_t count = elements(v);
    const unsigned field_count = Mat_VarGetNumberOfFields(const_cast<matvar_t*>(&v));
    if (depth > deepest_group || count == 0 || count > most_columns || field_count > most_columns) return;
    char* const* names = Mat_VarGetStructFieldnames(&v);
    if (!names || !v.data) return;
    for (std::size_t e = 0; e < count; ++e)
      for (unsigned f = 0; f < field_count; ++f) {
        const matvar_t* field = Mat_VarGetStructFieldByIndex(const_cast<matvar_t*>(&v), f, e);
        if (!field || !names[f]) continue;
        MatPlace inner = place;
        inner.steps.push_back({names[f], e});
        part(*field, count == 1 ? path : fmt::format("{}[{}]", path, e), names[f], inner, depth + 1);
      }
  }
};

class MatColumns : public ColumnStore {
 public:
  explicit MatColumns(const std::filesystem::path& path) : path_(path.string()) {
    MatWalk walk(path_);
    const MatFile file = open_mat(path_);
    for (Variable v(Mat_VarReadNextInfo(file.get())); v; v.reset(Mat_VarReadNextInfo(file.get()))) walk.variable(*v);
    columns_ = std::move(walk.columns);
    places_ = std::move(walk.places);
    left_out_ = std::move(walk.left_out);
    if (columns_.empty())
      throw ConfigurationError(fmt::format("{}: no column has numbers in two rows or more{}{}", path_,
                                           left_out_.empty() ? "" : "; ", fmt::join(left_out_, "; ")));
    std::map<std::string, double> sample_time;
    for (const auto& [group, place] : walk.sample_time_places)
      sample_time[group] = values_at<double>(place, 1, "Ts")[0];
    add_sample_times(columns_, sample_time);
  }

  const std::vector<StoredColumn>& columns() const override { return columns_; }
  const std::vector<std::string>& left_out() const override { return left_out_; }

  std::vector<double> numbers(std::size_t column) const override { return read<double>(column); }
  std::vector<std::int64_t> whole_numbers(std::size_t column) const override { return read<std::int64_t>(column); }
  std::vector<std::string> texts(std::size_t column) const override {
    throw DataError(fmt::format("{}: column {} is not text", path_, columns_.at(column).path()));
  }

 private:
  std::string path_;
  std::vector<StoredColumn> columns_;
  std::vector<MatPlace> places_;
  std::vector<std::string> left_out_;

  /// Whether all declared elements were read. A damaged file may declare more elements than it contains.
  static bool holds(const matvar_t& part, std::uint64_t count) {
    return part.data && part.data_size > 0 && part.nbytes / static_cast<std::size_t>(part.data_size) >= count;
  }

  template <class T>
  std::vector<T> read(std::size_t column) const {
    return values_at<T>(places_.at(column), static_cast<std::size_t>(columns_[column].rows), columns_[column].path());
  }

  template <class T>
  std::vector<T> values_at(const MatPlace& place, std::size_t rows, const std::string& name) const {
    const MatFile file = open_mat(path_);
    const Variable v(Mat_VarRead(file.get(), place.variable.c_str()));
    const matvar_t* part = v ? follow(v.get(), place.steps) : nullptr;
    if (!part || !is_number(*part) || elements(*part) < place.first + rows || !holds(*part, place.first + rows))
      throw DataError(fmt::format("{}: column {}: matio returned fewer values than the file declares{}{}", path_, name,
                                  last_reason.empty() ? "" : ": ", last_reason));
    return converted<T>(*part, place.first, rows);
  }

  template <class T, class Stored>
  static std::vector<T> cast(const matvar_t& v, std::size_t first, std::size_t rows) {
    const auto* values = static_cast<const Stored*>(v.data) + first;
    std::vector<T> result(rows);
    std::transform(values, values + rows, result.begin(), [](Stored value) { return static_cast<T>(value); });
    return result;
  }

  template <class T>
  static std::vector<T> converted(const matvar_t& v, std::size_t first, std::size_t rows) {
    switch (v.class_type) {
      case MAT_C_DOUBLE:
        return cast<T, double>(v, first, rows);
      case MAT_C_SINGLE:
        return cast<T, float>(v, first, rows);
      case MAT_C_INT8:
        return cast<T, std::int8_t>(v, first, rows);
      case MAT_C_UINT8:
        return cast<T, std::uint8_t>(v, first, rows);
      case MAT_C_INT16:
        return cast<T, std::int16_t>(v, first, rows);
      case MAT_C_UINT16:
        return cast<T, std::uint16_t>(v, first, rows);
      case MAT_C_INT32:
        return cast<T, std::int32_t>(v, first, rows);
      case MAT_C_UINT32:
        return cast<T, std::uint32_t>(v, first, rows);
      case MAT_C_INT64:
        return cast<T, std::int64_t>(v, first, rows);
      default:
        return cast<T, std::uint64_t>(v, first, rows);
    }
  }
};

}  // namespace

std::unique_ptr<ColumnStore> open_mat_columns(const std::filesystem::path& path) {
  return std::make_unique<MatColumns>(path);
}

}  // namespace modebank
