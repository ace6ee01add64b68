#pragma once
/// The contacts that a design is certified for, as text and as JSON.
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "core/coupling/design/absolute_stability.hpp"

namespace voxtouch::cli {

/// "any contact whose force does not decrease with depth, up to 518 N/m, margin 1.98", or which one
/// instead and why. Empty for a design without a certificate.
std::string certificate_line(const coupling::design::ContactCertificate& certificate);
/// Cases that the certificate does not cover, one sentence each.
std::vector<std::string> certificate_gaps(const coupling::design::ContactCertificate& certificate);
/// Non-finite values are null. The multiplier as h_i of past and future.
nlohmann::ordered_json certificate_json(const coupling::design::ContactCertificate& certificate);

}  // namespace voxtouch::cli
