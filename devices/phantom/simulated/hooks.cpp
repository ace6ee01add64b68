// The hooks of hdsim.h: C functions that return a sentence on failure.
#include <fmt/format.h>

#include <stdexcept>
#include <string>

#include "devices/operator/hand_file.hpp"
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
  if (!good)
    throw std::runtime_error(sentence);
}

hand::HandFile hand_file(const char* text) {
  need(text != nullptr, "simulated Phantom: no hand");
  return hand::parse_hand(text, "simulated Phantom: hand");
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
    need(key != nullptr, "simulated Phantom: no model");
    hd_sim::read_settings(s, fmt::format("model={}", key));
  });
}
int hdsim_set_seed(uint64_t seed) {
  return configure([seed](Settings& s) { s.seed = seed; });
}
int hdsim_set_number(const char* name, double value) {
  return configure([name, value](Settings& s) { s.set(name == nullptr ? "" : name, value); });
}
int hdsim_set_motion(const char* text) {
  return attempt([&] { return Library::instance().set_motion(hand_file(text).motion), 0; });
}
int hdsim_set_hand(const char* text) {
  return attempt([&] { return Library::instance().set_hand(hand_file(text).hand), 0; });
}
int hdsim_set_switches(int buttons, int safety, int inkwell) {
  return attempt([&] {
    return Library::instance().set_switches({buttons, safety != 0, inkwell != 0}), 0;
  });
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
         "simulated Phantom: the state has a different size; rebuild the caller");
    return Library::instance().read_state(*state), 0;
  });
}
const char* hdsim_last_message(void) { return t_message.c_str(); }

}  // extern "C"
