// EffectChanges from the network, as the update server validates them: an accepted change leaves
// every effect within its ranges and its force finite.
#include "core/effects/effect_chain.hpp"
#include "tests/fuzz/effects.hpp"
#include "tests/fuzz/wire.hpp"

namespace {

using namespace voxtouch;

std::string_view view(const char* text) { return text ? text : ""; }

void feel(effects::EffectChain& chain, double time_s) {
  effects::EffectFrame frame;
  frame.tool.position = Vec3(0.01, -0.02, 0.03);
  frame.twist.linear = Vec3(0.1, 0.05, -0.2);
  frame.dt_s = 1e-3, frame.time_s = time_s;
  const effects::EffectForce push = chain.apply(frame);
  FUZZ_REQUIRE(push.wrench.finite() && push.stiffness.allFinite() &&
               std::isfinite(push.potential_j));
}

}  // namespace

/// Messages one after the other, each behind its length.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static fuzz::Wire<msg::EffectChange> wire;
  std::vector<effects::EffectSpec> planned = fuzz::all_effects();
  effects::EffectChain chain(planned);
  fuzz::Bytes in(data, size);
  double time_s = 0.0;
  for (int n = 0; n < 16 && !in.empty(); ++n) {
    const std::size_t length = in.take<std::uint8_t>();
    std::string cdr("\0\1\0\0", 4);
    cdr += in.take(length);
    wire.through(cdr, [&](const msg::EffectChange& m) {
      (void)effects::quotable(view(m.model));
      const auto command = effects::judge(
          planned, {.action = static_cast<effects::EffectAction>((m.action - 1U) % 3U),
                    .effect = view(m.effect),
                    .parameter = view(m.parameter),
                    .value = {m.value[0], m.value[1], m.value[2]}});
      if (!command) {
        FUZZ_REQUIRE(!command.error().empty());
        return;
      }
      effects::carry_out(planned.at(command->effect), *command);
      chain.carry_out(*command);
      fuzz::require_good(planned[command->effect]);
    });
    for (int k = 0; k < 3; ++k)
      feel(chain, time_s += 0.01);
  }
  return 0;
}
