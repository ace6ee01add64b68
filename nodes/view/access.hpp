#pragma once
/// Who may talk to the page's server. Any website that is open in a browser may send requests to
/// this computer: Host, Origin and a token that it cannot know keep it out. Pure.
#include <string>
#include <string_view>

namespace voxtouch::view {

/// 128 random bits of the kernel as 32 hex digits. Throws std::runtime_error where there are none.
std::string make_token();

/// What a server at `address`:`port` lets in. An empty token refuses every client.
struct Access {
  std::string address;  ///< an IPv4 address of this machine, as digits
  int port = 0;
  std::string token;

  /// As the header Host says it: the address itself, or `localhost` where the address is a loopback
  /// one. Against names of other sites that lead here.
  bool admits_host(std::string_view host) const;
  /// Behind the refusal of such a header: what to do about a tunnel that begins at another port.
  /// Empty for other names.
  std::string remedy_for(std::string_view host) const;
  /// As the header Origin says it: a page of this very server, or none: then it is no browser.
  bool admits_origin(std::string_view origin) const;
  /// Takes as long whatever is wrong with it.
  bool admits_token(std::string_view given) const noexcept;
};

}  // namespace voxtouch::view
