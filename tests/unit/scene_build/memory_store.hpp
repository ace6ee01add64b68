#pragma once
/// A store in memory, which says what it was asked.
#include <cstring>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "core/rendering/scene_store.hpp"
#include "nodes/scene_build/cache_file.hpp"

namespace voxtouch::test {

class MemoryStore : public rendering::SceneStore {
 public:
  std::string digest(std::string_view bytes) const override { return scene_build::sha256({bytes}); }
  rendering::Kept find(const std::string& recipe) override {
    const auto found = kept.find(recipe);
    if (found == kept.end())
      return {};
    auto memory = std::make_unique<char[]>(found->second.size() + 1);
    std::memcpy(memory.get(), found->second.data(), found->second.size());
    rendering::Kept out;
    out.content = {memory.get(), found->second.size()};
    out.memory = std::move(memory);
    return out;
  }
  void refuse(const std::string&, const std::string& why) override { refused.push_back(why); }
  void keep(const std::string& recipe, std::string_view content) override {
    kept[recipe] = content;
  }
  std::uint64_t most_bytes() const noexcept override { return most; }

  std::map<std::string, std::string> kept;
  std::vector<std::string> refused;
  std::uint64_t most = 1'000'000'000;
};

}  // namespace voxtouch::test
