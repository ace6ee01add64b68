// Content with a right checksum that somebody else made: it is refused, or it gives a scene which
// every lookup stands.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>

#include "core/rendering/built_parts.hpp"
#include "core/scene/scene_file.hpp"
#include "core/types/stored_bytes.hpp"
#include "tests/unit/scene_build/memory_store.hpp"

namespace voxtouch::test::hostile_content {
namespace {

/// With everything that is ever kept: a field, distances round it, points of the tool.
scene::Scene rich_scene() {
  scene::Scene scene = scene::load_scene(VOXTOUCH_DEPLOY "/scenes/cup_proximity.yaml");
  scene.contact.model = "field";
  scene.contact.stiffness_n_per_m = 0.0, scene.contact.stiffness_n_per_m3 = 1e6;
  scene.voxel_size_m = 0.008;
  return scene;
}

bool stands_all_lookups(const scene::Scene& scene, rendering::BuiltScene& built) {
  bool finite = true;
  for (int n = 0; n < 60; ++n) {
    rendering::ToolState tool{};
    tool.pose.position = Vec3(0.05 * std::sin(1.7 * n), 0.05 * std::sin(2.3 * n + 1.0),
                              0.06 * std::sin(0.9 * n + 2.0));
    const rendering::SceneFrame frame = built.scene_renderer().render(tool, 0.001 * n);
    finite = finite && frame.wrench.force.allFinite() && frame.wrench.torque.allFinite();
  }
  (void)scene;
  return finite;
}

class HostileContent : public testing::Test {
 protected:
  HostileContent() : scene_(rich_scene()) {
    rendering::build_scene(scene_, serial_for(), {.store = &store_});
    content_ = store_.kept.begin()->second;
  }
  /// True where it was refused, and built anew.
  bool refused(const std::string& content) {
    store_.kept.begin()->second = content;
    store_.refused.clear();
    const auto built = rendering::build_scene(scene_, serial_for(), {.store = &store_});
    EXPECT_TRUE(stands_all_lookups(scene_, *built));
    return !store_.refused.empty();
  }
  /// The same without the scene that is built where it is refused.
  bool reads(const std::string& content) const {
    try {
      const rendering::BuildChoices choices;
      rendering::parts_from(content, {scene_, choices, contact::ContactModelKind::kField});
      return true;
    } catch (const StoredBytesError&) {
      return false;
    }
  }

