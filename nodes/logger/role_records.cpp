#include "nodes/logger/role_records.hpp"

#include <algorithm>

namespace voxtouch::logger {
namespace {

constexpr std::size_t kMaxAuthorised =
    64;  ///< the newest ones; a ring rarely changes its rendering
constexpr std::size_t kMaxNamed = 16;
/// The first poll may have begun when the record had not arrived.
constexpr std::uint64_t kPolls = 2;

}  // namespace

void RoleRecords::entitle(const bus::Guid& participant) {
  const std::lock_guard lock(mutex_);
  if (std::ranges::find(authorised_, participant) != authorised_.end())
    return;
  authorised_.push_back(participant);
  if (authorised_.size() > kMaxAuthorised)
    authorised_.pop_front();
}

void RoleRecords::looked(bool bound) {
  const std::lock_guard lock(mutex_);
  ++polls_;
  bound_ = bound;
}

void RoleRecords::take(const bus::Guid& writer, Record record) {
  const std::lock_guard lock(mutex_);
  const std::size_t size = record.bytes.size();
  if (kept_bytes_[writer] + size > kMaxOfOne || all_bytes_ + size > kMaxOfAll) {
    const bool owner = std::ranges::find(authorised_, writer) != authorised_.end();
    if (unknown_ == Unknown::kRefuse || (!owner && !authorised_.empty()))
      return refuse(writer);
    released_ = released_ || authorised_.empty();
  }
  kept_bytes_[writer] += size, all_bytes_ += size;
  kept_.push_back({writer, std::move(record), polls_ + kPolls});
}

std::vector<RoleRecords::Record> RoleRecords::decided() {
  const std::lock_guard lock(mutex_);
  std::vector<Record> own;
  std::erase_if(kept_, [&](Kept& one) {
    const bool authorised =
        released_ || std::ranges::find(authorised_, one.writer) != authorised_.end();
    const bool foreign = !authorised && bound_ && polls_ >= one.decided_at;
    if (!authorised && !foreign)
      return false;
    const std::size_t size = one.record.bytes.size();
    kept_bytes_[one.writer] -= size, all_bytes_ -= size;
    if (authorised)
      own.push_back(std::move(one.record)), ++settled_;
    if (foreign)
      refuse(one.writer);
    return true;
  });
  std::erase_if(kept_bytes_, [](const auto& entry) { return entry.second == 0; });
  released_ = false;
  return own;
}

void RoleRecords::release_unknown() {
  const std::lock_guard lock(mutex_);
  released_ = unknown_ == Unknown::kRecord && authorised_.empty();
}

void RoleRecords::refuse_kept() {
  const std::lock_guard lock(mutex_);
  for (const Kept& one : kept_)
    refuse(one.writer);
  kept_.clear(), kept_bytes_.clear(), all_bytes_ = 0;
}

void RoleRecords::refuse(const bus::Guid& writer) {
  ++refused_;
  if (refused_writers_.size() < kMaxNamed || refused_writers_.contains(writer))
    ++refused_writers_[writer];
}

std::uint64_t RoleRecords::settled() const {
  const std::lock_guard lock(mutex_);
  return settled_;
}

std::uint64_t RoleRecords::refused() const {
  const std::lock_guard lock(mutex_);
  return refused_;
}

std::map<bus::Guid, std::uint64_t> RoleRecords::refused_writers() const {
  const std::lock_guard lock(mutex_);
  return refused_writers_;
}

}  // namespace voxtouch::logger
