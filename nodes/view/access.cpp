#include "nodes/view/access.hpp"

#include <sys/random.h>

#include <array>
#include <stdexcept>

#include <fmt/format.h>

namespace voxtouch::view {

std::string make_token() {
  std::array<unsigned char, 16> bytes{};
  if (getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size()))
    throw std::runtime_error("the kernel provides no random numbers for the page's token");
  return fmt::format("{:02x}", fmt::join(bytes, ""));
}

bool Access::admits_host(std::string_view host) const {
  return host == fmt::format("{}:{}", address, port) ||
         (address.starts_with("127.") && host == fmt::format("localhost:{}", port));
}

std::string Access::remedy_for(std::string_view host) const {
  if (!host.starts_with("localhost:") && !host.starts_with("127."))
    return {};
  return fmt::format(
      " Through a tunnel, use the same port on both sides (ssh -L {0}:{1}:{0} HOST) and open the "
      "printed address; --port sets another port.",
      port, address);
}

bool Access::admits_origin(std::string_view origin) const {
  constexpr std::string_view kScheme = "http://";
  return origin.empty() ||
         (origin.starts_with(kScheme) && admits_host(origin.substr(kScheme.size())));
}

bool Access::admits_token(std::string_view candidate) const noexcept {
  if (token.empty() || candidate.size() != token.size())
    return false;
  unsigned difference = 0;
  for (std::size_t n = 0; n < token.size(); ++n)
    difference |= static_cast<unsigned char>(token[n]) ^
                  static_cast<unsigned>(static_cast<unsigned char>(candidate[n]));
  return difference == 0;
}

}  // namespace voxtouch::view
