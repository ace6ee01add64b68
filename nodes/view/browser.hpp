#pragma once
/// Opens the page in the desktop's browser.
#include <string>

namespace voxtouch::view {

/// Opens `address` in the browser of this session; does nothing without a display or xdg-open.
/// Every user of a machine can read command lines, so the browser receives the path of a private
/// file that redirects to the address.
void open_browser(const std::string& address);

}  // namespace voxtouch::view
