#include "nodes/view/view.hpp"

#include <sys/resource.h>

#include <algorithm>
#include <deque>
#include <future>
#include <mutex>
#include <optional>
#include <thread>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/scene/scene_file.hpp"
#include "nodes/bag/files.hpp"
#include "nodes/console/log.hpp"
#include "nodes/runtime/change_client.hpp"
#include "nodes/runtime/clock.hpp"
#include "nodes/runtime/convert.hpp"
#include "nodes/view/bag_player.hpp"
#include "nodes/view/browser.hpp"
#include "nodes/view/contact_points.hpp"
#include "nodes/view/hand_lead.hpp"
#include "nodes/view/last_seconds.hpp"
#include "nodes/view/ring_tap.hpp"
#include "nodes/view/rounded.hpp"
#include "nodes/view/shapes.hpp"

namespace voxtouch::view {
namespace {

using nlohmann::json;

constexpr std::int64_t kFrameNs = 33'333'333, kFactsNs = 200'000'000;

/// Replaces invalid UTF-8, which any participant can send.
std::string text_of(const json& j) {
  return j.dump(-1, ' ', false, json::error_handler_t::replace);
}

bool is_bag(const std::filesystem::path& path) {
  std::error_code error;
  return std::filesystem::is_directory(path, error) || path.extension() == ".db3" ||
         path.extension() == ".mcap";
}

/// Counters of the device's guard and clock, for the line above the charts.
json counts_of(const std::vector<NodeRow>& rows) {
  for (const NodeRow& row : rows) {
    if (row.report.node != "device")
      continue;
    json counts;
    for (const char* name : {"refused", "clamped", "overruns", "deadline_misses", "latency_p50_us",
                             "latency_p99_us", "latency_max_us"})
      if (const auto value = runtime::find_value(row.report.figures, name))
        counts[name] = rounded(*value);
    return counts;
  }
  return nullptr;
}

class View {
 public:
  /// Throws std::runtime_error, a sentence.
  explicit View(const Options& options)
      : options_(options),
        participant_(options.node.participant("view")),
        hand_(options.leads_hand ? std::make_unique<HandLead>(participant_, options.node)
                                 : nullptr),
        server_(
            options.server, [this] { return greeting(); },
            [this](std::uint64_t page, std::string text) { receive(page, std::move(text)); },
            [this](std::uint64_t page) {
              if (hand_)
                hand_->close(page);
            }) {
    if (is_bag(options.shown) && hand_)
      throw std::runtime_error("--lead-hand does not work with a recording. Start without it");
    if (is_bag(options.shown))
      player_.emplace(participant_, options.shown);
    else
      tap_.emplace(participant_, options.node);
    if (tap_)
      change_client_.emplace(participant_, options.node);
    if (hand_)
      last_.emplace(participant_, options.node, options.save);
    if (!options.choice.empty())
      next_.emplace(options.next);
    if (!player_ && !options.shown.empty())
      show(options.shown);
  }

  ~View() { ended_.store(true); }
  View(const View&) = delete;
  View& operator=(const View&) = delete;

  int run(const std::atomic<bool>& stop) {
    const std::string line = fmt::format("view: {}", server_.address());
    if (options_.to_stderr)
      console::log("{}\n", line);
    else
      console::print_result("{}\n", line), console::finish_results();
    if (options_.opens_browser)
      open_browser(server_.address());
    std::int64_t at_ns = runtime::monotonic_ns(), before_ns = at_ns, frame_at_ns = 0,
                 facts_at_ns = 0;
    while (!stop.load()) {
      const std::int64_t now_ns = runtime::monotonic_ns();
      process_orders();
      poll_changes();
      poll_saved();
      if (next_ && has_chosen())
        return kChosenStatus;
      points_.poll();
      advance(now_ns, std::min(kMaxStepS, static_cast<double>(now_ns - before_ns) * 1e-9));
      before_ns = now_ns;
      if (at_ns >= frame_at_ns)
        send_frame(), frame_at_ns = at_ns + kFrameNs - kCycleNs / 2;
      if (now_ns >= facts_at_ns)
        send_facts(now_ns), facts_at_ns = now_ns + kFactsNs;
      at_ns = runtime::next_deadline(at_ns, runtime::monotonic_ns(), kCycleNs).at_ns;
      runtime::sleep_until(at_ns);
    }
    return 0;
  }

