#pragma once
/// Receives run-time change requests, by message or by service, and replies to them.
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

/// A sender that lost its reply repeats the request. A repeated request number receives the same
/// reply. One thread.
class ChangeInbox {
 public:
  /// `together`: all changes apply in one sample, or none does. Otherwise `changes` holds one
  /// change.
  using Receive = std::function<void(std::span<const msg::EffectChange> changes, bool together,
                                     std::vector<ChangeRequest> requests)>;

  ChangeInbox(const bus::Participant& participant, const runtime::NodeOptions& options,
              Receive receive, std::function<std::vector<RosParameter>()> parameters);

  /// Waits for a request, at most `timeout_ns`.
  void wait(std::int64_t timeout_ns) noexcept {
    wait_set_.wait(services_.waits() ? std::min(timeout_ns, kSoonNs) : timeout_ns);
  }
  /// Forwards each received request, except a repetition of one that is answered or `pending`.
  void serve(std::uint64_t session, const std::function<bool(std::uint64_t id)>& pending);
  void answer(const ChangeRequest& request, std::uint32_t result, std::uint64_t sample,
              const std::string& sentence);
  void refuse(const ChangeRequest& request, const std::string& sentence);
  /// Records an applied change for a replay, including one requested by a service.
  void record(const ChangeRequest& request, std::uint64_t session, std::uint64_t sample);
  void parameters_changed() { services_.parameters_changed(); }

  // Any thread.
  std::uint64_t refused_changes() const noexcept { return refused_.load(); }
  std::uint64_t refused_requests() const noexcept { return services_.refused(); }
  /// Number of changes that each participant has requested. Counts of departed participants are
  /// summed under the zero GUID.
  std::map<bus::Guid, std::uint64_t> requests() const;

  static constexpr std::int64_t kSoonNs = 1'000'000;  ///< while a reply is waiting

 private:
  struct Answered {
    std::uint64_t id = 0, sample = 0;
    std::uint32_t result = 0;
    std::string sentence;
  };
  void handle_request(std::span<const msg::EffectChange> requested, bool together,
                      const bus::Guid& by, const ChangeReply& reply);
  void count(const bus::Guid& by, std::size_t changes);
  void send(const Answered& answer);

  bus::Reader<msg::EffectChange> changes_;
  bus::Writer<msg::EffectChanged> answers_;
  bus::Writer<msg::EffectChange> made_;
  Receive receive_;
  EffectServices services_;
  bus::WaitSet wait_set_;
  std::deque<Answered> answered_;  ///< the most recent ones
  std::uint64_t session_ = 0;
  std::atomic<std::uint64_t> refused_{0};
  mutable std::mutex mutex_;
  std::map<bus::Guid, std::uint64_t> requests_;
};

}  // namespace voxtouch::rendering_node
