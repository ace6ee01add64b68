#pragma once
/// Of a node that may have a standby, or is one: whether it answers this sample, or leaves it to
/// the other one.
#include <algorithm>
#include <atomic>
#include <memory>
#include <string>

#include "nodes/bus/followed_reader.hpp"
#include "nodes/runtime/acting_pair.hpp"
#include "nodes/runtime/standby.hpp"

namespace voxtouch::runtime {

/// The slow half: who the other one is. One thread, the housekeeping's. A node that has no standby
/// and is none says nothing and reads nothing.
class DutyBase {
 public:
  DutyBase(const bus::Participant& participant, std::string role, const StandbyOptions& options,
           SameIn same)
      : participant_(participant),
        role_(std::move(role)),
        options_(options),
        pair_(!options.is_standby, options.unanswered),
        same_(std::move(same)),
        acts_now_(!options.is_standby),
        entitled_(!options.is_standby) {}
  virtual ~DutyBase() = default;

  /// Once a look, when everything else of the report is filled in. A sentence for people where
  /// there is something to say.
  std::string look(const NodeRegistry& registry, NodeReport& report);
  /// Whether it was this node that answered last, or that has yet to. Any thread; real-time safe.
  bool acts_now() const noexcept { return acts_now_.load(std::memory_order_acquire); }

 protected:
  /// Of the reader of the other's answers; made when it is first asked for.
  virtual bus::Following& others() = 0;
  virtual bool reads_others() const noexcept = 0;
  void begin(std::uint64_t session) noexcept;
  void hear(std::uint64_t theirs, std::uint64_t newest) noexcept {
    pair_.hear(theirs, newest, known_of_pair());
  }
  bool decide(std::uint64_t sequence, bool fit) noexcept;
  void count_answer() noexcept { answers_.fetch_add(1, std::memory_order_relaxed); }

  const bus::Participant& participant_;
  const std::string role_;
  const StandbyOptions options_;
  // Of the loop.
  ActingPair pair_;
  std::uint64_t session_ = 0;

 private:
  std::string look_as_acting(const NodeRegistry& registry, NodeReport& report);
  std::string look_as_standby(const NodeRegistry& registry, NodeReport& report);
  ActingPair::Known known_of_pair() const noexcept {
    return {entitled_.load(std::memory_order_acquire), yields_.load(std::memory_order_relaxed)};
  }
  bool may_take_another() const noexcept;
  void follow(const bus::Guid& other);
  bool yields_to(const NodeReport& other) const;

  const SameIn same_;
  std::optional<bus::Guid> other_;
  std::uint64_t place_session_ = 0;  ///< in which somebody has stood by
  int unlike_looks_ = 0;
  // Between the two threads.
  std::atomic<bool> acts_now_;
  std::atomic<bool> entitled_;       ///< to take over: it has acted, or the acting one has named it
  std::atomic<bool> yields_{false};  ///< to the other one, where both answer at once
  std::atomic<bool> stand_back_{false};  ///< asked by the housekeeping: somebody acts already
  std::atomic<std::uint64_t> answers_{0}, takeovers_{0}, taken_over_at_{0}, stepped_back_{0};
};

/// T: what the role answers, with session_id and sequence_number.
template <class T>
class Duty final : public DutyBase {
 public:
  Duty(const bus::Participant& participant, const qos::Topic& row, std::string_view rig,
       std::string role, const StandbyOptions& options, SameIn same)
      : DutyBase(participant, std::move(role), options, std::move(same)),
        row_(row),
        rig_(rig) {
    if (options.is_standby)
      Duty::others();
  }

  /// From the loop, where the answer to a sample is ready: whether it is to be sent. `f(const T&)`
  /// is called for each of the other's answers of this session that have come since. `fit`, which
  /// `f` may set: only then does it take over. Real-time safe.
  template <class F>
  bool acts(std::uint64_t session, std::uint64_t sequence, F&& f,
            const std::atomic<bool>* fit = nullptr) noexcept {
    if (session != session_)
      begin(session);
    bus::FollowedReader<T>* const reader = reader_.load(std::memory_order_acquire);
    if (!reader)
      return count_answer(), true;  // neither has a standby nor is one
    T answer;
    for (int i = 0; i < bus::FollowedReader<T>::kMaxTakes && reader->take(answer); ++i) {
      if (answer.session_id != session)
        continue;
      f(static_cast<const T&>(answer));
      hear(answer.sequence_number, sequence);
    }
    return decide(sequence, !fit || fit->load(std::memory_order_acquire));
  }

 private:
  bus::Following& others() override {
    if (!made_) {
      made_ = std::make_unique<bus::FollowedReader<T>>(
          participant_, row_, rig_, qos::profile_in(row_, qos::TimeMode::kRealTime));
      reader_.store(made_.get(), std::memory_order_release);
    }
    return made_->following();
  }
  bool reads_others() const noexcept override {
    return reader_.load(std::memory_order_acquire) != nullptr;
  }

  const qos::Topic& row_;
  const std::string rig_;
  std::unique_ptr<bus::FollowedReader<T>> made_;
  std::atomic<bus::FollowedReader<T>*> reader_{nullptr};
};

}  // namespace voxtouch::runtime
