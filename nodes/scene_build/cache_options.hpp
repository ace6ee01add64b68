#pragma once
/// What a command line says of the cache of built scenes.
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/rendering/scene_store.hpp"

namespace CLI {
class App;
}

namespace voxtouch::scene_build {

struct CacheOptions {
  bool off = false;
  std::uint64_t most_mb = 1000;  ///< [10^6 bytes], of all scenes together
};

/// --no-cache, --cache-mb.
void add_cache_options(CLI::App& app, CacheOptions& options);
/// The command line of a program that gets exactly these options.
void append_arguments(const CacheOptions& options, std::vector<std::string>& arguments);

/// The user's cache; null where it is off, here or by VOXTOUCH_NO_CACHE in the environment. `who`
/// begins what it tells.
std::unique_ptr<rendering::SceneStore> open_cache(const CacheOptions& options, std::string who);

}  // namespace voxtouch::scene_build