 private:
  static constexpr std::int64_t kCycleNs = kFrameNs / 2;
  static constexpr double kMaxStepS =
      0.25;  ///< a delayed thread pauses the playback, so no part is skipped

  /// Writes a checked choice to its file; what is being saved comes first.
  bool has_chosen() {
    if (const std::optional<std::string> problem = next_->poll())
      server_.send_fact(text_of({{"type", "choice"}, {"sentence", *problem}}));
    if (!next_->chosen() || (last_ && last_->is_saving()))
      return false;
    const std::string text = fmt::format("{}\n{}\n{}\n", next_->chosen()->scene,
                                         next_->chosen()->device, server_.address());
    const auto written = bag::write_atomically(options_.choice, text, bag::Flush::kNo);
    if (!written)
      next_->reject(written.error().sentence + " The ring goes on.");
    return written.has_value();
  }

  void poll_saved() {
    if (!last_)
      return;
    last_->take();
    if (const std::optional<LastSeconds::Answer> answer = last_->poll())
      server_.send_fact(
          text_of({{"type", "saved"}, {"ok", answer->ok}, {"sentence", answer->sentence}}));
  }

  void advance(std::int64_t now_ns, double elapsed_s) {
    if (tap_) {
      tap_->take(picture_, facts_, nodes_, now_ns);
      if (hand_ && picture_.state())
        hand_->set_state(*picture_.state());
    } else if (player_->advance(server_.clients() > 0 ? elapsed_s : 0.0, picture_, facts_,
                                nodes_)) {
      server_.send_fact(text_of(picture_.past(scene_or_null())));
    }
  }

  void send_frame() {
    if (!picture_.has_update())
      return;
    json frame = picture_.frame(scene_or_null());
    if (is_same_scene())
      if (const auto points = points_.points()) {
        json all = json::array();
        for (const Vec3& p : *points)
          for (const double x : {p.x(), p.y(), p.z()})
            all.push_back(rounded(x));
        frame["points"] = std::move(all);
      }
    if (server_.clients() == 0)
      return;
    if (const auto& contact = picture_.contact())  // for the next frame
      points_.request(runtime::from_msg(contact->object_pose),
                      static_cast<double>(contact->scene_time_ns) * 1e-9);
    server_.send_frame(text_of(frame));
  }

  void send_facts(std::int64_t now_ns) {
    poll_shapes();
    follow_scene();
    if (hand_)
      hand_->claim();
    if (server_.clients() == 0)
      return;
    const std::vector<NodeRow> rows = nodes_.rows(player_ ? player_->now_ns() : now_ns);
    json facts = facts_.to_json();
    facts["type"] = "facts";
    facts["rig"] = options_.node.rig;
    facts["nodes"] = to_json(rows);
    facts["counts"] = counts_of(rows);
    facts["latency"] = picture_.latency();
    facts["scene_note"] = scene_note();
    facts["hand"] = hand_ ? hand_->to_json() : json();
    facts["saves"] = last_.has_value();
    facts["offered"] = next_ ? NextRing::offered() : json();
    if (player_)
      facts["bag_note"] = player_->note();
    if (player_)
      facts["bag"] = player_->to_json();
    server_.send_fact(text_of(facts));
    send_slice();
    if (sends_shell_ && is_same_scene() && !points_.shell().is_null()) {
      server_.send_fact(text_of(points_.shell()));
      sends_shell_ = false;
    }
  }

  /// Sends the requested slice if it differs from the last one.
  void send_slice() {
    if (!slice_ || !is_same_scene())
      return;
    if (const auto found = points_.take_slice(); found && !found->is_null())
      if (std::string text = text_of(*found); text != last_slice_text_)
        server_.send_fact(last_slice_text_ = std::move(text));
    SliceRequest request{slice_->axis, slice_->at_m.value_or(0.0), 0.0};
    if (const auto& contact = picture_.contact()) {
      if (!slice_->at_m)
        request.at_m = runtime::from_msg(contact->object_pose).position[request.axis];
      request.scene_time_s = static_cast<double>(contact->scene_time_ns) * 1e-9;
    }
    points_.request(request);
  }

