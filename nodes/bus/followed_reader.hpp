#pragma once
/// A reader of a control topic: it gives the samples of one participant and refuses all others.
#include <memory>

#include "nodes/bus/following.hpp"
#include "nodes/bus/reader.hpp"

namespace voxtouch::bus {

/// For fixed-size types. In real time its history holds one sample, the newest of the writer that
/// is followed; in lockstep all of them, in order.
template <class T>
class FollowedReader {
 public:
  FollowedReader() = default;
  FollowedReader(const Participant& participant, const qos::Topic& row, std::string_view rig,
                 const qos::Profile& profile)
      : following_(std::make_unique<Following>(Following::WhileUnbound::kTakeNothing)),
        reader_(participant, row, rig, profile, following_.get()) {}

  /// The oldest waiting sample of the writer that is followed. Real-time safe apart from what DDS
  /// itself does; looks at kMaxTakes samples at most, what is left comes next time.
  bool take(T& sample, dds_instance_handle_t* writer = nullptr) noexcept {
    dds_instance_handle_t from = 0;
    for (int i = 0; i < kMaxTakes && reader_.take(sample, &from); ++i) {
      if (!following_->admits(from))
        continue;  // it was stored before another writer was followed
      if (writer)
        *writer = from;
      return true;
    }
    return false;
  }
  /// Loops that answer sample after sample turn to other work after this many.
  static constexpr int kMaxTakes = 64;

  Following& following() const noexcept { return *following_; }
  dds_instance_handle_t writer() const noexcept { return following_->writer(); }
  std::vector<Guid> matched() const { return reader_.matched(); }
  std::uint32_t matched_count() const noexcept { return reader_.matched_count(); }
  std::uint64_t deadlines_missed() const noexcept { return reader_.deadlines_missed(); }
  dds_entity_t condition() const noexcept { return reader_.condition(); }

 private:
  std::unique_ptr<Following> following_;  // outlives the reader, which asks it
  Reader<T> reader_;
};

}  // namespace voxtouch::bus
