#pragma once
/// A library with the 36 functions of HDAPI with given answers: see hd_stub.cpp.
#include <cstddef>
#include <cstdint>

#include "devices/phantom/hdapi.hpp"

extern "C" {
/// Source of the answers: each call consumes some bytes; after the end: zeros. One call in eight
/// returns an error.
void fuzz_hd_say(const std::uint8_t* data, std::size_t size);
/// One servo tick, if a callback is scheduled.
void fuzz_hd_tick(void);
/// The last force [N] and torque [mNm]; false if any was not finite since the last call.
bool fuzz_hd_last(double* force3, double* torque3);
}
