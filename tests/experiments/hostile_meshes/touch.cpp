#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <random>
#include <stdexcept>

#include "core/contact/contact_renderer.hpp"
#include "core/mesh/import.hpp"
#include "core/mesh/weld.hpp"
#include "core/pointshell/build_shell.hpp"
#include "core/voxmap/voxelise.hpp"
#include "nodes/mesh_import/mesh_process.hpp"
#include "tests/experiments/hostile_meshes/attempt.hpp"
#include "tests/unit/contact/field_scenes.hpp"

namespace voxtouch::hostile {
namespace {

constexpr double kVoxelsLong = 40.0, kStiffness = 100.0, kPressure = 1e8;
/// Deeper than the force range of any model: the field stores 12 voxels.
constexpr double kMaxDepthEdges = 12.1;

using Random = std::mt19937_64;

double uniform(Random& random, double low, double high) {
  return low + (high - low) * static_cast<double>(random() >> 11) * 0x1p-53;
}

Quat any_rotation(Random& random) {
  Quat q;
  do
    q.coeffs() = Eigen::Vector4d(uniform(random, -1, 1), uniform(random, -1, 1),
                                 uniform(random, -1, 1), uniform(random, -1, 1));
  while (q.norm() < 0.1);
  return q.normalized();
}

Vec3 on_triangle(const mesh::TriangleMesh& mesh, Random& random) {
  const std::size_t t = random() % mesh.triangles.size();
  double s = uniform(random, 0, 1), r = uniform(random, 0, 1);
  if (s + r > 1.0)
    s = 1.0 - s, r = 1.0 - r;
  return mesh.corner(t, 0) + s * (mesh.corner(t, 1) - mesh.corner(t, 0)) +
         r * (mesh.corner(t, 2) - mesh.corner(t, 0));
}

/// Empty if all values are finite and bounded.
std::string complaint(const contact::ContactResult& r, double most_force) {
  if (!r.wrench.finite())
    return "a wrench is not finite";
  if (!r.mean_normal.allFinite() || !std::isfinite(r.coherence))
    return "a mean normal or coherence is not finite";
  if (!r.deepest_point.allFinite() || !std::isfinite(r.deepest_depth_m))
    return "a depth is not finite";
  if (!r.stiffness.allFinite() || !std::isfinite(r.stiffness_bound_n_per_m))
    return "a stiffness is not finite";
  if (!(r.wrench.force.norm() <= most_force))
    return "a force is beyond what all points together can push";
  return {};
}

struct Touches {
  std::uint64_t poses = 0, met = 0;
  std::string wrong;
};

/// One tool on one ground with every model that they allow.
class Contact {
 public:
  Contact(const voxmap::Voxmap& voxmap, const pointshell::Pointshell& shell,
          const voxmap::DistanceField* field) {
    double area = 0.0;
    for (const double a : shell.area_m2)
      area += a;
    const double depth = kMaxDepthEdges * voxmap.grid().edge;
    for (const contact::ContactModelKind kind :
         {contact::ContactModelKind::kOriginal, contact::ContactModelKind::kAdapted}) {
      add(voxmap, shell, kind, {kStiffness, contact::PointWeights::kOne}, nullptr,
          kStiffness * double(shell.size()) * depth);
      add(voxmap, shell, kind, {kPressure, contact::PointWeights::kArea}, nullptr,
          kPressure * area * depth);
    }
    if (field)
      add(voxmap, shell, contact::ContactModelKind::kField,
          {kPressure, contact::PointWeights::kArea}, field, kPressure * area * depth);
  }
  void touch(const Pose& pose, Touches& touches) {
    bool met = false;
    for (std::size_t n = 0; n < renderers_.size(); ++n) {
      const contact::StageResult stage = renderers_[n]->render(pose);
      const contact::ContactResult plain = renderers_[n]->probe(pose);
      met = met || plain.surface_hits > 0;
      for (const contact::ContactResult* r : {&stage.contact, &plain})
        if (const std::string wrong = complaint(*r, most_force_[n]);
            !wrong.empty() && touches.wrong.empty())
          touches.wrong = wrong + " (model " + std::string(contact::name_of(kind_[n])) + ", pose " +
                          std::to_string(touches.poses) + ")";
    }
    ++touches.poses, touches.met += met;
  }

