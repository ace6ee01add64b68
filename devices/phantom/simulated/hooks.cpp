// The hooks of hdsim.h: C in, a sentence out where something cannot be.
#include <fmt/format.h>

#include <limits>
#include <stdexcept>
#include <string>

#include "devices/phantom/simulated/library.hpp"

namespace {

using namespace voxtouch;
using hd_sim::Library;
using hd_sim::Settings;

thread_local std::string t_message;

template <class Work>
int attempt(Work work) noexcept {
  try {
    t_message.clear();
    return work();
  } catch (const std::exception& e) {
    t_message = e.what();
    return -1;
  }
}

template <class Change>
int configure(Change change) noexcept {
  return attempt([&] { return Library::instance().configure(change), 0; });
}

void need(bool good, const char* sentence) {
  if (!good) throw std::runtime_error(sentence);
}

Vec3 vector(const double* v) { return {v[0], v[1], v[2]}; }

Motion motion_of(const hdsim_motion* in) {
  need(in != nullptr && in->points != nullptr, "simulated Phantom: the motion has no way points");
  Motion out;
  for (std::size_t i = 0; i < in->point_count; ++i) out.path.push_back(vector(in->points + 3 * i));
  out.speed_m_per_s = in->speed;
  out.hold_s = in->hold;
  if (in->repeat_from >= 0) out.repeat_from = static_cast<std::size_t>(in->repeat_from);
  if (in->circle_centre != nullptr) out.circle_centre = vector(in->circle_centre);
  out.circle_axis = vector(in->circle_axis);
  out.orientation = Quat(in->orientation[0], in->orientation[1], in->orientation[2], in->orientation[3]);
  return out;
}

double time_or_never(double time_s) { return time_s < 0.0 ? std::numeric_limits<double>::infinity() : time_s; }

OperatorConfig hand_of(const hdsim_hand* in) {
  need(in != nullptr, "simulated Phantom: no hand was given");
  OperatorConfig out;
  out.released = in->released != 0;
  out.let_go_at_s = time_or_never(in->let_go_at);
  out.grip_harder_at_s = time_or_never(in->grip_harder_at);
  out.grip_factor = in->grip_factor;
  out.mass_kg = in->mass;
  out.damping_ns_per_m = in->damping;
  out.stiffness_n_per_m = in->stiffness;
  out.carries_tool = in->carries_tool != 0;
  out.tremor_n = in->tremor;
  out.tremor_bandwidth_hz = in->tremor_bandwidth;
  return out;
}

}  // namespace

extern "C" {

int hdsim_power_cycle(void) {
  return configure([](Settings&) {});
}
int hdsim_defaults(void) {
  return configure([](Settings& s) { s = {}; });
}
int hdsim_use_virtual_time(int on) {
  return configure([on](Settings& s) { s.virtual_time = on != 0; });
}
int hdsim_set_model(const char* key) {
  return configure([key](Settings& s) {
    need(key != nullptr, "simulated Phantom: no model was named");
    hd_sim::read_settings(s, fmt::format("model={}", key));
  });
}
int hdsim_set_seed(uint64_t seed) {
  return configure([seed](Settings& s) { s.seed = seed; });
}
int hdsim_set_number(const char* name, double value) {
  return configure([name, value](Settings& s) { s.set(name == nullptr ? "" : name, value); });
}
int hdsim_set_motion(const hdsim_motion* motion) {
  return attempt([&] { return Library::instance().set_motion(motion_of(motion)), 0; });
}
int hdsim_set_hand(const hdsim_hand* hand) {
  return attempt([&] { return Library::instance().set_hand(hand_of(hand)), 0; });
}
int hdsim_set_grip(const char* name) {
  return attempt([&] {
    const auto hand = grip(name == nullptr ? "" : name);
    need(hand.has_value(), "simulated Phantom: there is no grip of that name; \"pen\" is the usual one");
    return Library::instance().set_hand(*hand), 0;
  });
}
int hdsim_set_switches(int buttons, int safety, int inkwell) {
  return attempt([&] { return Library::instance().set_switches({buttons, safety != 0, inkwell != 0}), 0; });
}
int hdsim_step(void) {
  return attempt([] { return Library::instance().step() ? 0 : 1; });
}
int hdsim_inject(int fault, double amount) {
  return attempt([&] { return Library::instance().inject(fault, amount), 0; });
}
int hdsim_read_state(hdsim_state* state, size_t size) {
  return attempt([&] {
    need(state != nullptr && size == sizeof(hdsim_state),
         "simulated Phantom: the state has another size; rebuild the caller");
    return Library::instance().read_state(*state), 0;
  });
}
const char* hdsim_last_message(void) { return t_message.c_str(); }

}  // extern "C"
