#include "core/mesh/mesh_bytes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <system_error>

namespace voxtouch::mesh {

void import::refuse(const std::filesystem::path& path, const std::string& reason,
                    const std::string& remedy) {
  throw MeshError("mesh '" + path.string() + "': " + reason + "; " + remedy);
}

std::string import::extension_of(const std::filesystem::path& path) {
  std::string e = path.extension().string();
  if (!e.empty())
    e.erase(0, 1);
  for (char& c : e)
    c = (c >= 'A' && c <= 'Z') ? static_cast<char>(c - 'A' + 'a') : c;
  return e;
}

bool names_mesh(const std::filesystem::path& path) {
  constexpr std::array kExtensions{"obj", "stl", "ply", "gltf", "glb", "dae"};
  return std::ranges::find(kExtensions, import::extension_of(path)) != kExtensions.end();
}

namespace {

using import::refuse;

/// Size of the file, which is there and not too large.
std::uintmax_t size_of(const std::filesystem::path& path, std::uintmax_t most) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  using Type = std::filesystem::file_type;
  switch (status.type()) {
    case Type::regular:
      break;
    case Type::not_found:
      refuse(path, "file not found", "check the path (relative to the scene file's folder)");
    case Type::directory:
      refuse(path, "is a directory", "choose a mesh file");
    case Type::none:
      refuse(path, error.message(), "check the permissions of its folders");
    default:
      refuse(path, "is not a regular file", "choose a mesh file");
  }
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (error)
    refuse(path, error.message(), "check the file");
  if (size == 0)
    refuse(path, "is empty", "export the mesh again");
  if (size > most)
    refuse(path, fmt::format("has {} bytes, limit {}", size, most), "reduce the mesh");
  return size;
}

}  // namespace

std::string read_mesh_bytes(const std::filesystem::path& path, std::uintmax_t most) {
  const std::uintmax_t size = size_of(path, most);
  errno = 0;
  std::ifstream in(path, std::ios::binary);
  if (!in)
    refuse(path, std::string("cannot be opened (") + std::strerror(errno) + ")",
           "check its permissions");
  std::string bytes(size, '\0');
  in.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (static_cast<std::size_t>(in.gcount()) != bytes.size() ||
      in.peek() != std::ifstream::traits_type::eof())
    refuse(path, "changed during reading", "repeat when no program writes to it");
  return bytes;
}

}  // namespace voxtouch::mesh
