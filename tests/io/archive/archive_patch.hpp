#pragma once

#include <hdf5.h>

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace modebank::test {

/// Makes the user block hold the hash of what the file now contains.
void sign(const std::filesystem::path& path);

/// Changes to an archive that only another program would make, by the HDF5 C API, signed afterwards.
enum class Kind { real, integer, text };

void write_foreign_hdf5(const std::filesystem::path& path, unsigned long long user_block_bytes);
void patch_text_attribute(const std::filesystem::path& path, const std::string& object, const std::string& name,
                          const std::string& value);
/// One text of an attribute that is a list of them, cut to their length.
void patch_text_in_list(const std::filesystem::path& path, const std::string& object, const std::string& name,
                        std::size_t index, const std::string& value);
/// The attribute becomes a list of no texts.
void empty_text_attribute(const std::filesystem::path& path, const std::string& object, const std::string& name);
void remove_member(const std::filesystem::path& path, const std::string& member);
/// The table keeps its first columns only.
void keep_columns(const std::filesystem::path& path, const std::string& table, unsigned columns);
/// The member becomes a dataset without stored content: as large as declared, all zeros.
void replace_by_zeros(const std::filesystem::path& path, const std::string& member,
                      const std::vector<unsigned long long>& shape, Kind kind);
/// Any change to the open file.
void craft(const std::filesystem::path& path, const std::function<void(hid_t file)>& change);
/// One number of a dataset (`index` in row-major order), of a table's column (`index`: the row) or of an attribute.
void patch_number(const std::filesystem::path& path, const std::string& dataset, std::size_t index, double value);
void patch_cell(const std::filesystem::path& path, const std::string& table, const std::string& column, std::size_t row,
                double value);
void patch_number_attribute(const std::filesystem::path& path, const std::string& object, const std::string& name,
                            double value);
/// The member becomes a link to the root of another file, or to another place in this one.
void link_to_file(const std::filesystem::path& path, const std::string& member, const std::string& file);
void link_to_place(const std::filesystem::path& path, const std::string& member, const std::string& place, bool hard);

/// The member becomes an array of as many values, all zero, in chunks that nobody wrote.
void replace_by_chunks(const std::filesystem::path& path, const std::string& member,
                       const std::vector<unsigned long long>& shape);

/// The member becomes nine doubles that lie in another file.
void replace_by_external(const std::filesystem::path& path, const std::string& member, const std::string& elsewhere);

}  // namespace modebank::test
