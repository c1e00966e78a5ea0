#pragma once

#include <hdf5.h>

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace modebank::test {

/// Computes the hash of the file's present content and writes it into the user block.
void sign(const std::filesystem::path& path);

/// Changes to an archive that modebank itself never makes. They use HDF5's C API; afterwards the archive gets a valid
/// hash.
enum class Kind { real, integer, text };

void write_foreign_hdf5(const std::filesystem::path& path, unsigned long long user_block_bytes);
void patch_text_attribute(const std::filesystem::path& path, const std::string& object, const std::string& name,
                          const std::string& value);
/// Replaces one text in an attribute that is a list of texts. The new text is cut to the length of the list's texts.
void patch_text_in_list(const std::filesystem::path& path, const std::string& object, const std::string& name,
                        std::size_t index, const std::string& value);
/// Replaces the attribute by an empty list of texts.
void empty_text_attribute(const std::filesystem::path& path, const std::string& object, const std::string& name);
void remove_member(const std::filesystem::path& path, const std::string& member);
/// Removes all columns of a table except the first ones.
void keep_columns(const std::filesystem::path& path, const std::string& table, unsigned columns);
/// Replaces the member by a dataset of the declared size without stored content. All its values are zero.
void replace_by_zeros(const std::filesystem::path& path, const std::string& member,
                      const std::vector<unsigned long long>& shape, Kind kind);
/// Applies any change to the open file.
void craft(const std::filesystem::path& path, const std::function<void(hid_t file)>& change);
/// Sets one number of a dataset (`index`: row-major position), of a table's column (`index`: the row) or of an
/// attribute.
void patch_number(const std::filesystem::path& path, const std::string& dataset, std::size_t index, double value);
void patch_cell(const std::filesystem::path& path, const std::string& table, const std::string& column, std::size_t row,
                double value);
void patch_number_attribute(const std::filesystem::path& path, const std::string& object, const std::string& name,
                            double value);
/// Replaces the member by an array of `values` zeros, in chunks that were never written.
void replace_by_chunks(const std::filesystem::path& path, const std::string& member,
                       const std::vector<unsigned long long>& shape);

/// Replaces the member by a dataset of nine doubles that are stored in another file.
void replace_by_external(const std::filesystem::path& path, const std::string& member, const std::string& elsewhere);

}  // namespace modebank::test
