#pragma once
/// The person's browser.
#include <string>

namespace voxtouch::view {

/// Opens `address` in the browser of this session, if there is a display and xdg-open; else nothing
/// happens. Command lines can be read by every user of a machine, so the browser gets the path of a
/// file that only this user can read, and that leads to the address.
void open_browser(const std::string& address);

}  // namespace voxtouch::view
