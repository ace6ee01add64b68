#pragma once
/// The files that the page is made of: its own, and three.js and dygraphs as Debian installs them.
#include <map>
#include <string>

namespace voxtouch::view {

struct PageFile {
  std::string path, mime;
};

/// By what a browser asks for ("/", "/page.css"). Nothing else is ever served. Throws
/// std::runtime_error, a sentence, where one is missing.
std::map<std::string, PageFile> find_page_files();

}  // namespace voxtouch::view
