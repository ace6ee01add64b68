#include "nodes/bus/following.hpp"

#include <algorithm>

#include "nodes/bus/endpoint.hpp"

namespace voxtouch::bus {
namespace {

bool admit(const dds_sample_info_t* info, void* following) {
  return static_cast<Following*>(following)->admits(info->publication_handle);
}

void on_matched(dds_entity_t, const dds_subscription_matched_status_t status, void* following) {
  if (status.current_count_change < 0)
    static_cast<Following*>(following)->see_go(status.last_publication_handle);
}

}  // namespace

void Following::attach(dds_entity_t reader) {
  reader_ = reader;
  const std::unique_ptr<dds_listener_t, decltype(&dds_delete_listener)> listener(
      dds_create_listener(this), dds_delete_listener);
  dds_lset_subscription_matched(listener.get(), on_matched);
  if (dds_set_listener(reader, listener.get()) != DDS_RETCODE_OK)
    throw Error("cannot set a reader to watch departing writers");
}

void Following::see_go(dds_instance_handle_t writer) noexcept {
  if (writer == writer_.load(std::memory_order_acquire))
    has_gone_.store(true, std::memory_order_release);
}

dds_topic_filter Following::filter() noexcept {
  dds_topic_filter filter{};
  filter.mode = DDS_TOPIC_FILTER_SAMPLEINFO_ARG;
  filter.f.sampleinfo_arg = admit;
  filter.arg = this;
  return filter;
}

bool Following::admits(dds_instance_handle_t writer) noexcept {
  const dds_instance_handle_t followed = writer_.load(std::memory_order_acquire);
  // A latched value arrives once. After a network failure, the value of a rediscovered participant
  // may arrive while `follow` has not selected its new writer.
  const bool unbound =
      followed == 0 || (rule_ == WhileUnbound::kTakeAll &&
                        has_gone_.load(std::memory_order_acquire) && followed != writer);
  if (unbound)
    return rule_ == WhileUnbound::kTakeAll &&
           std::none_of(unwanted_.begin(), unwanted_.end(),
                        [&](const auto& one) { return one.load() == writer; });
  if (followed == writer)
    return true;
  refused_.fetch_add(1, std::memory_order_relaxed);
  for (Counted& one : counted_) {
    dds_instance_handle_t expected = 0;
    if (one.writer.compare_exchange_strong(expected, writer) || expected == writer) {
      one.count.fetch_add(1, std::memory_order_relaxed);
      break;
    }
  }
  return false;
}

void Following::refuse(dds_instance_handle_t writer) noexcept {
  unwanted_[unwanted_count_++ % unwanted_.size()].store(writer);
}

dds_instance_handle_t Following::writer_of(const Guid& participant) const {
  dds_instance_handle_t found = 0;
  for (const dds_instance_handle_t writer : matched_writer_handles(reader_))
    if (participant_of_writer(reader_, writer) == participant)
      found = writer;
  return found;
}

bool Following::follow(const Guid& participant) {
  const dds_instance_handle_t found = writer_of(participant);
  writer_.store(found, std::memory_order_release);
  has_gone_.store(false, std::memory_order_release);
  if (found != 0 && !has_writer())
    has_gone_.store(true, std::memory_order_release);  // since it was selected
  return found != 0;
}

bool Following::has_matched(const Guid& participant) const {
  for (const Guid& other : matched_writers(reader_))
    if (other == participant)
      return true;
  return false;
}

bool Following::has_writer() const {
  const dds_instance_handle_t followed = writer();
  return followed != 0 && writer_is_matched(reader_, followed);
}

std::vector<RefusedSamples> Following::take_refused() {
  std::vector<RefusedSamples> all;
  for (Counted& one : counted_) {
    const std::uint64_t count = one.count.exchange(0, std::memory_order_relaxed);
    if (count == 0)
      continue;
    const dds_instance_handle_t writer = one.writer.load();
    Guid& participant = participants_[writer];
    if (participant == Guid{})
      participant = participant_of_writer(reader_, writer);
    all.push_back({participant, count});
  }
  return all;
}

}  // namespace voxtouch::bus
