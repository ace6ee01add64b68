#pragma once
/// The page's choice of the next run: a shipped scene and a simulated device, or a mesh.
#include <cstdint>
#include <filesystem>
#include <functional>
#include <future>
#include <optional>
#include <string>

#include <nlohmann/json.hpp>

namespace voxtouch::view {

struct Next {
  std::string scene;  ///< a shipped name, or the file of a proposed scene
  std::string device;
};

/// Actions of the command line. Both may take seconds and throw std::exception with a sentence.
struct NextActions {
  std::function<void(const Next&)> check;
  /// Writes a scene for the mesh in `bytes`, whose format is that of `ending`; returns its file.
  std::function<std::string(const std::string& bytes, const std::string& ending,
                            const std::string& device)>
      propose;
};

/// Used by one thread; no call blocks. Accepts shipped names only, no file names.
class NextRing {
 public:
  static constexpr std::size_t kMaxMeshBytes = 16 << 20;

  explicit NextRing(const NextActions& actions) : actions_(actions) {}

  /// {"scenes": [...], "devices": [...]}
  static nlohmann::json offered();
  /// {"scene": name, "device": name}. Throws json::exception for other JSON.
  void choose(const nlohmann::json& order);
  /// {"ending": ".stl", "device": name, "at": 0, "of": bytes, "data": base64}: a piece of a mesh,
  /// in order, all from one page. Throws json::exception for other JSON.
  void take_mesh(std::uint64_t page, const nlohmann::json& order);
  /// The reason for a refusal since the last call.
  std::optional<std::string> poll();
  /// The checked choice; with one the view ends.
  const std::optional<Next>& chosen() const noexcept { return chosen_; }
  /// The choice could not be passed on: the ring goes on, and pages may choose again.
  void reject(std::string problem) {
    chosen_.reset();
    problem_ = std::move(problem);
  }

 private:
  struct Checked {
    Next next;
    std::string problem;
  };
  bool may_begin(const std::string& device);
  void begin(std::function<Next()> make);

  const NextActions& actions_;
  std::string mesh_, problem_;
  std::uint64_t page_ = 0;  ///< that sends the mesh
  std::future<Checked> checking_;
  std::optional<Next> chosen_;
};

}  // namespace voxtouch::view
