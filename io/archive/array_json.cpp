#include "io/archive/array_json.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>
#include <vector>

namespace modebank::hdf5 {

namespace {

using nlohmann::json;

json value_at(hid_t type, const char* bytes);

template <class T>
T number_at(const char* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof value);
  return value;
}

json integer_at(hid_t type, const char* bytes) {
  const bool is_signed = H5Tget_sign(type) == H5T_SGN_2;
  switch (H5Tget_size(type)) {
    case 1:
      return is_signed ? json(number_at<std::int8_t>(bytes)) : json(number_at<std::uint8_t>(bytes));
    case 2:
      return is_signed ? json(number_at<std::int16_t>(bytes)) : json(number_at<std::uint16_t>(bytes));
    case 4:
      return is_signed ? json(number_at<std::int32_t>(bytes)) : json(number_at<std::uint32_t>(bytes));
    case 8:
      return is_signed ? json(number_at<std::int64_t>(bytes)) : json(number_at<std::uint64_t>(bytes));
    default:
      return nullptr;
  }
}

json real_at(hid_t type, const char* bytes) {
  const std::size_t size = H5Tget_size(type);
  double value = NAN;
  if (size == sizeof(float)) value = static_cast<double>(number_at<float>(bytes));
  if (size == sizeof(double)) value = number_at<double>(bytes);
  if (size == sizeof(long double)) value = static_cast<double>(number_at<long double>(bytes));
  return std::isfinite(value) ? json(value) : json(nullptr);
}

json text_at(hid_t type, const char* bytes) {
  if (H5Tis_variable_str(type) != 0) return nullptr;  // archives contain no values of this type
  std::string text(bytes, H5Tget_size(type));
  const char padding = H5Tget_strpad(type) == H5T_STR_SPACEPAD ? ' ' : '\0';
  if (H5Tget_strpad(type) == H5T_STR_NULLTERM) text.resize(std::min(text.size(), text.find('\0')));
  text.resize(text.find_last_not_of(padding) + 1);
  return text_json(text);
}

std::string column_name(hid_t type, unsigned i) {
  char* name = H5Tget_member_name(type, i);
  const std::string key = name ? name : "";
  H5free_memory(name);
  return text_json(key).get<std::string>();
}

json row_at(hid_t type, const char* bytes) {
  json row = json::object();
  const int members = H5Tget_nmembers(type);
  for (unsigned i = 0; static_cast<int>(i) < members; ++i) {
    const Handle member(H5Tget_member_type(type, i), H5Tclose, "read a column's type");
    row[column_name(type, i)] = value_at(member.id(), bytes + H5Tget_member_offset(type, i));
  }
  return row;
}

/// JSON of contiguous values of one type. The lists are nested by the extents from `dimension` on.
json nested(hid_t type, const Shape& shape, std::size_t dimension, const char* bytes) {
  if (dimension == shape.size()) return value_at(type, bytes);
  const std::size_t stride =
      H5Tget_size(type) * element_count(Shape(shape.begin() + static_cast<std::ptrdiff_t>(dimension) + 1, shape.end()));
  json list = json::array();
  // If an extent is 0, there are no elements and later extents may be invalid.
  const hsize_t extent = element_count(shape) == 0 && stride == 0 ? 0 : shape[dimension];
  for (hsize_t i = 0; i < extent; ++i) list.push_back(nested(type, shape, dimension + 1, bytes + i * stride));
  return list;
}

json list_at(hid_t type, const char* bytes) {
  const Handle element(H5Tget_super(type), H5Tclose, "read an array type");
  Shape shape(static_cast<std::size_t>(std::max(H5Tget_array_ndims(type), 0)));
  check(H5Tget_array_dims2(type, shape.data()), "read an array type");
  return nested(element.id(), shape, 0, bytes);
}

json value_at(hid_t type, const char* bytes) {
  switch (H5Tget_class(type)) {
    case H5T_INTEGER:
      return integer_at(type, bytes);
    case H5T_FLOAT:
      return real_at(type, bytes);
    case H5T_STRING:
      return text_at(type, bytes);
    case H5T_COMPOUND:
      return row_at(type, bytes);
    case H5T_ARRAY:
      return list_at(type, bytes);
    case H5T_ENUM: {
      const Handle base(H5Tget_super(type), H5Tclose, "read an enumeration");
      return integer_at(base.id(), bytes);
    }
    default:
      return nullptr;
  }
}

}  // namespace

json text_json(const std::string& text) {
  return json::parse(json(text).dump(-1, ' ', false, json::error_handler_t::replace));
}

std::vector<std::string> column_names(const StoredArray& table) {
  std::vector<std::string> names;
  const int members = H5Tget_nmembers(table.type());
  for (unsigned i = 0; static_cast<int>(i) < members; ++i) names.push_back(column_name(table.type(), i));
  return names;
}

json to_json(const StoredArray& array) {
  const Handle type(H5Tget_native_type(array.type(), H5T_DIR_ASCEND), H5Tclose, "find a type in memory");
  std::vector<char> bytes(static_cast<std::size_t>(array.elements()) * H5Tget_size(type.id()));
  array.read(type.id(), bytes.data());
  if (array.elements() == 0 && array.shape().empty()) return nullptr;
  return nested(type.id(), array.shape(), 0, bytes.data());
}

json to_json(const StoredArray& array, const Rows& rows) {
  const Handle type(H5Tget_native_type(array.type(), H5T_DIR_ASCEND), H5Tclose, "find a type in memory");
  Shape shape = array.shape();
  shape.front() = rows.count;
  std::vector<char> bytes(static_cast<std::size_t>(element_count(shape)) * H5Tget_size(type.id()));
  array.read_rows(rows, type.id(), bytes.data());
  return nested(type.id(), shape, 0, bytes.data());
}

}  // namespace modebank::hdf5
