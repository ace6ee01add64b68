/// Reads MCAP files, ours and those of rosbag2_storage_mcap: chunks in zstd or uncompressed, or
/// messages without chunks. It uses the summary. Without one, as after a kill, it scans the file up
/// to its last complete record.
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <limits>
#include <list>
#include <map>
#include <queue>
#include <string>

#include "nodes/bag/file_reader.hpp"
#include "nodes/bag/mcap_format.hpp"
#include "nodes/bag/refuse.hpp"

namespace voxtouch::bag {
namespace {

using mcap::Cursor;
using mcap::Op;

constexpr std::uint64_t kMaxChunkBytes = std::uint64_t{1}
                                         << 30;  // uncompressed; a larger claim means damage
constexpr std::uint64_t kMaxDescriptionBytes = std::uint64_t{1} << 28;  // of a summary, of a schema
constexpr std::uint64_t kLooseBytes =
    std::uint64_t{1} << 20;  // messages without a chunk are taken together up to this size

class Descriptor {
 public:
  explicit Descriptor(int number) noexcept : number_(number) {}
  Descriptor(Descriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  Descriptor& operator=(Descriptor&&) = delete;
  ~Descriptor() {
    if (number_ >= 0)
      ::close(number_);
  }
  int get() const noexcept { return number_; }

 private:
  int number_;
};

/// Bytes that are not cleared before they are read.
struct Buffer {
  std::unique_ptr<std::byte[]> data;
  std::size_t size = 0;
  explicit Buffer(std::uint64_t requested)
      : data(std::make_unique_for_overwrite<std::byte[]>(static_cast<std::size_t>(requested))),
        size(static_cast<std::size_t>(requested)) {}
  std::span<const std::byte> view() const noexcept { return {data.get(), size}; }
};

/// Messages that are read together: a chunk, or consecutive ones outside chunks.
struct Piece {
  std::uint64_t at = 0,
                size = 0;  ///< in the file; of a chunk's record, or of all messages' records
  std::uint64_t start = 0, end = 0;  ///< log times
  bool loose = false;
  std::int64_t number = 0;  ///< in the order of the file
};

struct Entry {
  std::int64_t time_ns, id;
  std::size_t topic;
  std::span<const std::byte> bytes;
  auto order() const noexcept { return std::pair(time_ns, id); }
};
struct DecodedPiece {
  Buffer bytes{0};
  std::vector<Entry> entries;  ///< by time, then by position in the file
};

std::int64_t time_of(std::uint64_t log_time, std::uint64_t publish_time) noexcept {
  if (log_time == mcap::kLogTimeOfZero && publish_time == 0)
    return 0;
  return static_cast<std::int64_t>(
      std::min<std::uint64_t>(log_time, std::numeric_limits<std::int64_t>::max()));
}
/// As early as a message of this log time may be.
std::int64_t earliest(std::uint64_t log_time) noexcept { return time_of(log_time, 0); }

class McapReader final : public FileReader {
 public:
  McapReader(std::filesystem::path path, Descriptor file, std::uint64_t size)
      : path_(std::move(path)),
        file_(std::move(file)),
        size_(size) {}

  Result<void> open() {
    Buffer head(std::min<std::uint64_t>(size_, mcap::kMagic.size() + mcap::kRecordHead));
    if (auto read = read_at(0, head); !read)
      return read;
    Cursor cursor(head.view());
    const auto magic = cursor.take(mcap::kMagic.size());
    if (!std::ranges::equal(magic, std::as_bytes(std::span(mcap::kMagic))))
      return damaged("no MCAP magic at the start");
    if (static_cast<Op>(cursor.number<std::uint8_t>()) != Op::kHeader)
      return damaged("no header");
    data_start_ = head.size + cursor.number<std::uint64_t>();
    if (!read_summary()) {
      topics_.clear(), topic_of_.clear(), schemas_.clear(), pieces_.clear(), messages_ = 0;
      if (auto looked = scan(); !looked)
        return looked;
    }
    std::ranges::sort(pieces_, {}, &Piece::at);
    for (std::int64_t number = 0; Piece & piece : pieces_)
      piece.number = number++;
    std::ranges::stable_sort(pieces_, {}, &Piece::start);
    return {};
  }

