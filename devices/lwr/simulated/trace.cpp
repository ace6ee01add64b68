#include "devices/lwr/simulated/trace.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <iterator>
#include <stdexcept>
#include <utility>

#include "core/types/enum_name.hpp"

namespace voxtouch::lwr_sim {
namespace {

constexpr const char* kHeader =
    "time_s,state,quality,braked,tip_x,tip_y,tip_z,vel_x,vel_y,vel_z,applied_fx,applied_fy,applied_"
    "fz,applied_tx,"
    "applied_ty,applied_tz,hand_fx,hand_fy,hand_fz,target_x,target_y,target_z\n";

void append(fmt::memory_buffer& line, const Vec3& v) {
  fmt::format_to(std::back_inserter(line), ",{:.9g},{:.9g},{:.9g}", v.x(), v.y(), v.z());
}

}  // namespace

std::string_view name_of(lwr::fri::State state) noexcept {
  return name_in(std::array<std::string_view, 3>{"off", "mon", "cmd"}, state, "invalid");
}

std::string_view name_of(lwr::fri::Quality quality) noexcept {
  return name_in(std::array<std::string_view, 4>{"unacceptable", "bad", "ok", "perfect"}, quality,
                 "invalid");
}

Trace::Trace(const std::filesystem::path& file)
    : path_(file),
      file_(std::fopen(file.c_str(), "w")) {
  if (!file_)
    throw std::runtime_error(
        fmt::format("trace: cannot write '{}': {}", file.string(), std::strerror(errno)));
  std::fputs(kHeader, file_);
}

Trace::~Trace() {
  if (file_)
    std::fclose(file_);
}

void Trace::write(const TraceRow& row) {
  fmt::memory_buffer line;
  fmt::format_to(std::back_inserter(line), "{:.6f},{},{},{:d}", row.time_s, name_of(row.state),
                 name_of(row.quality), row.braked);
  append(line, row.tip_m);
  append(line, row.velocity_m_s);
  append(line, row.applied.force);
  append(line, row.applied.torque);
  append(line, row.hand.force);
  append(line, row.target_m);
  line.push_back('\n');
  std::fwrite(line.data(), 1, line.size(), file_);
}

void Trace::finish() {
  const bool bad = std::ferror(file_) != 0;
  const bool closed = std::fclose(std::exchange(file_, nullptr)) == 0;
  if (bad || !closed)
    throw std::runtime_error(
        fmt::format("trace: '{}' is incomplete; check the free disk space", path_.string()));
}

}  // namespace voxtouch::lwr_sim
