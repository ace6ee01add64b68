#include "nodes/rendering/plan_message.hpp"

#include "nodes/rendering/plan_ring.hpp"
#include "nodes/runtime/strings.hpp"

namespace voxtouch::rendering_node {
namespace {

/// The parts as parallel lists. Must outlive the write.
class Columns {
 public:
  explicit Columns(const std::vector<rendering::PlanPart>& parts) {
    for (const rendering::PlanPart& part : parts) {
      names_.push_back(part.name), nodes_.push_back(part.node), reasons_.push_back(part.why);
      bytes_.push_back(part.bytes), expected_ns_.push_back(part.expected_ns);
    }
    lent_.reserve(3);
    for (const auto* texts : {&names_, &nodes_, &reasons_})
      lent_.emplace_back(*texts);
  }
  void into(msg::ScenePlan& m) {
    lent_[0].into(m.part_names), lent_[1].into(m.part_nodes), lent_[2].into(m.part_reasons);
    lend_to(m.part_bytes, bytes_), lend_to(m.part_expected_ns, expected_ns_);
  }

 private:
  template <class Sequence, class T>
  static void lend_to(Sequence& sequence, std::vector<T>& numbers) {
    sequence._buffer = numbers.data();
    sequence._length = sequence._maximum = static_cast<std::uint32_t>(numbers.size());
    sequence._release = false;
  }

  std::vector<std::string> names_, nodes_, reasons_;
  std::vector<std::uint64_t> bytes_;
  std::vector<double> expected_ns_;
  std::vector<runtime::StringViews> lent_;
};

std::vector<rendering::PlanPart> all_parts(const rendering::Plan& plan, const scene::Scene& scene) {
  std::vector<rendering::PlanPart> parts = plan.parts;
  for (rendering::PlanPart& part : ring_parts(scene))
    parts.push_back(std::move(part));
  return parts;
}

}  // namespace

void publish_plan(bus::Writer<msg::ScenePlan>& writer, const scene::Scene& scene,
                  const rendering::Plan& plan, const device_fit::SceneRequirements& demand,
                  double largest_shell_gap_m, std::uint64_t session, std::uint64_t from_sample) {
  runtime::StringViews built(plan.built), skipped(plan.skipped), warnings(plan.warnings);
  Columns columns(all_parts(plan, scene));
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
  m.least_stiffness_n_per_m = demand.least_stiffness_n_per_m;
  m.stiffest = runtime::lend(demand.stiffest);
  m.effects_damping_ns_per_m = demand.damping.all;
  m.largest_damping_ns_per_m = demand.damping.largest;
  m.largest_damping = runtime::lend(demand.damping.name);
  m.largest_damping_place = runtime::lend(demand.damping.place);
  m.effects_damping_nms_per_rad = demand.rotation.all;
  m.largest_damping_nms_per_rad = demand.rotation.largest;
  m.largest_rotation_damping = runtime::lend(demand.rotation.name);
  m.largest_rotation_damping_place = runtime::lend(demand.rotation.place);
  m.torque_effect = runtime::lend(demand.torque);
  m.external_force_n = demand.external.force_n;
  m.external_torque_nm = demand.external.torque_nm;
  m.external_effect = runtime::lend(demand.external.name);
  m.external_place = runtime::lend(demand.external.place);
  built.into(m.built);
  skipped.into(m.skipped);
  warnings.into(m.warnings);
  columns.into(m);
  writer.write(m);
}

}  // namespace voxtouch::rendering_node
