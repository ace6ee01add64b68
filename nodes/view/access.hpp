#pragma once
/// Access checks of the page's server. Any website that is open in a browser can send requests to
/// this computer; Host, Origin and a secret token exclude them. Pure.
#include <string>
#include <string_view>

namespace voxtouch::view {

/// 128 random bits of the kernel as 32 hex digits. Throws std::runtime_error if it has none.
std::string make_token();

/// Requests that a server at `address`:`port` accepts. An empty token refuses every client.
struct Access {
  std::string address;  ///< an IPv4 address of this machine, as digits
  int port = 0;
  std::string token;

  /// Checks the header Host: the address itself, or `localhost` for a loopback address. Excludes
  /// names of other sites that resolve to this machine.
  bool admits_host(std::string_view host) const;
  /// Remedy for a refused Host of a tunnel that begins at another port. Empty for other names.
  std::string remedy_for(std::string_view host) const;
  /// Checks the header Origin: a page of this server, or empty (not a browser).
  bool admits_origin(std::string_view origin) const;
  /// Constant time for candidates of the right length.
  bool admits_token(std::string_view candidate) const noexcept;
};

}  // namespace voxtouch::view
