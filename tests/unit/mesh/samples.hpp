#pragma once
/// Common small meshes and files of the tests in this folder.
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <sstream>
#include <string>

#include "core/mesh/triangle_mesh.hpp"

namespace samples {

using voxtouch::Vec3;
using voxtouch::mesh::TriangleMesh;

/// Closed, outward, volume 1/6.
inline TriangleMesh tetrahedron() {
  return {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
          {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};
}

/// Closed, outward.
inline TriangleMesh box(const Vec3& low, const Vec3& high) {
  TriangleMesh mesh;
  for (int k = 0; k < 8; ++k) {
    mesh.vertices.emplace_back(k & 1 ? high.x() : low.x(), k & 2 ? high.y() : low.y(),
                               k & 4 ? high.z() : low.z());
  }
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

inline TriangleMesh joined(TriangleMesh a, const TriangleMesh& b) {
  const auto first = static_cast<std::uint32_t>(a.vertices.size());
  a.vertices.insert(a.vertices.end(), b.vertices.begin(), b.vertices.end());
  for (const auto& t : b.triangles)
    a.triangles.push_back({first + t[0], first + t[1], first + t[2]});
  return a;
}

inline TriangleMesh flipped(TriangleMesh mesh) {
  for (auto& t : mesh.triangles)
    std::swap(t[1], t[2]);
  return mesh;
}

/// Every triangle with separate vertices, as in STL.
inline TriangleMesh soup(const TriangleMesh& mesh) {
  TriangleMesh loose;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    for (int k = 0; k < 3; ++k)
      loose.vertices.push_back(mesh.corner(t, k));
    loose.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
  }
  return loose;
}

/// A temporary folder, removed with the object.
class Folder {
 public:
  Folder() {
    std::string name = (std::filesystem::temp_directory_path() / "voxtouch_mesh_XXXXXX").string();
    path_ = ::mkdtemp(name.data());
  }
  ~Folder() { std::filesystem::remove_all(path_); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path write(const std::string& name, const std::string& bytes) const {
    std::ofstream(path_ / name, std::ios::binary) << bytes;
    return path_ / name;
  }

 private:
  std::filesystem::path path_;
};

template <class T>
std::string little(std::initializer_list<T> values) {
  std::string bytes;
  for (const T value : values)
    bytes.append(reinterpret_cast<const char*>(&value),
                 sizeof value);  // both are little-endian
  return bytes;
}

inline std::string obj_text(const TriangleMesh& mesh) {
  std::ostringstream text;
  text.precision(9);
  for (const Vec3& v : mesh.vertices)
    text << "v " << v.x() << ' ' << v.y() << ' ' << v.z() << '\n';
  for (const auto& t : mesh.triangles)
    text << "f " << t[0] + 1 << ' ' << t[1] + 1 << ' ' << t[2] + 1 << '\n';
  return text.str();
}

inline std::string binary_stl(const TriangleMesh& mesh) {
  std::string bytes(80, ' ');
  bytes += little({static_cast<std::uint32_t>(mesh.triangles.size())});
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    bytes += little({0.0f, 0.0f, 0.0f});
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3f x = mesh.corner(t, k).cast<float>();
      bytes += little({x.x(), x.y(), x.z()});
    }
    bytes += little({std::uint16_t{0}});
  }
  return bytes;
}

inline std::string text_stl(const TriangleMesh& mesh) {
  std::ostringstream text;
  text.precision(9);
  text << "solid sample\n";
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    text << "facet normal 0 0 0\nouter loop\n";
    for (int k = 0; k < 3; ++k)
      text << "vertex " << mesh.corner(t, k).transpose() << '\n';
    text << "endloop\nendfacet\n";
  }
  text << "endsolid sample\n";
  return text.str();
}

/// The tetrahedron's positions (48 bytes) and indices (24 bytes).
inline std::string gltf_buffer() {
  return little({0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f}) +
         little<std::uint16_t>({0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3});
}

struct Gltf {
  std::string nodes = R"([{"mesh":0}])";
  std::string buffer = R"({"byteLength":72})";  ///< with a "uri" for .gltf
  std::string positions = R"({"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"})";
  std::string indices = R"({"bufferView":1,"componentType":5123,"count":12,"type":"SCALAR"})";

  std::string json() const {
    return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":)" + nodes +
           R"(,"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],"buffers":[)" +
           buffer +
           R"(],"bufferViews":[{"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":24}],"accessors":[)" +
           positions + "," + indices + "]}";
  }
  std::string glb() const {
    std::string text = json();
    text.resize((text.size() + 3) / 4 * 4, ' ');
    const auto length = static_cast<std::uint32_t>(text.size());
    return "glTF" + little<std::uint32_t>({2, 12 + 8 + length + 8 + 72, length}) + "JSON" + text +
           little<std::uint32_t>({72}) + std::string("BIN\0", 4) + gltf_buffer();
  }
};

struct Collada {
  std::string unit = R"(<unit name="meter" meter="1"/>)";
  std::string up = "Y_UP";
  std::string count = "12";
  std::string stride = "3";
  std::string kind = "triangles", faces = "4";
  std::string p = "0 2 1 0 1 3 0 3 2 1 2 3";
  std::string library;
  std::string nodes = R"(<node id="n"><instance_geometry url="#g"/></node>)";

  std::string xml() const {
    return R"(<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><asset>)" +
           unit + "<up_axis>" + up +
           R"(</up_axis></asset><library_geometries><geometry id="g"><mesh><source id="s">)" +
           R"(<float_array id="a" count=")" + count +
           R"(">0 0 0 1 0 0 0 1 0 0 0 1</float_array><technique_common>)" +
           R"(<accessor source="#a" count="4" stride=")" + stride +
           R"("><param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/></accessor>)" +
           R"(</technique_common></source><vertices id="v"><input semantic="POSITION" source="#s"/></vertices>)" +
           "<" + kind + " count=\"" + faces +
           R"("><input semantic="VERTEX" source="#v" offset="0"/><p>)" + p + "</p></" + kind +
           "></mesh></geometry></library_geometries>" + library +
           R"(<library_visual_scenes><visual_scene id="w">)" + nodes +
           R"(</visual_scene></library_visual_scenes><scene><instance_visual_scene url="#w"/></scene></COLLADA>)";
  }
};

}  // namespace samples
