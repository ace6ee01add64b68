#pragma once
/// Selects the message of a node's status if several apply at the same time.
#include <cstdint>
#include <string>
#include <utility>

namespace voxtouch::runtime {

/// From the least to the most important.
enum class StatusPriority : std::uint8_t {
  kProgress,
  kWaiting,
  kForeign,   ///< messages of a participant that is not bound
  kConflict,  ///< two devices in one rig
  kNetwork,
  kFault,
  kEnded,
  kFaultLatched,
  kRefused,
};

class StatusText {
 public:
  /// Ignores an empty text. Of two texts with equal priority, the first is kept.
  void set(StatusPriority priority, std::string text) {
    if (text.empty() || (!text_.empty() && priority <= priority_))
      return;
    text_ = std::move(text);
    priority_ = priority;
  }
  /// Appends a text to the sentence.
  void append(const std::string& text) { appendix_ += text; }
  std::string text() const { return text_ + appendix_; }

 private:
  std::string text_, appendix_;
  StatusPriority priority_{};
};

}  // namespace voxtouch::runtime
