#include "core/effects/effect_kind.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace voxtouch::effects {
namespace {

std::string requested(const EffectParameter& p) {
  const char* what = p.shape == ParameterShape::kVector ? "a vector of norm" : "a number";
  return std::isinf(p.high) ? fmt::format("{} >= {:g}", what, p.low)
                            : fmt::format("{} from {:g} to {:g}", what, p.low, p.high);
}

std::size_t numbers_of(const EffectParameter& p) {
  return p.shape == ParameterShape::kVector || p.shape == ParameterShape::kDirection ? 3 : 1;
}

}  // namespace

EffectValues::EffectValues(std::span<const EffectParameter> parameters) {
  constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();
  values_.reserve(parameters.size());
  for (const EffectParameter& p : parameters)
    values_.push_back(p.standard.value_or(std::array{kMissing, kMissing, kMissing}));
}

std::string check_value(const EffectParameter& p, const std::array<double, 3>& v) {
  for (std::size_t n = 0; n < numbers_of(p); ++n)
    if (!std::isfinite(v[n]))
      return fmt::format("'{}' is missing or not finite", p.name);
  const double size = numbers_of(p) == 1 ? v[0] : Vec3(v[0], v[1], v[2]).norm();
  switch (p.shape) {
    case ParameterShape::kNumber:
    case ParameterShape::kVector:
      return size >= p.low && size <= p.high ? ""
                                             : fmt::format("'{}' must be {}", p.name, requested(p));
    case ParameterShape::kText:
      return "";  // the text itself is checked by its reader
    case ParameterShape::kDirection:
      return std::abs(size - 1.0) <= 1e-6
                 ? ""
                 : fmt::format("'{}' must be a direction of norm 1", p.name);
    case ParameterShape::kWord: {
      const auto count = static_cast<double>(1 + std::count(p.words.begin(), p.words.end(), ' '));
      return size == std::floor(size) && size >= 0.0 && size < count
                 ? ""
                 : fmt::format("'{}' must be one of: {}", p.name, p.words);
    }
  }
  return {};
}

std::string check_values(const EffectKind& kind, const EffectValues& values) {
  if (values.size() != kind.parameters.size())
    return fmt::format("wrong number of parameters for effect '{}'", kind.name);
  for (std::size_t n = 0; n < kind.parameters.size(); ++n)
    if (std::string why = check_value(kind.parameters[n], values.at(n)); !why.empty())
      return why;
  return kind.check != nullptr ? kind.check(values) : std::string();
}

}  // namespace voxtouch::effects