  const scene::Scene* scene_or_null() const { return scene_ ? &*scene_ : nullptr; }

  /// Whether the displayed scene is that of the ring or recording.
  bool is_same_scene() const {
    return scene_ && (facts_.scene_hash().empty() || facts_.scene_hash() == scene_->hash);
  }

  std::string scene_note() const {
    if (!scene_)
      return no_scene_reason_.empty() ? "The scene file is unknown: pass it to `voxtouch view`."
                                      : no_scene_reason_;
    if (!is_same_scene())
      return fmt::format("{} differs from the version in the ring: its meshes may differ.",
                         scene_->file.filename().string());
    const std::string why = points_.missing_reason();
    return why.empty() ? "" : "No contact points: " + why + ".";
  }

  /// Reads the scene file that the ring or bag names, also after a change.
  void follow_scene() {
    const std::string named = player_ ? player_->scene_file() : tap_->scene_file();
    const std::filesystem::path file = !named.empty() ? std::filesystem::path(named)
                                       : player_      ? ""
                                                      : options_.shown;
    if (shapes_.valid() || file.empty() || facts_.scene_hash().empty() || is_same_scene())
      return;
    if (last_tried_ == std::pair(file, facts_.scene_hash()))
      return;
    last_tried_ = {file, facts_.scene_hash()};
    show(file);
  }

  void show(const std::filesystem::path& file) {
    try {
      scene_ = scene::load_scene(file);
      no_scene_reason_.clear();
    } catch (const std::exception& error) {
      no_scene_reason_ = error.what();
      console::log("warning: view: {}\n", no_scene_reason_);
      return;
    }
    facts_.set_scene(*scene_);
    if (hand_)
      hand_->set_scene(*scene_);
    // Large meshes take seconds to read: do not delay forces and charts.
    shapes_ = std::async(std::launch::async, [this, scene = *scene_] {
      json shapes = shapes_of(scene, ended_);
      shapes["type"] = "scene";
      shapes["name"] = scene.name;
      shapes["file"] = scene.file.filename().string();
      return text_of(shapes);
    });
    points_.set_scene(*scene_);
  }

  /// Runs requested changes one after the other, each in a thread, since an answer can take long.
  void poll_changes() {
    if (pending_change_.valid()) {
      if (pending_change_.wait_for(std::chrono::seconds(0)) != std::future_status::ready)
        return;
      answer(changes_.front(), pending_change_.get());
      changes_.pop_front();
    }
    if (changes_.empty())
      return;
    pending_change_ =
        std::async(std::launch::async, [this, change = changes_.front()]() -> std::string {
          try {
            return change_client_->request(
                change, [](const auto&) {}, [](const auto&) {}, [this] { return ended_.load(); });
          } catch (const std::exception& error) {
            return error.what();
          }
        });
  }

  /// `problem`: the reason for a refusal; empty: applied.
  void answer(const runtime::ChangeWords& change, const std::string& problem) {
    server_.send_fact(text_of({{"type", "answer"},
                               {"words", change.words},
                               {"ok", problem.empty()},
                               {"sentence", problem}}));
  }

  void poll_shapes() {
    if (!shapes_.valid() || shapes_.wait_for(std::chrono::seconds(0)) != std::future_status::ready)
      return;
    std::string text = shapes_.get();
    const std::lock_guard lock(mutex_);
    scene_text_ = std::move(text);
    server_.send_fact(scene_text_);
  }

  /// From the server's thread.
  std::string greeting() {
    const std::lock_guard lock(mutex_);
    if (orders_.empty() || !orders_.back().contains("past"))  // many pages may connect at once
      orders_.push_back(json::object({{"past", true}}));
    return scene_text_;
  }
  void receive(std::uint64_t page, std::string text) {
    json order = json::parse(text, nullptr, false);
    if (hand_ && order.is_object() && order.contains("aim")) {
      try {
        hand_->set_target(page, order["aim"], runtime::monotonic_ns());
      } catch (const json::exception&) {
        // Not from a page of this server: ignore it.
      }
      return;
    }
    constexpr std::size_t kMaxOrders = 64;
    const std::lock_guard lock(mutex_);
    if (!order.is_object() || orders_.size() >= kMaxOrders)
      return;
    order["page"] = page;
    orders_.push_back(std::move(order));
  }

