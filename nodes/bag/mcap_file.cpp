/// A bag's file in MCAP, as rosbag2_storage_mcap writes it: profile ros2, embedded schemas, chunks
/// compressed by zstd with message indexes, and at the end chunk indexes, statistics and the bag's
/// metadata.
///
/// The file is a valid MCAP except during a write: each commit is one write of a chunk, the end of
/// the data and a footer without a summary, over the previous footer. After a kill any MCAP reader
/// opens the file and scans the chunks instead of the index. A kill during a write (0.1 ms each 200
/// ms) leaves a file without a footer: BagReader reads it up to its last complete chunk, and `mcap
/// recover` repairs it for others.
#include <fcntl.h>
#include <unistd.h>
#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <limits>
#include <map>
#include <utility>
#include <vector>

#include "core/types/version.hpp"
#include "nodes/bag/bag_file.hpp"
#include "nodes/bag/bag_storage.hpp"
#include "nodes/bag/mcap_format.hpp"
#include "nodes/bag/refuse.hpp"

namespace voxtouch::bag {
namespace {

using mcap::Bytes;
using mcap::Op;

constexpr int kZstdLevel = 1;
constexpr std::size_t kChunkBytes = std::size_t{1}
                                    << 20;  // as a chunk is at most, but for one large message

std::uint32_t crc_of(std::span<const std::byte> bytes) {
  return static_cast<std::uint32_t>(
      ::crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

void put_header(Bytes& out) {
  out.raw(std::as_bytes(std::span(mcap::kMagic)));
  const auto at = out.begin(Op::kHeader);
  out.text("ros2");
  out.text("voxtouch " + std::string(version()));
  out.end(at);
}

void put_schema(Bytes& out, std::uint16_t id, const TopicInfo& topic) {
  const auto at = out.begin(Op::kSchema);
  out.number(id);
  out.text(topic.type);
  out.text(topic.definition.empty() ? "" : "ros2msg");
  out.text(topic.definition);
  out.end(at);
}

void put_map(Bytes& out, const std::map<std::string, std::string>& map) {
  const std::size_t at = out.size();
  out.number(std::uint32_t{0});
  for (const auto& [key, value] : map)
    out.text(key), out.text(value);
  out.patch(at, static_cast<std::uint32_t>(out.size() - at - 4));
}

void put_channel(Bytes& out, std::uint16_t id, std::uint16_t schema, const TopicInfo& topic) {
  const auto at = out.begin(Op::kChannel);
  out.number(id);
  out.number(schema);
  out.text(topic.name);
  out.text(topic.serialization_format);
  std::map<std::string, std::string> fields{{"offered_qos_profiles", topic.offered_qos}};
  if (!topic.type_hash.empty())
    fields.emplace("topic_type_hash", topic.type_hash);
  put_map(out, fields);
  out.end(at);
}

void put_data_end(Bytes& out) {
  const auto at = out.begin(Op::kDataEnd);
  out.number(std::uint32_t{0});  // no checksum over all data
  out.end(at);
}

/// Behind the last data: nothing but that, and a footer that names no summary.
void put_end_without_summary(Bytes& out) {
  put_data_end(out);
  const auto footer = out.begin(Op::kFooter);
  out.number(std::uint64_t{0});
  out.number(std::uint64_t{0});
  out.number(std::uint32_t{0});
  out.end(footer);
  out.raw(std::as_bytes(std::span(mcap::kMagic)));
}

class McapFile final : public BagFile {
 public:
  McapFile(std::filesystem::path path, int file, std::uint64_t max_bytes)
      : path_(std::move(path)),
        file_(file),
        max_bytes_(max_bytes),
        zstd_(ZSTD_createCCtx()) {}
  McapFile(const McapFile&) = delete;
  McapFile& operator=(const McapFile&) = delete;
  ~McapFile() override {
    if (file_ >= 0)
      ::close(file_);
    ZSTD_freeCCtx(zstd_);
  }

  Result<void> begin() {
    if (zstd_ == nullptr)
      return refuse("Cannot write '{}': out of memory for the compression.", path_.string());
    Bytes out;
    put_header(out);
    // Without metadata Jazzy assumes its newest form of QoS texts. The final metadata, with counts,
    // follows it.
    BagMetadata metadata;
    metadata.storage_identifier = names_of(Storage::kMcap).name;
    put_metadata(out, metadata);
    return write(out);
  }

  Result<void> add_topic(const TopicInfo& topic) override {
    if (topics_.size() >= std::numeric_limits<std::uint16_t>::max())
      return refuse("'{}': too many topics, limit {}.", path_.string(), topics_.size());
    const auto known =
        std::ranges::find(topics_, topic.type, [](const Topic& one) { return one.info.type; });
    const bool is_new = known == topics_.end();
    const auto schema =
        static_cast<std::uint16_t>(is_new ? schemas_ + 1 : known->schema);  // 0 is none
    Bytes out;
    if (is_new)
      put_schema(out, schema, topic);
    put_channel(out, channel_of(topics_.size()), schema, topic);
    if (auto written = write(out); !written)
      return written;
    if (is_new)
      ++schemas_;
    topics_.push_back({topic, schema});
    return {};
  }

  Result<void> append(TopicId topic, std::int64_t time_ns,
                      std::span<const std::byte> bytes) override {
    const auto publish_time = static_cast<std::uint64_t>(time_ns);
    const std::uint64_t log_time = std::max(publish_time, mcap::kLogTimeOfZero);
    index_[topic].push_back({log_time, messages_.size()});
    const auto at = messages_.begin(Op::kMessage);
    messages_.number(channel_of(topic));
    messages_.number(std::uint32_t{0});  // rosbag2 does not count either
    messages_.number(log_time);
    messages_.number(publish_time);
    messages_.raw(bytes);
    messages_.end(at);
    return {};
  }

  bool pending() const noexcept override { return !index_.empty(); }
  bool is_full() const noexcept override { return messages_.size() >= kChunkBytes; }

  Result<void> commit() override {
    if (index_.empty())
      return {};
    const auto written = write_chunk();
    messages_.clear();
    index_.clear();
    return written;
  }

  Result<void> refresh(const BagMetadata&) override { return {}; }

  Result<void> close(const BagMetadata& metadata, Flush flush) override {
    auto result = commit();
    Bytes out;
    const std::uint64_t metadata_at = end_of_data_;
    put_metadata(out, metadata);
    const std::size_t metadata_size = out.size();
    put_data_end(out);
    put_summary(out, metadata_at, metadata_size);
    // Without space for it, the file stays valid, without a summary.
    if (auto ended = write_over_end(out); !ended && result)
      result = ended;
    if (flush == Flush::kYes && ::fsync(file_) != 0 && result)
      result = refused("flushed");
    if (::close(std::exchange(file_, -1)) != 0 && result)
      result = refused("closed");
    return result;
  }

  std::uint64_t bytes() const noexcept override { return end_of_data_; }

 private:
  struct Topic {
    TopicInfo info;
    std::uint16_t schema = 0;
    std::uint64_t messages = 0;
  };
  struct IndexEntry {
    std::uint64_t time_ns, offset;
  };
  struct Chunk {
    std::uint64_t start, end, at, size, index_size, compressed, uncompressed;
    std::vector<std::pair<std::uint16_t, std::uint64_t>>
        indexes;  // channel, and the offset of its index in the file
  };

  static std::uint16_t channel_of(std::size_t topic) noexcept {
    return static_cast<std::uint16_t>(topic + 1);
  }  // 0 is none to some readers
  std::unexpected<BagError> refused(std::string_view what) const {
    return refuse("'{}' cannot be {}: {}. Free disk space or choose another folder.",
                  path_.string(), what, std::strerror(errno));
  }

  /// `out`, at the end of the data. Error: the file is as before.
  Result<void> write_over_end(const Bytes& out) {
    auto written = write_at(end_of_data_, out.view());
    if (written)
      return {};
    (void)::ftruncate(file_, static_cast<off_t>(end_of_data_));
    Bytes end;
    put_end_without_summary(end);
    (void)write_at(
        end_of_data_,
        end.view());  // the space that was just freed suffices, unless another process used it
    return written;
  }
  /// Data, and a new end behind them, in one write.
  Result<void> write(Bytes& out) {
    const std::size_t size = out.size();
    put_end_without_summary(out);
    auto written = write_over_end(out);
    if (written)
      end_of_data_ += size;
    return written;
  }
  Result<void> write_at(std::uint64_t at, std::span<const std::byte> bytes) const {
    if (max_bytes_ > 0 && at + bytes.size() > max_bytes_)
      return refuse("'{}' is full, limit {} bytes.", path_.string(), max_bytes_);
    while (!bytes.empty()) {
      const ssize_t n = ::pwrite(file_, bytes.data(), bytes.size(), static_cast<off_t>(at));
      if (n < 0 && errno == EINTR)
        continue;
      if (n <= 0)
        return refused("written");
      bytes = bytes.subspan(static_cast<std::size_t>(n));
      at += static_cast<std::uint64_t>(n);
    }
    return {};
  }

  Result<void> write_chunk() {
    const std::size_t bound = ZSTD_compressBound(messages_.size());
    compressed_.resize(bound);
    const std::size_t compressed = ZSTD_compressCCtx(
        zstd_, compressed_.data(), bound, messages_.view().data(), messages_.size(), kZstdLevel);
    if (ZSTD_isError(compressed))
      return refuse("Cannot write '{}': {}.", path_.string(), ZSTD_getErrorName(compressed));
    Chunk chunk{.start = std::numeric_limits<std::uint64_t>::max(),
                .end = 0,
                .at = end_of_data_,
                .size = 0,
                .index_size = 0,
                .compressed = compressed,
                .uncompressed = messages_.size(),
                .indexes = {}};
    for (const auto& [topic, entries] : index_)
      for (const IndexEntry& entry : entries)
        chunk.start = std::min(chunk.start, entry.time_ns),
        chunk.end = std::max(chunk.end, entry.time_ns);
    Bytes out;
    const auto at = out.begin(Op::kChunk);
    out.number(chunk.start);
    out.number(chunk.end);
    out.number(chunk.uncompressed);
    out.number(crc_of(messages_.view()));
    out.text("zstd");
    out.number(static_cast<std::uint64_t>(compressed));
    out.raw(std::as_bytes(std::span(compressed_).first(compressed)));
    out.end(at);
    chunk.size = out.size();
    for (const auto& [topic, entries] : index_) {
      chunk.indexes.emplace_back(channel_of(topic), end_of_data_ + out.size());
      const auto index = out.begin(Op::kMessageIndex);
      out.number(channel_of(topic));
      out.number(static_cast<std::uint32_t>(entries.size() * 16));
      for (const IndexEntry& entry : entries)
        out.number(entry.time_ns), out.number(entry.offset);
      out.end(index);
    }
    chunk.index_size = out.size() - chunk.size;
    if (auto written = write(out); !written)
      return written;
    for (const auto& [topic, entries] : index_)
      topics_[topic].messages += entries.size();
    chunks_.push_back(std::move(chunk));
    return {};
  }

  static void put_metadata(Bytes& out, const BagMetadata& metadata) {
    const auto at = out.begin(Op::kMetadata);
    out.text("rosbag2");
    put_map(out, {{"serialized_metadata", metadata_yaml(metadata, false)}});
    out.end(at);
  }
  void put_statistics(Bytes& out) const {
    std::uint64_t messages = 0, start = std::numeric_limits<std::uint64_t>::max(), end = 0;
    for (const Topic& topic : topics_)
      messages += topic.messages;
    for (const Chunk& chunk : chunks_)
      start = std::min(start, chunk.start), end = std::max(end, chunk.end);
    const auto at = out.begin(Op::kStatistics);
    out.number(messages);
    out.number(static_cast<std::uint16_t>(schemas_));
    out.number(static_cast<std::uint32_t>(topics_.size()));
    out.number(std::uint32_t{0});  // attachments
    out.number(std::uint32_t{2});  // metadata
    out.number(static_cast<std::uint32_t>(chunks_.size()));
    out.number(messages > 0 ? start : 0);
    out.number(end);
    out.number(static_cast<std::uint32_t>(topics_.size() * 10));
    for (std::size_t i = 0; i < topics_.size(); ++i)
      out.number(channel_of(i)), out.number(topics_[i].messages);
    out.end(at);
  }
  static void put_chunk_index(Bytes& out, const Chunk& chunk) {
    const auto at = out.begin(Op::kChunkIndex);
    for (const std::uint64_t value : {chunk.start, chunk.end, chunk.at, chunk.size})
      out.number(value);
    out.number(static_cast<std::uint32_t>(chunk.indexes.size() * 10));
    for (const auto& [channel, place] : chunk.indexes)
      out.number(channel), out.number(place);
    out.number(chunk.index_size);
    out.text("zstd");
    out.number(chunk.compressed);
    out.number(chunk.uncompressed);
    out.end(at);
  }

  /// Records of one kind within the summary.
  struct Group {
    Op op;
    std::uint64_t at, size;
  };

  /// The summary's groups of records.
  std::vector<Group> put_groups(Bytes& out, std::uint64_t metadata_at,
                                std::size_t metadata_size) const {
    std::vector<Group> groups;
    const auto group = [&](Op op, const auto& put) {
      const std::size_t from = out.size();
      put();
      if (out.size() > from)
        groups.push_back({op, end_of_data_ + from, out.size() - from});
    };
    group(Op::kSchema, [&] {
      std::uint32_t put = 0;
      for (const Topic& topic : topics_)
        if (topic.schema > put)
          put_schema(out, topic.schema, topic.info), put = topic.schema;
    });
    group(Op::kChannel, [&] {
      for (std::size_t i = 0; i < topics_.size(); ++i)
        put_channel(out, channel_of(i), topics_[i].schema, topics_[i].info);
    });
    group(Op::kStatistics, [&] { put_statistics(out); });
    group(Op::kChunkIndex, [&] {
      for (const Chunk& chunk : chunks_)
        put_chunk_index(out, chunk);
    });
    group(Op::kMetadataIndex, [&] {
      const auto at = out.begin(Op::kMetadataIndex);
      out.number(metadata_at);
      out.number(static_cast<std::uint64_t>(metadata_size));
      out.text("rosbag2");
      out.end(at);
    });
    return groups;
  }

  /// The summary, the offsets of its groups, the footer, appended to the end of the data in `out`.
  void put_summary(Bytes& out, std::uint64_t metadata_at, std::size_t metadata_size) const {
    const std::size_t begin = out.size();
    const std::uint64_t start = end_of_data_ + begin;
    const std::vector<Group> groups = put_groups(out, metadata_at, metadata_size);
    const std::uint64_t offsets = end_of_data_ + out.size();
    for (const Group& one : groups) {
      const auto at = out.begin(Op::kSummaryOffset);
      out.number(static_cast<std::uint8_t>(one.op));
      out.number(one.at);
      out.number(one.size);
      out.end(at);
    }
    out.begin(Op::kFooter);
    const std::size_t footer = out.size() - mcap::kRecordHead;
    out.patch(footer + 1,
              std::uint64_t{mcap::kFooterSize - mcap::kRecordHead});  // which the checksum covers
    out.number(start);
    out.number(offsets);
    out.number(crc_of(out.view().subspan(begin)));
    out.raw(std::as_bytes(std::span(mcap::kMagic)));
  }

  std::filesystem::path path_;
  int file_;
  std::uint64_t max_bytes_;
  ZSTD_CCtx* zstd_;
  std::vector<char> compressed_;
  std::vector<Topic> topics_;
  std::uint32_t schemas_ = 0;
  std::uint64_t end_of_data_ = 0;  // of the file; followed by the end of a file without a summary
  std::vector<Chunk> chunks_;
  // Of the chunk that is filled:
  Bytes messages_;
  std::map<TopicId, std::vector<IndexEntry>> index_;
};

}  // namespace

Result<std::unique_ptr<BagFile>> make_mcap_file(const std::filesystem::path& path,
                                                std::uint64_t max_bytes) {
  const int descriptor = ::open(path.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0644);
  if (descriptor < 0)
    return refuse("Cannot create '{}': {}. Choose another folder.", path.string(),
                  std::strerror(errno));
  auto file = std::make_unique<McapFile>(path, descriptor, max_bytes);
  if (auto begun = file->begin(); !begun)
    return std::unexpected(begun.error());
  return file;
}

}  // namespace voxtouch::bag
