#include "nodes/rendering/plan_message.hpp"

#include "nodes/runtime/strings.hpp"

namespace voxtouch::rendering {

void publish_plan(bus::Writer<msg::ScenePlan>& writer, const Plan& plan, double largest_shell_gap_m,
                  std::uint64_t session, std::uint64_t from_sample) {
  runtime::LentStrings built(plan.built), left_out(plan.left_out), warnings(plan.warnings);
  msg::ScenePlan m{};
  m.session_id = session;
  m.from_sample = from_sample;
  m.scene = runtime::lend(plan.scene);
  m.scene_hash = runtime::lend(plan.scene_hash);
  m.contact_model = runtime::lend(plan.contact_model);
  m.voxel_size_m = plan.voxel_size_m;
  m.shell_points = plan.shell_points;
  m.surface_voxels = plan.surface_voxels;
  m.interior_voxels = plan.interior_voxels;
  m.bytes = plan.bytes;
  m.largest_shell_gap_m = largest_shell_gap_m;
  m.expected_ns_per_frame = plan.expected_ns_per_frame;
  m.one_point_stiffness_n_per_m = plan.contact_n_per_m.one_point;
  m.all_points_stiffness_n_per_m = plan.contact_n_per_m.all_points;
  m.one_point_stiffness_nm_per_rad = plan.contact_nm_per_rad.one_point;
  m.all_points_stiffness_nm_per_rad = plan.contact_nm_per_rad.all_points;
  built.into(m.built);
  left_out.into(m.left_out);
  warnings.into(m.warnings);
  writer.write(m);
}

}  // namespace voxtouch::rendering
