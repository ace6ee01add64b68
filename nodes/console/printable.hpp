#pragma once
/// Text from files and messages on its way to a terminal.
#include <string>
#include <string_view>

namespace voxtouch::console {

/// `text` with '?' for every control character but newline and tabulator (an escape sequence could
/// rewrite the screen) and for every byte that is not UTF-8 (a terminal may take it for a control
/// character); all else as it is.
std::string printable(std::string_view text);

}  // namespace voxtouch::console
