/// `voxtouch build` on the meshes of the vectors: the same voxels, the same points, and a PLY that
/// others can read.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdio>
#include <cstring>

#include <fmt/format.h>

#include "tests/golden/golden.hpp"

namespace voxtouch::test {
namespace {

struct Case {
  std::string file, mesh;  ///< file name of the built part, and of its vectors
};
void PrintTo(const Case& c, std::ostream* out) { *out << c.file; }

class BuildVerb : public testing::TestWithParam<Case> {
 protected:
  /// Builds the mesh on the vectors' grid.
  void SetUp() override {
    const nlohmann::json& mesh = vector_index().at("meshes").at(GetParam().mesh);
    const auto origin = mesh.at("origin").get<std::vector<double>>();
    result_ = voxtouch({"build", (kVectors / "meshes" / GetParam().file).string(), "--voxel",
                        fmt::to_string(mesh.at("e").get<double>()), "--origin",
                        fmt::format("{},{},{}", origin[0], origin[1], origin[2]), "--out",
                        out_.path().string(), "--json"});
    ASSERT_EQ(result_.status, 0) << result_.err;
  }
  std::string expected(const std::string& kind) const {
    return file_text(kVectors / "voxels" / (GetParam().mesh + "_" + kind + ".csv"));
  }
  std::filesystem::path built(const std::string& kind) const {
    return out_ / (GetParam().mesh + "_" + kind);
  }

  TemporaryFolder out_;
  Finished result_;
};

INSTANTIATE_TEST_SUITE_P(Meshes, BuildVerb,
                         testing::Values(Case{"sphere.obj", "sphere"}, Case{"sphere.stl", "sphere"},
                                         Case{"slab_tilted.obj", "slab_tilted"},
                                         Case{"cylinder.obj", "cylinder"},
                                         Case{"lshape.obj", "lshape"},
                                         Case{"aligned_box.obj", "aligned_box"},
                                         Case{"degenerate_tris.obj", "degenerate_tris"}),
                         [](const auto& test) {
                           const std::string& file = test.param.file;
                           return test.param.mesh + "_" + file.substr(file.size() - 3);
                         });

TEST_P(BuildVerb, WritesTheVectorsSurfaceVoxelsAndPoints) {
  const Table ours = Table::read(built("surface.csv")), theirs = Table::parse(expected("surface"));
  ASSERT_EQ(ours.header(), theirs.header());
  ASSERT_EQ(ours.size(), theirs.size());
  double point = 0.0, normal = 0.0, plain = 0.0, distance = 0.0, coherence = 0.0;
  const auto off = [&](std::size_t row, std::initializer_list<const char*> columns,
                       double& largest) {
    for (const char* column : columns)
      largest = std::max(largest, std::abs(ours.number(row, column) - theirs.number(row, column)));
  };
  for (std::size_t row = 0; row < ours.size(); ++row) {
    SCOPED_TRACE("row " + std::to_string(row));
    for (const char* column : {"i", "j", "k", "open", "tie"})
      ASSERT_EQ(ours.text(row, column), theirs.text(row, column)) << column;
    off(row, {"dist"}, distance);
    off(row, {"coh"}, coherence);
    off(row, {"mx", "my", "mz"}, plain);
    if (theirs.text(row, "tie") != "0")
      continue;  // of several nearest points any may be taken
    off(row, {"px", "py", "pz"}, point);
    off(row, {"nx", "ny", "nz"}, normal);
    EXPECT_EQ(ours.text(row, "tri"), theirs.text(row, "tri"));
    EXPECT_EQ(ours.text(row, "fallback"), theirs.text(row, "fallback"));
  }
  EXPECT_LE(point, 1e-9);
  EXPECT_LE(distance, 1e-9);
  EXPECT_LE(normal, 1e-9);
  EXPECT_LE(plain, 0.6e-7);      // printed with 7 digits
  EXPECT_LE(coherence, 0.6e-4);  // printed with 4 digits
  std::printf("%s: %zu points, largest difference %.1e m, distance %.1e m, normal %.1e\n",
              GetParam().file.c_str(), ours.size(), point, distance, normal);
}

TEST_P(BuildVerb, WritesTheVectorsInteriorByteForByte) {
  EXPECT_EQ(file_text(built("interior.csv")), expected("interior"));
}

TEST_P(BuildVerb, PrintsItsResultAsJson) {
  const nlohmann::json said = nlohmann::json::parse(result_.out);
  const nlohmann::json& mesh = vector_index().at("meshes").at(GetParam().mesh);
  EXPECT_EQ(said.at("surface_voxels"), mesh.at("n_surface_closed"));
  EXPECT_EQ(said.at("interior_voxels"), mesh.at("n_interior"));
  EXPECT_EQ(said.at("origin_m"), mesh.at("origin"));
  const double gap_in_e = mesh.at("pointshell").at("max_gap_face_neighbours_in_e").get<double>();
  EXPECT_NEAR(said.at("largest_gap_m").get<double>(), gap_in_e * mesh.at("e").get<double>(), 1e-9);
  for (const auto& file : said.at("files"))
    EXPECT_TRUE(std::filesystem::is_regular_file(file.get<std::string>())) << file;
}

double little_endian_double(const std::string& bytes, std::size_t at) {
  std::uint64_t bits = 0;
  for (std::size_t n = 0; n < 8; ++n)
    bits |= std::uint64_t{static_cast<unsigned char>(bytes.at(at + n))} << (8 * n);
  return std::bit_cast<double>(bits);
}

TEST_P(BuildVerb, WritesAPlyWithTheSamePointsAndUnitNormals) {
  const std::string ply = file_text(built("shell.ply"));
  const Table rows = Table::read(built("surface.csv"));
  std::istringstream header(ply);
  std::vector<std::string> properties;
  std::string line;
  std::size_t vertices = 0;
  std::getline(header, line);
  EXPECT_EQ(line, "ply");
  std::getline(header, line);
  EXPECT_EQ(line, "format binary_little_endian 1.0");
  while (std::getline(header, line) && line != "end_header") {
    if (line.starts_with("element vertex "))
      vertices = std::stoul(line.substr(15));
    if (line.starts_with("property double "))
      properties.push_back(line.substr(16));
  }
  ASSERT_EQ(properties, (std::vector<std::string>{"x", "y", "z", "nx", "ny", "nz", "area"}));
  ASSERT_EQ(vertices, rows.size());
  const auto body = static_cast<std::size_t>(header.tellg());
  ASSERT_EQ(ply.size() - body, vertices * 7 * 8);
  for (std::size_t v = 0; v < vertices; ++v) {
    SCOPED_TRACE("vertex " + std::to_string(v));
    double value[7];
    for (std::size_t p = 0; p < 7; ++p)
      value[p] = little_endian_double(ply, body + (v * 7 + p) * 8);
    std::size_t n = 0;
    for (const char* column : {"px", "py", "pz", "nx", "ny", "nz"})
      EXPECT_EQ(value[n++], rows.number(v, column));
    EXPECT_NEAR(std::hypot(value[3], value[4], value[5]), 1.0, 1e-12);
    EXPECT_GE(value[6], 0.0);
  }
}

}  // namespace
}  // namespace voxtouch::test