  Result<bool> for_each_between(std::int64_t from_ns, std::int64_t to_ns,
                                const TakeMessage& f) const override {
    struct Place {
      std::shared_ptr<const DecodedPiece> piece;
      std::size_t at;
      const Entry& entry() const noexcept { return piece->entries[at]; }
    };
    const auto later = [](const Place& a, const Place& b) {
      return a.entry().order() > b.entry().order();
    };
    std::priority_queue<Place, std::vector<Place>, decltype(later)> places(later);
    auto next = pieces_.begin();
    while (true) {
      // A piece that begins after the next message holds none before it.
      while (next != pieces_.end() && earliest(next->start) < to_ns &&
             (places.empty() || earliest(next->start) <= places.top().entry().time_ns)) {
        const auto ordinal = next++ - pieces_.begin();
        if (static_cast<std::int64_t>(
                std::min<std::uint64_t>(pieces_[static_cast<std::size_t>(ordinal)].end,
                                        std::numeric_limits<std::int64_t>::max())) < from_ns)
          continue;
        auto piece = decoded(static_cast<std::size_t>(ordinal));
        if (!piece)
          return std::unexpected(piece.error());
        const auto first =
            std::ranges::lower_bound((*piece)->entries, from_ns, {}, &Entry::time_ns);
        if (first != (*piece)->entries.end())
          places.push({*piece, static_cast<std::size_t>(first - (*piece)->entries.begin())});
      }
      if (places.empty() && (next == pieces_.end() || earliest(next->start) >= to_ns))
        return true;
      if (places.empty())
        continue;
      Place place = places.top();
      places.pop();
      const Entry& entry = place.entry();
      if (entry.time_ns >= to_ns)
        continue;
      if (!f({entry.topic, entry.time_ns, entry.id, entry.bytes}))
        return false;
      if (++place.at < place.piece->entries.size())
        places.push(std::move(place));
    }
  }

  Result<std::optional<std::pair<std::int64_t, std::int64_t>>> times() const override {
    std::optional<std::pair<std::int64_t, std::int64_t>> all;
    for (const Piece& piece : pieces_) {
      if (piece.end == 0)
        continue;  // a chunk without messages
      const std::pair own{earliest(piece.start), earliest(piece.end)};
      all =
          all ? std::pair{std::min(all->first, own.first), std::max(all->second, own.second)} : own;
    }
    return all;
  }

  std::optional<std::uint64_t> message_count() const override { return messages_; }

 private:
  std::unexpected<BagError> damaged(std::string_view how) const {
    return refuse(
        "'{}' is damaged or not an MCAP file: {}. `mcap recover` restores intact messages.",
        path_.string(), how);
  }
  Result<void> read_at(std::uint64_t at, Buffer& into) const {
    for (std::size_t done = 0; done < into.size;) {
      const ssize_t n = ::pread(file_.get(), into.data.get() + done, into.size - done,
                                static_cast<off_t>(at + done));
      if (n < 0 && errno == EINTR)
        continue;
      if (n < 0)
        return refuse("Cannot read '{}': {}.", path_.string(), std::strerror(errno));
      if (n == 0)
        return damaged("truncated");
      done += static_cast<std::size_t>(n);
    }
    return {};
  }

  /// Reads schemas and channels at any position.
  void take_description(const mcap::Record& record) {
    Cursor in(record.content);
    const auto id = in.number<std::uint16_t>();
    if (record.op == Op::kSchema) {
      TopicInfo& schema = schemas_[id];
      schema.type = in.text();
      const bool known = in.text() == "ros2msg";
      if (const auto text = in.text(); known)
        schema.definition = text;
    } else if (record.op == Op::kChannel && !topic_of_.contains(id)) {
      TopicInfo topic = schemas_[in.number<std::uint16_t>()];
      topic.name = in.text();
      topic.serialization_format = in.text();
      for (Cursor map(in.take(in.number<std::uint32_t>())); !map.empty();) {
        const auto key = map.text(), value = map.text();
        if (key == "offered_qos_profiles")
          topic.offered_qos = value;
        if (key == "topic_type_hash")
          topic.type_hash = value;
      }
      if (!in.good())
        return;
      const auto known = std::ranges::find(topics_, topic.name, &TopicInfo::name);
      topic_of_[id] = static_cast<std::size_t>(known - topics_.begin());
      if (known == topics_.end())
        topics_.push_back(std::move(topic));
    }
  }

