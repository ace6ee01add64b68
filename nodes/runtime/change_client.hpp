#pragma once
/// Requests a change from a running ring and waits for the reply. Used by `voxtouch change` and by
/// the page of `voxtouch view`.
#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "nodes/bus/reader.hpp"
#include "nodes/bus/writer.hpp"
#include "nodes/runtime/options.hpp"

namespace voxtouch::runtime {

/// The requested change, in the words of the command line.
struct ChangeWords {
  /// EFFECT on|off, EFFECT gain X, EFFECT PARAMETER=VALUE[,V,V] ...; empty with `reload`.
  std::vector<std::string> words;
  bool reload = false;
  double voxel_size_m = 0.0;  ///< with `reload`; 0: value of the file
  std::string model;          ///< with `reload`; empty: value of the file
  std::uint64_t from_sample = 0;
};

/// Contents of one request message.
struct ChangeRequest {
  std::uint32_t action = 0;
  std::string effect, parameter;
  std::array<double, 3> value{};
};
/// Returns one request for each change in the words. Throws std::runtime_error, with a sentence, if
/// the words name no change.
std::vector<ChangeRequest> read_changes(const ChangeWords& words);

/// An applied change.
struct ChangeAnswer {
  std::uint64_t from_sample = 0;
  std::string sentence;  ///< description of the change
};

/// Used by one thread at a time; allocates and blocks.
class ChangeClient {
 public:
  ChangeClient(const bus::Participant& participant, const NodeOptions& options);

  /// Requests the changes in order and stops at the first that is refused. `answered` is called
  /// with each reply, in order. `waits` is called when the rendering reports that a change takes
  /// time. The wait has no limit and ends on `leave`. Returns the reason for refusal; empty if all
  /// changes were applied.
  std::string request(
      const ChangeWords& words, const std::function<void(const ChangeAnswer&)>& answered,
      const std::function<void(const std::string&)>& waits,
      const std::function<bool()>& leave = [] { return false; });

 private:
  struct Message {
    std::uint32_t result = 0;
    std::uint64_t session = 0, from_sample = 0;
    std::string sentence;
  };
  std::optional<Message> request_in_session(const ChangeRequest& change, const ChangeWords& words,
                                            const std::function<void(const std::string&)>& waits,
                                            const std::function<bool()>& leave);
  std::optional<Message> request_one(const ChangeRequest& change, const ChangeWords& words,
                                     const std::function<void(const std::string&)>& waits,
                                     const std::function<bool()>& leave);
  void send(const ChangeRequest& change, const ChangeWords& words, std::uint64_t request);
  std::string no_rendering() const;

  std::string rig_;
  std::uint32_t domain_;
  bus::Writer<msg::EffectChange> changes_;
  bus::Reader<msg::EffectChanged> answers_;
  bus::Reader<msg::ScenePlan> plans_;  ///< name the running session
  /// Session of the request: a request replayed from a bag names another session and is refused.
  std::uint64_t session_ = 0;
};

}  // namespace voxtouch::runtime
