#pragma once
/// Checks the facts in a message, independent of its wording.
#include <ranges>
#include <string>
#include <string_view>

namespace voxtouch::test {

/// The first of `facts` ("'gain'|0 to 1": keys, values, bounds, numbers) that `message` lacks;
/// empty if it has all.
inline std::string missing_fact(std::string_view message, std::string_view facts) {
  for (const auto fact : facts | std::views::split('|'))
    if (!message.contains(std::string_view(fact)))
      return std::string(std::string_view(fact));
  return {};
}

}  // namespace voxtouch::test