 private:
  void add(const voxmap::Voxmap& voxmap, const pointshell::Pointshell& shell,
           contact::ContactModelKind kind, const contact::ContactParameters& parameters,
           const voxmap::DistanceField* field, double most_force) {
    renderers_.push_back(
        std::make_unique<contact::ContactRenderer>(voxmap, shell, kind, parameters, field));
    kind_.push_back(kind), most_force_.push_back(most_force);
  }
  std::vector<std::unique_ptr<contact::ContactRenderer>> renderers_;
  std::vector<contact::ContactModelKind> kind_;
  std::vector<double> most_force_;
};

/// A ball of three voxels on the mesh.
Touches ball_on(const mesh::TriangleMesh& mesh, double e, std::uint32_t poses, Random& random,
                bool& has_inside) {
  const voxmap::Voxmap voxmap = voxmap::voxelise(mesh, voxmap::default_grid(mesh, e), serial_for());
  const voxmap::DistanceField field = voxmap::build_distance_field(mesh, voxmap, {}, serial_for());
  has_inside = field.has_inside();
  const mesh::TriangleMesh ball = test::sphere_mesh(3.0 * e, 2);
  Contact contact(voxmap, test::exact_shell(ball, e), has_inside ? &field : nullptr);
  Touches touches;
  for (std::uint32_t n = 0; n < poses; ++n) {
    const Vec3 away = any_rotation(random) * Vec3(0, 0, uniform(random, 0.0, 4.0 * e));
    contact.touch({on_triangle(mesh, random) + away, any_rotation(random)}, touches);
  }
  return touches;
}

/// The mesh as the tool on a block with its top at z = 0.
Touches mesh_on_block(const mesh::TriangleMesh& mesh, double e, std::uint32_t poses,
                      Random& random) {
  Pose down;
  down.position.z() = -10.0 * e;
  const test::Ground block(test::box_mesh(Vec3(160.0 * e, 160.0 * e, 20.0 * e), down), e);
  Contact contact(block.voxmap, test::exact_shell(mesh, e), &block.field);
  Touches touches;
  for (std::uint32_t n = 0; n < poses; ++n) {
    const Quat turn = any_rotation(random);
    const Vec3 place(uniform(random, -e, e), uniform(random, -e, e),
                     uniform(random, -1.5 * e, 0.9 * e));
    contact.touch({place - turn * on_triangle(mesh, random), turn}, touches);
  }
  return touches;
}

}  // namespace

Verdict touch(const std::filesystem::path& file, const Limits& limits) {
  Verdict verdict{
      .file = file, .outcome = Outcome::kRefused, .sentence = {}, .cpu_s = 0.0, .peak_mib = 0};
  try {
    const double extent =
        mesh::bounds(mesh::import_mesh(file, {}, mesh_import::mesh_process()).mesh)
            .sizes()
            .maxCoeff();
    mesh::ImportOptions options;
    options.voxel_size_m = extent > 0.0 ? extent / kVoxelsLong : 1e-3;
    const mesh::ImportedMesh read = mesh::import_mesh(file, options, mesh_import::mesh_process());
    const double e = options.voxel_size_m;
    Random random(limits.seed);
    bool has_inside = false;
    const Touches ball = ball_on(read.mesh, e, limits.poses, random, has_inside);
    const Touches tool = mesh_on_block(read.mesh, e, limits.poses, random);
    const std::string wrong = ball.wrong.empty() ? tool.wrong : ball.wrong;
    verdict.outcome = !wrong.empty()                   ? Outcome::kNotFinite
                      : ball.met == 0 || tool.met == 0 ? Outcome::kNoContact
                                                       : Outcome::kTouched;
    verdict.sentence =
        !wrong.empty()
            ? wrong
            : std::to_string(read.mesh.triangles.size()) + " triangles, " +
                  (has_inside ? "with" : "without") + " an inside, in contact at " +
                  std::to_string(ball.met) + " and " + std::to_string(tool.met) + " of " +
                  std::to_string(limits.poses) + " poses" +
                  (read.report.clean() ? ""
                                       : ", " + std::to_string(read.report.sentences().size()) +
                                             " warnings of its surface");
  } catch (const std::bad_alloc&) {
    verdict.outcome = Outcome::kUnnamed;
    verdict.sentence = "memory ran out";
  } catch (const std::exception& error) {
    verdict.sentence = error.what();
    // Every refusal has a cause and a remedy.
    if (verdict.sentence.size() < 20)
      verdict.outcome = Outcome::kUnnamed;
  }
  return verdict;
}

}  // namespace voxtouch::hostile
