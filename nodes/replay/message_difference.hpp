#pragma once
/// Two messages of one kind compared, bit by bit, by the names of their fields.
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "voxtouch_msgs/messages.hpp"

namespace voxtouch::replay {

struct FieldDifference {
  std::string field;     ///< "wrench.force.x"
  std::string recorded;  ///< as the shortest text that reads back bit-identically
  std::string replayed;
  std::string
      by;  ///< the size of the difference; of numbers of equal value, that their bits differ
};

/// In the order of the message. Includes equal numbers with different bits, such as -0.
std::vector<FieldDifference> differences(const msg::ContactState& recorded,
                                         const msg::ContactState& replayed);
std::vector<FieldDifference> differences(const msg::ForceCommand& recorded,
                                         const msg::ForceCommand& replayed);

/// A topic's messages, recorded and replayed, sample by sample.
template <class T>
class Comparison {
 public:
  struct Most {
    double value = 0.0;
    std::uint64_t sample = 0;
    void add(double other, std::uint64_t at) noexcept {
      if (other > value)
        value = other, sample = at;
    }
  };

  void take(const T& recorded, const T& replayed);

  std::uint64_t compared = 0, differ = 0;
  std::optional<T> first;               ///< the recorded one of the first pair that differs ...
  std::vector<FieldDifference> fields;  ///< and in these fields
  Most force_n, torque_nm;              ///< largest difference
};

}  // namespace voxtouch::replay
