#pragma once
/// Where the files are that come with the programs: alike in the folder of a build (bin, lib,
/// share) and in an installation.
#include <filesystem>

namespace voxtouch {

/// The folder of the running program, in which all others stand. Error:
/// std::filesystem::filesystem_error without /proc.
inline std::filesystem::path program_folder() {
  return std::filesystem::read_symlink("/proc/self/exe").parent_path();
}

/// Scenes, meshes, device files and the page of `voxtouch view`.
inline std::filesystem::path shared_folder() {
  return program_folder().parent_path() / "share" / "voxtouch";
}

/// What is loaded at run time by this program only.
inline std::filesystem::path library_folder() {
  return program_folder().parent_path() / "lib" / "voxtouch";
}

}  // namespace voxtouch