  /// False without a usable summary.
  bool read_summary() {
    const std::size_t tail_size = mcap::kFooterSize + mcap::kMagic.size();
    if (size_ < data_start_ + tail_size)
      return false;
    Buffer tail(tail_size);
    if (!read_at(size_ - tail_size, tail))
      return false;
    Cursor cursor(tail.view());
    const auto footer = mcap::next_record(cursor);
    if (!footer || footer->op != Op::kFooter ||
        !std::ranges::equal(cursor.rest(), std::as_bytes(std::span(mcap::kMagic))))
      return false;
    Cursor in(footer->content);
    const auto start = in.number<std::uint64_t>();
    in.number<std::uint64_t>();
    const auto crc = in.number<std::uint32_t>();
    const std::uint64_t end = size_ - tail_size;
    if (!in.good() || start < data_start_ || start >= end || end - start > kMaxDescriptionBytes)
      return false;
    Buffer summary(end - start + mcap::kFooterSize - 4);  // range of the checksum
    if (!read_at(start, summary))
      return false;
    if (crc != 0 &&
        ::crc32_z(0, reinterpret_cast<const Bytef*>(summary.data.get()), summary.size) != crc)
      return false;
    Cursor records(summary.view().first(static_cast<std::size_t>(end - start)));
    messages_.reset();
    while (const auto record = mcap::next_record(records)) {
      Cursor content(record->content);
      if (record->op == Op::kStatistics)
        messages_ = content.number<std::uint64_t>();
      if (record->op == Op::kChunkIndex) {
        Piece piece;
        piece.start = content.number<std::uint64_t>(), piece.end = content.number<std::uint64_t>();
        piece.at = content.number<std::uint64_t>(), piece.size = content.number<std::uint64_t>();
        if (!content.good() || piece.at < data_start_ || piece.size > size_ ||
            piece.at > size_ - piece.size)
          return false;
        pieces_.push_back(piece);
      }
      take_description(*record);
    }
    return records.empty() && !topics_.empty() && (messages_.value_or(0) == 0 || !pieces_.empty());
  }

  Result<void> scan() {
    std::uint64_t at = data_start_;
    Piece loose;
    const auto put_loose = [&] {
      if (loose.size > 0)
        pieces_.push_back(loose);
      loose = {};
    };
    while (at + mcap::kRecordHead <= size_) {
      Buffer head(std::min<std::uint64_t>(size_ - at, mcap::kRecordHead + mcap::kMessageHead));
      if (auto read = read_at(at, head); !read)
        return read;
      Cursor in(head.view());
      const auto op = static_cast<Op>(in.number<std::uint8_t>());
      const auto length = in.number<std::uint64_t>();
      if (length > size_ - at - mcap::kRecordHead)
        break;  // the last one is not whole
      const std::uint64_t size = mcap::kRecordHead + length;
      if (op == Op::kDataEnd || op == Op::kFooter || static_cast<std::uint8_t>(op) == 0)
        break;
      if (op == Op::kSchema || op == Op::kChannel) {
        if (length > kMaxDescriptionBytes)
          return damaged("description too long");
        Buffer content(length);
        if (auto read = read_at(at + mcap::kRecordHead, content); !read)
          return read;
        take_description({op, content.view()});
      } else if (op == Op::kChunk) {
        put_loose();
        Piece piece{.at = at,
                    .size = size,
                    .start = in.number<std::uint64_t>(),
                    .end = in.number<std::uint64_t>(),
                    .loose = false};
        const auto content = contents(piece);  // it may contain schemas and channels
        if (!content && pieces_.empty())
          return std::unexpected(content.error());
        if (!content)
          break;  // nothing behind a damaged chunk can be trusted
        Cursor records(content->view());
        std::uint64_t messages = 0;
        while (const auto record = mcap::next_record(records)) {
          take_description(*record);
          messages += record->op == Op::kMessage;
        }
        *messages_ += messages;
        if (messages > 0)
          pieces_.push_back(piece);
      } else if (op == Op::kMessage && length >= mcap::kMessageHead) {
        ++*messages_;
        in.take(2 + 4);
        const auto time = in.number<std::uint64_t>();
        if (loose.size == 0)
          loose = {.at = at, .size = 0, .start = time, .end = time, .loose = true};
        loose.start = std::min(loose.start, time), loose.end = std::max(loose.end, time);
        loose.size = at + size - loose.at;  // including the records between
        if (loose.size >= kLooseBytes)
          put_loose();
      }
      at += size;
    }
    put_loose();
    return {};
  }

