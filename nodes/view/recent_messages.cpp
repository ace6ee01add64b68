#include "nodes/view/recent_messages.hpp"

#include <algorithm>
#include <system_error>

#include "nodes/bag/bag_writer.hpp"

namespace voxtouch::view {
namespace {

bag::Result<void> fill(bag::BagWriter& writer, const std::vector<bag::TopicInfo>& topics,
                       const std::vector<RecentMessage>& messages) {
  for (const bag::TopicInfo& topic : topics)
    if (const auto added = writer.add_topic(topic); !added)
      return std::unexpected(added.error());
  for (const RecentMessage& message : messages)
    if (auto added = writer.append(static_cast<bag::TopicId>(message.topic), message.written_ns,
                                   message.bytes);
        !added)
      return added;
  if (auto committed = writer.commit(); !committed)
    return committed;
  bag::RecordingReport report;
  report.closed = true;
  for (const bag::TopicInfo& topic : topics)
    report.topics.push_back({.name = topic.name});
  writer.fill_counts(report.topics);
  for (bag::TopicReport& topic : report.topics)
    topic.received = topic.written;
  if (auto reported = writer.report(report); !reported)
    return reported;
  return writer.close();
}

}  // namespace

void RecentMessages::add(std::size_t topic, std::int64_t written_ns,
                         std::span<const std::byte> bytes) {
  messages_.push_back({topic, written_ns, {bytes.begin(), bytes.end()}});
  bytes_ += bytes.size();
  newest_ns_ = std::max(newest_ns_, written_ns);
  while (messages_.size() > 1 &&
         (messages_.front().written_ns < newest_ns_ - kKeptNs || bytes_ > kMaxBytes)) {
    RecentMessage& first = messages_.front();
    bytes_ -= first.bytes.size();
    if (latched_[first.topic])
      values_[first.topic] = std::move(first);
    messages_.pop_front();
  }
}

std::vector<RecentMessage> RecentMessages::all() const {
  std::vector<RecentMessage> found;
  std::vector<std::optional<RecentMessage>> values = values_;
  for (const RecentMessage& message : messages_)
    if (message.written_ns >= newest_ns_ - kKeptNs)
      found.push_back(message);
    else if (latched_[message.topic])  // written before this reader came
      values[message.topic] = message;
  std::ranges::stable_sort(found, {}, &RecentMessage::written_ns);
  if (found.empty())
    return found;
  std::vector<RecentMessage> all;
  for (std::optional<RecentMessage>& value : values)
    if (value) {
      value->written_ns = found.front().written_ns;
      all.push_back(std::move(*value));
    }
  all.insert(all.end(), std::make_move_iterator(found.begin()),
             std::make_move_iterator(found.end()));
  return all;
}

bag::Result<void> write_recording(const std::filesystem::path& folder,
                                  const std::vector<bag::TopicInfo>& topics,
                                  const std::vector<RecentMessage>& messages) {
  auto writer = bag::BagWriter::create(folder, {.folder_is_made = true});
  bag::Result<void> written =
      writer ? fill(*writer, topics, messages) : bag::Result<void>(std::unexpected(writer.error()));
  if (writer && !written) {
    (void)writer->close();
    std::error_code ignored;
    std::filesystem::remove_all(folder, ignored);
  }
  return written;
}

}  // namespace voxtouch::view
