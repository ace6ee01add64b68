#pragma once
/// A reader of what a role answers, of which there may be two: the one that acts, and its standby.
#include <atomic>
#include <memory>

#include "nodes/bus/followed_reader.hpp"
#include "nodes/bus/wait_set.hpp"
#include "nodes/runtime/failover.hpp"

namespace voxtouch::runtime {

/// What a RoleBinding needs of one, whatever it reads: who is in which place. All but `acting` of
/// the housekeeping's thread.
class PairInput {
 public:
  using Place = Failover::Place;
  virtual ~PairInput() = default;
  /// Whose samples the place takes in; the second place is made when it is first asked for. Throws
  /// bus::Error.
  virtual bus::Following& place(Place place) = 0;
  /// Null where the second place has never been asked for.
  virtual bus::Following* place_if_made(Place place) noexcept = 0;
  /// As the loop sees it.
  virtual Place acting() const noexcept = 0;
  virtual std::uint64_t fenced()
      const noexcept = 0;  ///< answers of the one that does not act, which were refused
  virtual std::uint64_t takeovers() const noexcept = 0;  ///< how often the other one took over
  virtual std::uint64_t last_takeover()
      const noexcept = 0;  ///< the sample that the other one answered first
};

/// For fixed-size types with session_id and sequence_number. Without a standby a reader as
/// FollowedReader is: the second place is a reader of its own, so that what one of the two writes
/// takes no place in the history of the other.
template <class T>
class PairReader final : public PairInput {
 public:
  PairReader(const bus::Participant& participant, const qos::Topic& row, std::string_view rig,
             const qos::Profile& profile)
      : participant_(participant),
        row_(row),
        rig_(rig),
        profile_(profile),
        first_(participant, row, rig, profile) {}

  /// The loop that waits there wakes up for both places.
  void attach_to(bus::WaitSet& wait_set) {
    wait_set_ = &wait_set;
    wait_set.attach(first_.condition());
  }

  /// The loop's thread, real-time safe as FollowedReader::take. A session of its own: nothing of it
  /// has been answered.
  void begin_session(std::uint64_t session) noexcept {
    session_ = session;
    failover_.begin();
  }
  /// The next answer to act on. `newest`: the last sample that there is, where that is known; who
  /// answers one that is not there yet takes over nothing.
  bool take(T& sample, dds_instance_handle_t* writer = nullptr,
            std::uint64_t newest = ~std::uint64_t{0}) noexcept {
    bus::FollowedReader<T>* const second = second_.load(std::memory_order_acquire);
    if (!second) {
      if (!first_.take(sample, writer))
        return false;
      if (sample.session_id == session_ && sample.sequence_number <= newest)
        failover_.hear(Place::kFirst, sample.sequence_number);
      return true;
    }
    bus::FollowedReader<T>* const readers[] = {&first_, second};
    for (const Place place : {failover_.acting(), other_than(failover_.acting())})
      for (int i = 0; i < kMaxTakes && readers[index(place)]->take(sample, writer); ++i)
        if (admits(place, sample, newest))
          return true;
    return false;
  }
  static constexpr int kMaxTakes = bus::FollowedReader<T>::kMaxTakes;

  /// Of the one that acts; 0: nobody's.
  dds_instance_handle_t writer() const noexcept { return acting_reader().writer(); }
  std::uint64_t deadlines_missed() const noexcept { return acting_reader().deadlines_missed(); }
  std::vector<bus::Guid> matched() const { return first_.matched(); }  // either has matched all
  std::uint32_t matched_count() const noexcept { return first_.matched_count(); }
  bus::Following& following() const noexcept { return first_.following(); }

  bus::Following& place(Place place) override {
    if (place == Place::kFirst)
      return first_.following();
    if (!made_) {
      made_ = std::make_unique<bus::FollowedReader<T>>(participant_, row_, rig_, profile_);
      if (wait_set_)
        wait_set_->attach(made_->condition());
      second_.store(made_.get(), std::memory_order_release);
    }
    return made_->following();
  }
  bus::Following* place_if_made(Place place) noexcept override {
    return place == Place::kFirst ? &first_.following() : made_ ? &made_->following() : nullptr;
  }
  Place acting() const noexcept override { return acting_.load(std::memory_order_acquire); }
  std::uint64_t fenced() const noexcept override { return fenced_.load(std::memory_order_relaxed); }
  std::uint64_t takeovers() const noexcept override {
    return takeovers_.load(std::memory_order_relaxed);
  }
  std::uint64_t last_takeover() const noexcept override {
    return last_takeover_.load(std::memory_order_relaxed);
  }

 private:
  static std::size_t index(Place place) noexcept { return place == Place::kFirst ? 0 : 1; }
  const bus::FollowedReader<T>& acting_reader() const noexcept {
    const bus::FollowedReader<T>* const second = second_.load(std::memory_order_acquire);
    return second && acting() == Place::kSecond ? *second : first_;
  }
  /// What the acting one says of another session or of a sample that is not there is for who reads
  /// to judge, as ever.
  bool admits(Place place, const T& sample, std::uint64_t newest) noexcept {
    if (sample.session_id != session_ || sample.sequence_number > newest) {
      if (place != failover_.acting())
        return fenced_.fetch_add(1, std::memory_order_relaxed), false;
      return true;
    }
    switch (failover_.hear(place, sample.sequence_number)) {
      case Failover::Verdict::kTaken:
        return true;
      case Failover::Verdict::kTakenOver:
        takeovers_.fetch_add(1, std::memory_order_relaxed);
        last_takeover_.store(sample.sequence_number, std::memory_order_relaxed);
        acting_.store(place, std::memory_order_release);
        return true;
      case Failover::Verdict::kFenced:
        fenced_.fetch_add(1, std::memory_order_relaxed);
        return false;
      case Failover::Verdict::kOld:
        return false;
    }
    return false;
  }

  const bus::Participant& participant_;
  const qos::Topic& row_;
  std::string rig_;
  const qos::Profile& profile_;
  bus::WaitSet* wait_set_ = nullptr;
  bus::FollowedReader<T> first_;
  std::unique_ptr<bus::FollowedReader<T>> made_;  ///< the second place, of the housekeeping ...
  std::atomic<bus::FollowedReader<T>*> second_{nullptr};  ///< ... and as the loop sees it
  // Of the loop.
  std::uint64_t session_ = 0;
  Failover failover_;
  // From the loop to others.
  std::atomic<Place> acting_{Place::kFirst};
  std::atomic<std::uint64_t> fenced_{0}, takeovers_{0}, last_takeover_{0};
};

}  // namespace voxtouch::runtime