  MemoryStore store_;
  scene::Scene scene_;
  std::string content_;
};

TEST_F(HostileContent, IsRefusedWhereverItIsCut) {
  ASSERT_TRUE(reads(content_));
  std::mt19937_64 random(1);
  for (std::size_t n = 0; n < 600; ++n) {
    const std::size_t most =
        n < 300 ? std::min<std::size_t>(content_.size(), 300) : content_.size();
    EXPECT_FALSE(reads(content_.substr(0, n < 300 ? n : random() % most)));
  }
  EXPECT_FALSE(reads(content_ + '\0'));
  EXPECT_TRUE(refused(content_.substr(0, content_.size() / 2)));
  EXPECT_TRUE(store_.kept.begin()->second == content_) << "built anew, and kept";
}

TEST_F(HostileContent, WithAnyBytesChangedIsRefusedOrStandsAllLookups) {
  std::mt19937_64 random(2);
  std::size_t read = 0, unread = 0, used = 0;
  for (int n = 0; n < 4000; ++n) {
    std::string changed = content_;
    // Numbers of all kinds lie at both ends; in between there are rows of them.
    const std::size_t reach = n % 2 == 0 ? 256 : changed.size();
    for (std::size_t k = 0, count = 1 + random() % 3; k < count; ++k) {
      const std::size_t at = random() % reach,
                        place = random() % 2 == 0 ? at : changed.size() - 1 - at;
      constexpr char kBytes[] = {'\0', '\x01', '\x7f', '\x80', '\xff', '\xf0'};
      changed[place] = random() % 2 == 0 ? static_cast<char>(changed[place] ^ (1 << random() % 8))
                                         : kBytes[random() % std::size(kBytes)];
    }
    if (!reads(changed)) {
      ++unread;
      continue;
    }
    ++read;
    if (read % 25 == 0)
      ++used, refused(changed);  // a few of them at work: that takes longer
  }
  EXPECT_GT(unread, 500U);
  EXPECT_GT(read, 500U);
  EXPECT_GT(used, 20U);
}

/// Maps and fields begin alike: grid, first voxel, cells, then the table (of a map: of blocks) with
/// its length before it, then (of a map) the pages and the bricks likewise.
constexpr std::size_t kTable = 24 + 8 + 12 + 24 + 8;

template <class T>
std::string with(const std::string& bytes, std::size_t at, T value) {
  std::string changed = bytes;
  std::memcpy(changed.data() + at, &value, sizeof value);
  return changed;
}

template <class Stored>
bool is_taken(const std::string& bytes) {
  try {
    ByteReader in(bytes);
    Stored::take(in);
    return true;
  } catch (const StoredBytesError&) {
    return false;
  }
}

std::size_t entries_of(const std::string& bytes) {
  std::uint64_t count = 0;
  std::memcpy(&count, bytes.data() + kTable - 8, sizeof count);
  return count;
}

TEST_F(HostileContent, WhoseTableNamesABrickThatIsNotThereIsRefused) {
  const auto built = rendering::build_scene(scene_, serial_for());
  ByteWriter map, field;
  built->voxmap().put(map), built->field()->put(field);
  ASSERT_TRUE(is_taken<voxmap::Voxmap>(map.bytes()) &&
              is_taken<voxmap::DistanceField>(field.bytes()));
  for (std::size_t entry = 0; entry < entries_of(map.bytes()); ++entry)
    for (const std::int32_t wrong : {0x7fffffff, -0x7fffffff, -1}) {
      EXPECT_FALSE(is_taken<voxmap::Voxmap>(with(map.bytes(), kTable + 8 * entry, wrong)))
          << "page " << wrong;
      EXPECT_FALSE(is_taken<voxmap::Voxmap>(with(map.bytes(), kTable + 8 * entry + 4, wrong)))
          << "first brick " << wrong;
    }
  const std::size_t pages_of_map = kTable + 8 * entries_of(map.bytes()) + 8;
  for (const char wrong : {'\x3f', '\x42', '\xff'}) {
    EXPECT_FALSE(is_taken<voxmap::Voxmap>(with(map.bytes(), pages_of_map, wrong)))
        << "a shared page";
    EXPECT_FALSE(is_taken<voxmap::Voxmap>(
        with(map.bytes(), pages_of_map + 3 * sizeof(voxmap::Voxmap::Page), wrong)))
        << "a page";
  }
  for (std::size_t entry = 0; entry < entries_of(field.bytes()); entry += 7)
    for (const std::int32_t wrong : {0x7fffffff, -0x7fffffff, -3})
      EXPECT_FALSE(is_taken<voxmap::DistanceField>(with(field.bytes(), kTable + 4 * entry, wrong)))
          << wrong;
}

TEST_F(HostileContent, WithAVoxelOfNoKindOrADistanceThatIsNoneIsRefused) {
  const auto built = rendering::build_scene(scene_, serial_for());
  ByteWriter map, field;
  built->voxmap().put(map), built->field()->put(field);
  const std::size_t pages_of_map = kTable + 8 * entries_of(map.bytes()) + 8;
  std::uint64_t pages = 0;
  std::memcpy(&pages, map.bytes().data() + pages_of_map - 8, sizeof pages);
  const std::size_t bricks_of_map = pages_of_map + pages * sizeof(voxmap::Voxmap::Page) + 8,
                    bricks_of_field = kTable + 4 * entries_of(field.bytes()) + 8;
  EXPECT_FALSE(is_taken<voxmap::Voxmap>(
      with(map.bytes(), bricks_of_map + 3 * sizeof(voxmap::Voxmap::Brick), ~std::uint64_t{0})));
  for (const float wrong : {std::numeric_limits<float>::quiet_NaN(),
                            std::numeric_limits<float>::infinity(), 1e30F, -13.0F})
    EXPECT_FALSE(
        is_taken<voxmap::DistanceField>(with(field.bytes(), bricks_of_field + 4 * 100, wrong)))
        << wrong;
}

TEST_F(HostileContent, ForAnotherSceneIsRefused) {
  const rendering::BuildChoices choices;
  const auto needs = [&](const scene::Scene& other, contact::ContactModelKind model) {
    EXPECT_THROW(rendering::parts_from(content_, {other, choices, model}), StoredBytesError);
  };
  needs(scene_, contact::ContactModelKind::kAdapted);  // which has no field
  scene::Scene other = scene_;
  other.voxel_size_m = 0.004;
  needs(other, contact::ContactModelKind::kField);
  other = scene_;
  other.effects.clear();
  needs(other, contact::ContactModelKind::kField);
}

}  // namespace
}  // namespace voxtouch::test::hostile_content