  /// The records of a piece, uncompressed.
  Result<Buffer> contents(const Piece& piece) const {
    if (piece.size > kMaxChunkBytes)
      return damaged("chunk too large");
    Buffer raw(piece.size);
    if (auto read = read_at(piece.at, raw); !read)
      return std::unexpected(read.error());
    if (piece.loose)
      return raw;
    Cursor cursor(raw.view());
    const auto record = mcap::next_record(cursor);
    if (!record || record->op != Op::kChunk)
      return damaged("no chunk at the indexed position");
    Cursor in(record->content);
    in.take(8 + 8);
    const auto size = in.number<std::uint64_t>();
    const auto crc = in.number<std::uint32_t>();
    const auto compression = in.text();
    const auto packed = in.take(in.number<std::uint64_t>());
    if (!in.good() || size > kMaxChunkBytes)
      return damaged("incomplete chunk");
    Buffer out(size);
    if (compression.empty()) {
      if (packed.size() != size)
        return damaged("incomplete chunk");
      std::ranges::copy(packed, out.data.get());
    } else if (compression == "zstd") {
      const std::size_t got =
          ZSTD_decompress(out.data.get(), out.size, packed.data(), packed.size());
      if (ZSTD_isError(got) || got != size)
        return damaged("chunk cannot be uncompressed");
    } else {
      return refuse(
          "'{}' has compression {}, supported: zstd. Convert it with `mcap compress --compression "
          "zstd`.",
          path_.string(), compression);
    }
    if (crc != 0 && ::crc32_z(0, reinterpret_cast<const Bytef*>(out.data.get()), out.size) != crc)
      return damaged("chunk checksum mismatch");
    return out;
  }

  /// Keeps the last few: a player requests the same chunk repeatedly.
  Result<std::shared_ptr<const DecodedPiece>> decoded(std::size_t ordinal) const {
    const auto kept = std::ranges::find(kept_, ordinal, [](const auto& one) { return one.first; });
    if (kept != kept_.end())
      return kept->second;
    auto bytes = contents(pieces_[ordinal]);
    if (!bytes)
      return std::unexpected(bytes.error());
    auto piece = std::make_shared<DecodedPiece>();
    piece->bytes = std::move(*bytes);
    Cursor records(piece->bytes.view());
    // Their position in the file is the order of arrival. A piece of kMaxChunkBytes has fewer than
    // 2^32 messages.
    for (std::int64_t n = pieces_[ordinal].number << 32;
         const auto record = mcap::next_record(records); ++n) {
      if (record->op != Op::kMessage)
        continue;
      Cursor in(record->content);
      const auto topic = topic_of_.find(in.number<std::uint16_t>());
      in.number<std::uint32_t>();
      const auto log_time = in.number<std::uint64_t>(), publish_time = in.number<std::uint64_t>();
      if (!in.good() || topic == topic_of_.end())
        continue;
      piece->entries.push_back({time_of(log_time, publish_time), n, topic->second, in.rest()});
    }
    std::ranges::sort(piece->entries, {}, &Entry::order);
    kept_.emplace_front(ordinal, piece);
    if (kept_.size() > kKept)
      kept_.pop_back();
    return piece;
  }

  static constexpr std::size_t kKept = 4;
  std::filesystem::path path_;
  Descriptor file_;
  std::uint64_t size_, data_start_ = 0;
  std::map<std::uint16_t, TopicInfo> schemas_;  // type and definition
  std::map<std::uint16_t, std::size_t> topic_of_;
  std::vector<Piece> pieces_;              // by start
  std::optional<std::uint64_t> messages_;  // empty if the summary has no statistics
  mutable std::list<std::pair<std::size_t, std::shared_ptr<const DecodedPiece>>> kept_;
};

}  // namespace

bool is_mcap(const std::filesystem::path& path) {
  const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  char magic[8] = {};
  return file.get() >= 0 && ::pread(file.get(), magic, sizeof magic, 0) == sizeof magic &&
         std::string_view(magic, sizeof magic) == mcap::kMagic;
}

Result<std::unique_ptr<FileReader>> open_mcap_file(const std::filesystem::path& path) {
  Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  struct stat about {};
  if (file.get() < 0 || ::fstat(file.get(), &about) != 0)
    return refuse("Cannot read '{}': {}.", path.string(), std::strerror(errno));
  auto reader = std::make_unique<McapReader>(path, std::move(file),
                                             static_cast<std::uint64_t>(about.st_size));
  if (auto opened = reader->open(); !opened)
    return std::unexpected(opened.error());
  return reader;
}

}  // namespace voxtouch::bag
