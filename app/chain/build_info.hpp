#pragma once

namespace modebank::build_info {

/// Origin of this program's build. A generated file defines these constants.
extern const char* const version;
extern const char* const git_revision;
extern const char* const ceres;
extern const char* const eigen;
extern const char* const hdf5;
extern const char* const boost;
extern const char* const compiler;

}  // namespace modebank::build_info
