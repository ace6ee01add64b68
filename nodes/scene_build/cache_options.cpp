#include "nodes/scene_build/cache_options.hpp"

#include <cstdlib>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "nodes/scene_build/disk_cache.hpp"

namespace voxtouch::scene_build {

void add_cache_options(CLI::App& app, CacheOptions& o) {
  CLI::Option* off =
      app.add_flag("--no-cache", o.off,
                   "Builds the scene also where it was built before, and keeps nothing of it");
  app.add_option("--cache-mb", o.most_mb,
                 "Built scenes are kept in ~/.cache/voxtouch/scenes ($XDG_CACHE_HOME is followed) "
                 "up to so many MB; those used longest ago go first")
      ->capture_default_str()
      ->check(CLI::Range(std::uint64_t{1}, std::uint64_t{1'000'000}))
      ->excludes(off);
}

void append_arguments(const CacheOptions& o, std::vector<std::string>& arguments) {
  if (o.off)
    arguments.push_back("--no-cache");
  else if (o.most_mb != CacheOptions{}.most_mb)
    arguments.insert(arguments.end(), {"--cache-mb", fmt::to_string(o.most_mb)});
}

std::unique_ptr<rendering::SceneStore> open_cache(const CacheOptions& options, std::string who) {
  const char* none = std::getenv("VOXTOUCH_NO_CACHE");
  if (options.off || (none && *none))
    return nullptr;
  return std::make_unique<DiskCache>(cache_folder(), options.most_mb * 1'000'000, std::move(who));
}

}  // namespace voxtouch::scene_build
