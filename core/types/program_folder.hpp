#pragma once
/// Folders of the files that come with the programs, in a build (bin, lib, share) and in an
/// installation.
#include <filesystem>

namespace voxtouch {

/// The folder of the running program, from which the others are found. Throws
/// std::filesystem::filesystem_error without /proc.
inline std::filesystem::path program_folder() {
  return std::filesystem::read_symlink("/proc/self/exe").parent_path();
}

/// Scenes, meshes, device files and the page of `voxtouch view`.
inline std::filesystem::path shared_folder() {
  return program_folder().parent_path() / "share" / "voxtouch";
}

/// Libraries that only these programs load at run time.
inline std::filesystem::path library_folder() {
  return program_folder().parent_path() / "lib" / "voxtouch";
}

}  // namespace voxtouch
