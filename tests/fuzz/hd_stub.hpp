#pragma once
/// A library with the 36 functions of HDAPI that says whatever it was given: see hd_stub.cpp.
#include <cstddef>
#include <cstdint>

#include "devices/phantom/hdapi.hpp"

extern "C" {
/// What it answers from: bytes that every question takes some of; none left: zeros. Errors are
/// answered one question in eight.
void fuzz_hd_say(const std::uint8_t* data, std::size_t size);
/// One servo tick, if a callback is scheduled.
void fuzz_hd_tick(void);
/// The last force [N] and torque [mNm] that were set; false where any was not finite since the last
/// call.
bool fuzz_hd_last(double* force3, double* torque3);
}
