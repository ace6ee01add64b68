#pragma once
/// Requests for changes while the ring runs, by message or by service, and their answers.
#include <algorithm>
#include <atomic>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "nodes/bus/reader.hpp"
#include "nodes/bus/wait_set.hpp"
#include "nodes/bus/writer.hpp"
#include "nodes/rendering/effect_services.hpp"
#include "nodes/rendering/pending_changes.hpp"
#include "nodes/runtime/options.hpp"

namespace voxtouch::rendering_node {

/// One thread. A sender whose answer was lost asks again: a number that has been answered gets the
/// same answer.
class ChangeInbox {
 public:
  /// `together`: all in one sample, or none; else there is one.
  using Receive = std::function<void(std::span<const msg::EffectChange> changes, bool together,
                                     std::vector<ChangeRequest> requests)>;

  ChangeInbox(const bus::Participant& participant, const runtime::NodeOptions& options,
              Receive receive, std::function<std::vector<RosParameter>()> parameters);

  /// Waits for a request, `timeout_ns` at most.
  void wait(std::int64_t timeout_ns) noexcept {
    wait_set_.wait(services_.waits() ? std::min(timeout_ns, kSoonNs) : timeout_ns);
  }
  /// Hands on each request that has come, but those with the number of one that was answered or is
  /// `pending`.
  void serve(std::uint64_t session, const std::function<bool(std::uint64_t id)>& pending);
  void answer(const ChangeRequest& request, std::uint32_t result, std::uint64_t sample,
              const std::string& sentence);
  void refuse(const ChangeRequest& request, const std::string& sentence);
  /// The change was made: recorded for a replay, whoever asked for it.
  void record(const ChangeRequest& request, std::uint64_t session, std::uint64_t sample);
  void parameters_changed() { services_.parameters_changed(); }

  // Any thread.
  std::uint64_t refused_changes() const noexcept { return refused_.load(); }
  std::uint64_t refused_requests() const noexcept { return services_.refused(); }
  /// How many changes each participant has requested; of one that has gone all zero.
  std::map<bus::Guid, std::uint64_t> requests() const;

  static constexpr std::int64_t kSoonNs = 1'000'000;  ///< while a reply waits

 private:
  struct Answered {
    std::uint64_t id = 0, sample = 0;
    std::uint32_t result = 0;
    std::string sentence;
  };
  void ask_for(std::span<const msg::EffectChange> asked, bool together, const bus::Guid& by,
               const ChangeReply& reply);
  void count(const bus::Guid& by, std::size_t changes);
  void send(const Answered& answer);

  bus::Reader<msg::EffectChange> changes_;
  bus::Writer<msg::EffectChanged> answers_;
  bus::Writer<msg::EffectChange> made_;
  Receive receive_;
  EffectServices services_;
  bus::WaitSet wait_set_;
  std::deque<Answered> answered_;  ///< the last ones
  std::uint64_t session_ = 0;
  std::atomic<std::uint64_t> refused_{0};
  mutable std::mutex mutex_;
  std::map<bus::Guid, std::uint64_t> requests_;
};

}  // namespace voxtouch::rendering_node
