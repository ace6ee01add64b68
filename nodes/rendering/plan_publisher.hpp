#pragma once
/// Publishes the running plan for the ring and the virtual tool's springs for the loop.
#include <atomic>
#include <mutex>
#include <string>

#include "nodes/rendering/change_validator.hpp"
#include "nodes/rendering/plan_message.hpp"
#include "nodes/runtime/options.hpp"

namespace voxtouch::rendering_node {

class PlanPublisher {
 public:
  PlanPublisher(const bus::Participant& participant, const runtime::NodeOptions& options)
      : plans_(participant, qos::kScenePlan, options.rig,
               qos::profile_in(qos::kScenePlan, options.mode())),
        lockstep_(options.lockstep) {}
  const bus::Writer<msg::ScenePlan>& writer() const noexcept { return plans_; }
  bool lockstep() const noexcept { return lockstep_; }

  std::uint64_t session() const noexcept { return session_; }  ///< 0: no device has begun one
  void set_session(std::uint64_t session) noexcept { session_ = session; }
  /// Sets the first sample that the running plan is valid for. After a ramp or fade it is the
  /// sample of the change that began it.
  void set_sample(std::uint64_t from_sample) noexcept { from_sample_ = from_sample; }
  std::uint64_t sample() const noexcept { return from_sample_; }
  /// Publishes the plan; does nothing until a session has begun. `acknowledged`: in lockstep, waits
  /// for the readers, which need the plan by the first sample that it is valid for.
  void publish(const ChangeValidator& runs, bool acknowledged = true) {
    if (session_ == 0)
      return;
    publish_plan(plans_, runs.scene(), runs.plan(), runs.demand(), runs.largest_shell_gap_m(),
                 session_, from_sample_);
    if (lockstep_ && acknowledged)
      plans_.wait_for_acknowledgments(DDS_SECS(2));
  }
  /// Called after `runs` has been validated for its device.
  void set_judged(const device_fit::DeviceCompatibility& judged) {
    spring_n_per_m_.store(judged.spring_n_per_m(), std::memory_order_release);
    series_m_per_n_.store(judged.series_spring().translation, std::memory_order_release);
    series_rad_per_nm_.store(judged.series_spring().rotation, std::memory_order_release);
    effects_m_per_n_.store(judged.series_spring().effects, std::memory_order_release);
    const std::lock_guard lock(refusal_mutex_);
    refusal_ = design_text::sentence_of(judged.refusal());
  }
  /// All changes requested in this session have been processed.
  void set_complete() noexcept { judged_.store(session_, std::memory_order_release); }

  // Any thread; all except `refusal` are real-time safe.
  bool is_validated(std::uint64_t session) const noexcept {
    return judged_.load(std::memory_order_acquire) == session;
  }
  double spring_n_per_m() const noexcept { return spring_n_per_m_.load(std::memory_order_acquire); }
  rendering::Compliance series_spring() const noexcept {
    return {series_m_per_n_.load(std::memory_order_acquire),
            series_rad_per_nm_.load(std::memory_order_acquire),
            effects_m_per_n_.load(std::memory_order_acquire)};
  }
  std::string refusal() const {
    const std::lock_guard lock(refusal_mutex_);
    return refusal_;
  }

 private:
  bus::Writer<msg::ScenePlan> plans_;
  const bool lockstep_;
  std::uint64_t session_ = 0, from_sample_ = 0;
  std::atomic<double> spring_n_per_m_{0.0}, series_m_per_n_{0.0}, series_rad_per_nm_{0.0};
  std::atomic<double> effects_m_per_n_{0.0};
  std::atomic<std::uint64_t> judged_{0};  ///< session of the last validation
  mutable std::mutex refusal_mutex_;
  std::string refusal_;
};

}  // namespace voxtouch::rendering_node
