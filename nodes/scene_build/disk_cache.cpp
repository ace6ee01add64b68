#include "nodes/scene_build/disk_cache.hpp"

#include <sys/stat.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <tuple>
#include <vector>

#include "nodes/log/tell.hpp"
#include "nodes/scene_build/cache_file.hpp"

namespace voxtouch::scene_build {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kEnding = ".scene";
/// What a program that was ended while it wrote has left; no writing takes as long.
constexpr std::chrono::hours kLeftOver{1};

/// The folder and those above it, which only this user may look into where they are new.
void make_folder(const fs::path& folder) {
  if (fs::is_directory(folder))
    return;
  if (folder.has_parent_path() && folder.parent_path() != folder)
    make_folder(folder.parent_path());
  if (::mkdir(folder.c_str(), 0700) != 0 && errno != EEXIST)
    throw std::system_error(errno, std::generic_category());
}

}  // namespace

fs::path cache_folder() {
  if (const char* cache = std::getenv("XDG_CACHE_HOME"); cache && *cache == '/')
    return fs::path(cache) / "voxtouch/scenes";
  if (const char* home = std::getenv("HOME"); home && *home == '/')
    return fs::path(home) / ".cache/voxtouch/scenes";
  return {};
}

DiskCache::DiskCache(fs::path folder, std::uint64_t most_bytes, std::string who)
    : folder_(std::move(folder)),
      most_bytes_(most_bytes),
      who_(std::move(who)) {}

std::string DiskCache::digest(std::string_view bytes) const { return sha256({bytes}); }

fs::path DiskCache::file_of(const std::string& recipe) const {
  return folder_ / (hex(sha256({recipe})) + std::string(kEnding));
}

rendering::Kept DiskCache::find(const std::string& recipe) {
  if (folder_.empty())
    return {};
  try {
    return read_cache_file(file_of(recipe), recipe, most_bytes_);
  } catch (const std::exception& error) {
    refuse(recipe, error.what());
  }
  return {};
}

void DiskCache::refuse(const std::string& recipe, const std::string& why) {
  log::tell("{}: the scene kept in {} is not used ({}), it is built anew\n", who_,
            file_of(recipe).string(), why);
}

void DiskCache::keep(const std::string& recipe, std::string_view content) {
  if (content.size() + overhead_bytes(recipe) > most_bytes_)
    return;
  try {
    if (folder_.empty())
      throw std::runtime_error("neither XDG_CACHE_HOME nor HOME says where");
    make_folder(folder_);
    const fs::path file = file_of(recipe);
    write_cache_file(file, recipe, content);
    forget_oldest(file);
  } catch (const std::exception& error) {
    log::tell(
        "{}: what was built cannot be kept in '{}' ({}), so it is built again at the next start; "
        "--no-cache keeps nothing\n",
        who_, folder_.string(), error.what());
  }
}

void DiskCache::forget_oldest(const fs::path& newest) const {
  std::vector<std::tuple<fs::file_time_type, std::uint64_t, fs::path>> files;
  std::uint64_t all = 0;
  std::error_code gone;  // another program may do the same at once
  const auto now = fs::file_time_type::clock::now();
  for (const fs::directory_entry& entry : fs::directory_iterator(folder_)) {
    if (entry.symlink_status(gone).type() != fs::file_type::regular)
      continue;
    const fs::file_time_type used = entry.last_write_time(gone);
    const std::uint64_t size = entry.file_size(gone);
    if (gone)
      continue;
    if (entry.path().extension() != kEnding) {
      if (entry.path().stem().extension() == kEnding && now - used > kLeftOver)
        fs::remove(entry.path(), gone);
      continue;
    }
    all += size;
    if (entry.path() != newest)
      files.emplace_back(used, size, entry.path());
  }
  std::ranges::sort(files);
  for (const auto& [used, size, path] : files) {
    if (all <= most_bytes_)
      return;
    fs::remove(path, gone);
    all -= size;
  }
}

}  // namespace voxtouch::scene_build
