#pragma once
/// The files of the page: its own, and three.js and dygraphs as Debian installs them.
#include <map>
#include <string>

namespace voxtouch::view {

struct PageFile {
  std::string path, mime;
};

/// Files by URL path ("/", "/page.css"); the server serves no others. Throws std::runtime_error,
/// with a sentence, if a file is missing.
std::map<std::string, PageFile> find_page_files();

}  // namespace voxtouch::view
