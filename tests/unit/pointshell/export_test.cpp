#include "core/pointshell/export.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <locale>

#include "core/voxmap/voxelise.hpp"
#include "tests/unit/voxmap/vectors.hpp"

namespace voxtouch::pointshell {
namespace {

using namespace test;

/// A locale that writes 1.234,5: whatever is written must not care.
struct Commas : std::numpunct<char> {
  char do_decimal_point() const override { return ','; }
  char do_thousands_sep() const override { return '.'; }
  std::string do_grouping() const override { return "\3"; }
};

template <class Write>
std::string written(Write&& write) {
  std::ostringstream out;
  out.imbue(std::locale(std::locale::classic(), new Commas));
  write(out);
  return out.str();
}

TEST(Export, InteriorFilesAreByteForByteThoseOfTheVectors) {
  for (const std::string& name : vector_meshes()) {
    const voxmap::Voxmap map = voxmap::voxelise(read_obj(name), vector_grid(name), serial_for());
    std::stringstream expected;
    expected << open_vector("voxels/" + name + "_interior.csv").rdbuf();
    EXPECT_EQ(written([&](std::ostream& out) { write_interior_csv(out, map); }), expected.str())
        << name;
  }
}

TEST(Export, ARunEndsAtAGapAndAtARowsEnd) {
  voxmap::Voxmap map({}, {-9, 0, -9}, {9, 9, 9});
  for (const voxmap::VoxelIndex& v :
       {voxmap::VoxelIndex{-9, 0, -9}, {-9, 0, -8}, {-9, 0, -6}, {-9, 1, -5}, {0, 1, -4}})
    map.set(v, voxmap::VoxelKind::kInterior);
  map.set({0, 1, -3}, voxmap::VoxelKind::kSurface);
  map.set({0, 1, -2}, voxmap::VoxelKind::kInterior);
  EXPECT_EQ(written([&](std::ostream& out) { write_interior_csv(out, map); }),
            "i,j,k_first,k_last\n-9,0,-9,-8\n-9,0,-6,-6\n-9,1,-5,-5\n0,1,-4,-4\n0,1,-2,-2\n");
}

TEST(Export, SurfaceFilesReadBackExactly) {
  const auto points = shell_points(read_obj("cylinder"), vector_grid("cylinder"), serial_for());
  std::istringstream text(written([&](std::ostream& out) { write_surface_csv(out, points); }));
  std::string header, expected_header;
  std::ifstream vector = open_vector("voxels/cylinder_surface.csv");
  std::getline(vector, expected_header);
  std::getline(text, header);
  EXPECT_EQ(header, expected_header);
  text.seekg(0);
  const auto rows = read_csv(text);
  ASSERT_EQ(rows.size(), points.size());
  for (std::size_t n = 0; n < rows.size(); ++n) {
    EXPECT_EQ(rows[n].at("k"), points[n].voxel.k);
    EXPECT_EQ(rows[n].at("px"), points[n].point.x());
    EXPECT_EQ(rows[n].at("nz"), points[n].normal.z());
    EXPECT_EQ(rows[n].at("my"), points[n].plain_normal.y());
    EXPECT_EQ(rows[n].at("dist"), points[n].distance_m);
    EXPECT_EQ(rows[n].at("fallback"), static_cast<int>(points[n].rule));
  }
}

/// A plate a tenth of a voxel thick, askew, with the rounding of a file in single precision: both
/// sides' normals cancel but for noise.
TEST(Export, CancellingNormalsAreZeroAndFlagged) {
  mesh::TriangleMesh plate = box(Vec3(0, 0, 0), Vec3(8, 8, 0.1));
  const Quat askew(Eigen::AngleAxisd(0.3, Vec3(1, 2, 0.5).normalized()));
  for (Vec3& v : plate.vertices)
    v = (askew * v).cast<float>().cast<double>();
  const auto points = shell_points(plate, {Vec3::Constant(-20.3), 1.0}, serial_for());
  std::istringstream text(written([&](std::ostream& out) { write_surface_csv(out, points); }));
  const auto rows = read_csv(text);
  std::size_t cancelling = 0;
  for (const auto& row : rows) {
    const Vec3 plain(row.at("mx"), row.at("my"), row.at("mz")),
        normal(row.at("nx"), row.at("ny"), row.at("nz"));
    const bool flagged = static_cast<int>(row.at("fallback")) & 4;
    cancelling += flagged;
    EXPECT_NEAR(plain.norm(), flagged ? 0.0 : 1.0, 1e-12);
    EXPECT_NEAR(normal.norm(), 1.0, 1e-12) << "the point's own normal is another matter";
  }
  EXPECT_GT(cancelling, rows.size() / 4);
  EXPECT_LT(cancelling, rows.size()) << "at the rim they do not";
}

TEST(Export, PlyHoldsSevenDoublesAPoint) {
  const auto points =
      shell_points(sphere(Vec3::Zero(), 1.0, 30), {Vec3::Constant(-2), 0.05}, serial_for());
  ASSERT_GT(points.size(), 1000U);
  const std::string ply = written([&](std::ostream& out) { write_shell_ply(out, points); });
  EXPECT_EQ(ply.rfind("ply\nformat binary_little_endian 1.0\n", 0), 0U);
  EXPECT_NE(ply.find("element vertex " + std::to_string(points.size()) + "\n"), std::string::npos);
  const std::string end = "end_header\n";
  const std::size_t body = ply.find(end) + end.size();
  ASSERT_EQ(ply.size() - body, points.size() * 56);
  std::array<double, 7> last{};
  std::memcpy(last.data(), ply.data() + ply.size() - 56, 56);
  EXPECT_EQ(last[0], points.back().point.x());
  EXPECT_EQ(last[5], points.back().normal.z());
  EXPECT_EQ(last[6], points.back().area_m2);
}

}  // namespace
}  // namespace voxtouch::pointshell
