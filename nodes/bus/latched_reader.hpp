#pragma once
/// Reader of a latched control topic. It keeps the last value of several writers until one of them
/// is selected.
#include <algorithm>
#include <memory>
#include <vector>

#include "nodes/bus/following.hpp"
#include "nodes/bus/reader.hpp"
#include "nodes/bus/serdata.hpp"

namespace voxtouch::bus {

/// Values are stored in wire form. Allocates, as DDS does for types with strings.
template <class T>
class LatchedReader {
 public:
  LatchedReader() = default;
  LatchedReader(const Participant& participant, const qos::Topic& row, std::string_view rig)
      : following_(std::make_unique<Following>(Following::WhileUnbound::kTakeAll)),
        // Latched QoS, but with a deep history, because all writers use it.
        reader_(participant, row, rig, qos::profile(qos::ProfileId::kStatus), following_.get()) {}

  /// Calls f(const T&) if the followed writer has a value that f has not received; only the newest
  /// is passed. Returns true if f was called. A repeated equal value is not new. Examines at most
  /// kMaxTakes samples.
  template <class F>
  bool take(F&& f) {
    receive();
    const dds_instance_handle_t writer = following_->writer();
    if (writer != last_writer_)
      shown_.clear();
    last_writer_ = writer;
    if (writer == 0)
      return false;
    const auto kept = find(writer);
    if (kept == kept_.end() || kept->bytes == shown_)
      return false;
    shown_ = kept->bytes;
    T value{};
    const bool whole = ddsi_serdata_to_sample(kept->data.get(), &value, nullptr, nullptr);
    if (whole)
      f(static_cast<const T&>(value));
    dds_sample_free(&value, msg::Type<T>::descriptor, DDS_FREE_CONTENTS);
    return whole;
  }
  /// Whether a value of the followed writer has been taken.
  bool current() const noexcept {
    return last_writer_ != 0 && last_writer_ == following_->writer() && !shown_.empty();
  }

  Following& following() const noexcept { return *following_; }
  std::vector<Guid> matched() const { return reader_.matched(); }
  std::uint32_t matched_count() const noexcept { return reader_.matched_count(); }
  dds_entity_t condition() const noexcept { return reader_.condition(); }

  static constexpr int kMaxTakes = 64;
  static constexpr std::size_t kMaxWriters = 16;
  /// Size limit of a value; a longer one is dropped.
  static constexpr std::size_t kMaxBytes = 1'000'000;

 private:
  struct Kept {
    dds_instance_handle_t writer = 0;
    Serdata data;
    std::vector<char> bytes;
  };

  typename std::vector<Kept>::iterator find(dds_instance_handle_t writer) {
    return std::find_if(kept_.begin(), kept_.end(),
                        [&](const Kept& k) { return k.writer == writer; });
  }

  void receive() {
    for (int i = 0; i < kMaxTakes; ++i) {
      ddsi_serdata* one[1] = {nullptr};
      dds_sample_info_t info;
      if (dds_takecdr(reader_.get(), one, 1, &info, DDS_ANY_STATE) != 1)
        return;
      Serdata data(one[0]);
      if (info.valid_data && following_->admits(info.publication_handle))
        keep(info.publication_handle, std::move(data));
    }
  }

  void keep(dds_instance_handle_t writer, Serdata data) {
    const std::size_t size = ddsi_serdata_size(data.get());
    if (size > kMaxBytes)
      return;
    auto place = find(writer);
    if (place == kept_.end() && kept_.size() == kMaxWriters)
      std::erase_if(kept_,
                    [this](const Kept& k) { return !writer_is_matched(reader_.get(), k.writer); });
    if (place = find(writer); place == kept_.end()) {
      if (kept_.size() >= kMaxWriters)
        return;
      place = kept_.insert(kept_.end(), Kept{writer, nullptr, {}});
    }
    place->bytes.resize(size);
    ddsi_serdata_to_ser(data.get(), 0, size, place->bytes.data());
    place->data = std::move(data);
  }

  std::unique_ptr<Following> following_;  // outlives the reader, which calls it
  Reader<T> reader_;
  std::vector<Kept> kept_;
  std::vector<char> shown_;  ///< the last value passed to f
  dds_instance_handle_t last_writer_ = 0;
};

}  // namespace voxtouch::bus
