#pragma once
/// Makes text of files and messages safe for a terminal.
#include <string>
#include <string_view>

namespace voxtouch::console {

/// `text` with '?' for every control character except newline and tabulator (an escape sequence
/// could rewrite the screen) and for every byte that is not UTF-8 (a terminal may use it as a
/// control character).
std::string printable(std::string_view text);

}  // namespace voxtouch::console
