#pragma once
/// Reader of a control topic that accepts the samples of one participant only.
#include <memory>

#include "nodes/bus/following.hpp"
#include "nodes/bus/reader.hpp"

namespace voxtouch::bus {

/// For fixed-size types. The history holds the newest sample of the followed writer in real time,
/// and all of them, in order, in lockstep.
template <class T>
class FollowedReader {
 public:
  FollowedReader() = default;
  FollowedReader(const Participant& participant, const qos::Topic& row, std::string_view rig,
                 const qos::Profile& profile)
      : following_(std::make_unique<Following>(Following::WhileUnbound::kTakeNothing)),
        reader_(participant, row, rig, profile, following_.get()) {}

  /// Takes the oldest waiting sample of the followed writer. Real-time safe apart from the DDS
  /// call. Examines at most kMaxTakes samples; the rest remain for the next call.
  bool take(T& sample, dds_instance_handle_t* writer = nullptr) noexcept {
    dds_instance_handle_t from = 0;
    for (int i = 0; i < kMaxTakes && reader_.take(sample, &from); ++i) {
      if (!following_->admits(from))
        continue;  // stored while another writer was followed
      if (writer)
        *writer = from;
      return true;
    }
    return false;
  }
  /// After this many samples a loop continues with its other work.
  static constexpr int kMaxTakes = 64;

  Following& following() const noexcept { return *following_; }
  dds_instance_handle_t writer() const noexcept { return following_->writer(); }
  std::vector<Guid> matched() const { return reader_.matched(); }
  std::uint32_t matched_count() const noexcept { return reader_.matched_count(); }
  std::uint64_t deadlines_missed() const noexcept { return reader_.deadlines_missed(); }
  dds_entity_t condition() const noexcept { return reader_.condition(); }

 private:
  std::unique_ptr<Following> following_;  // outlives the reader, which calls it
  Reader<T> reader_;
};

}  // namespace voxtouch::bus