  /// Processes the messages of pages.
  void process_orders() {
    std::deque<json> orders;
    {
      const std::lock_guard lock(mutex_);
      orders.swap(orders_);
    }
    for (const json& order : orders) {
      try {
        process_order(order);
      } catch (const json::exception&) {
        // Not from a page of this server: ignore it.
      }
    }
  }

  void process_order(const json& order) {
    if (order.contains("past")) {
      server_.send_fact(text_of(picture_.past(scene_or_null())));
      last_slice_text_.clear();  // for the new page
    }
    if (order.contains("slice"))
      set_slice(order["slice"]);
    if (order.contains("shell"))
      sends_shell_ = true;
    if (order.contains("change") && change_client_)
      change({order["change"].get<std::vector<std::string>>(), false, 0.0, "", 0});
    if (order.contains("model") && change_client_)
      change({{}, true, 0.0, order["model"].get<std::string>(), 0});
    if (order.contains("save") && last_)
      last_->save(scene_ ? scene_->name : "scene");
    if (order.contains("choose") && next_)
      next_->choose(order["choose"]);
    if (order.contains("mesh") && next_)
      next_->take_mesh(order.at("page").get<std::uint64_t>(), order["mesh"]);
    if (!player_)
      return;
    if (order.contains("play"))
      player_->play(order["play"].get<bool>());
    if (order.contains("speed"))
      player_->speed(order["speed"].get<double>());
    if (order.contains("seek"))
      player_->seek(order["seek"].get<double>());
  }

  void change(runtime::ChangeWords words) {
    constexpr std::size_t kMaxChanges = 8;
    if (changes_.size() < kMaxChanges)
      changes_.push_back(std::move(words));
    else
      answer(words, "too many pending changes");
  }

  /// {"axis": "z", "at": 0.01}: a slice there, or at the tool without `at`; null: no slice.
  void set_slice(const json& order) {
    slice_.reset(), last_slice_text_.clear();
    if (!order.is_object())
      return;
    const std::size_t axis = std::string("xyz").find(order.at("axis").get<std::string>());
    if (axis > 2)
      return;
    slice_ =
        SlicePlane{static_cast<int>(axis),
                   order.contains("at") ? std::optional(order["at"].get<double>()) : std::nullopt};
  }
  struct SlicePlane {
    int axis = 2;
    std::optional<double> at_m;  ///< unset: at the tool
  };

  const Options& options_;
  bus::Participant participant_;
  std::optional<SlicePlane> slice_;
  std::string last_slice_text_;  ///< last text sent
  bool sends_shell_ = false;     ///< requested, and not sent yet
  Picture picture_;
  Facts facts_;
  NodeTable nodes_;
  std::optional<scene::Scene> scene_;
  std::string no_scene_reason_;
  std::atomic<bool> ended_{false};
  std::future<std::string> shapes_;  ///< being read
  std::pair<std::filesystem::path, std::string> last_tried_;
  ContactPoints points_;
  std::mutex mutex_;
  std::string scene_text_ = R"({"type":"scene","meshes":[],"notes":[]})";
  std::deque<json> orders_;
  std::unique_ptr<HandLead> hand_;  ///< if pages lead one
  PageServer server_;
  std::optional<RingTap> tap_;
  std::optional<BagPlayer> player_;
  std::optional<runtime::ChangeClient> change_client_;  ///< of a ring
  std::deque<runtime::ChangeWords> changes_;            ///< the first is pending
  std::future<std::string> pending_change_;
  std::optional<NextRing> next_;     ///< if pages may choose
  std::optional<LastSeconds> last_;  ///< if pages move the hand
};

}  // namespace

int run(const Options& options, const std::atomic<bool>& stop) {
  setpriority(PRIO_PROCESS, 0, 10);  // this thread and all that it starts, including DDS: viewing
                                     // has the lowest priority
  return View(options).run(stop);
}

}  // namespace voxtouch::view
