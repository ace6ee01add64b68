#pragma once
/// Strings and string sequences in a DDS sample. DDS neither copies nor frees them, since dds_write
/// serialises immediately.
#include <string>
#include <vector>

#include <dds/dds.h>

namespace voxtouch::runtime {

inline char* lend(const std::string& text) { return const_cast<char*>(text.c_str()); }

/// Keeps the pointers of a sequence<string> valid for one write.
class StringViews {
 public:
  explicit StringViews(const std::vector<std::string>& texts) {
    for (const std::string& text : texts)
      pointers_.push_back(lend(text));
  }
  template <class Sequence>
  void into(Sequence& sequence) {
    sequence._buffer = pointers_.data();
    sequence._length = sequence._maximum = static_cast<std::uint32_t>(pointers_.size());
    sequence._release = false;
  }

 private:
  std::vector<char*> pointers_;
};

}  // namespace voxtouch::runtime
