#include "nodes/view/page_files.hpp"

#include <filesystem>
#include <stdexcept>

#include <fmt/format.h>

#include "core/types/program_folder.hpp"

namespace voxtouch::view {
namespace {

namespace fs = std::filesystem;

fs::path own_folder() { return shared_folder() / "page"; }

constexpr const char* kOwn[] = {"index.html", "page.css",  "main.js", "scene3d.js",
                                "charts.js",  "panels.js", "hand.js", "learn.js"};
constexpr const char* kScript = "text/javascript; charset=utf-8";

struct Library {
  const char *url, *path, *mime, *package;
};
constexpr Library kLibraries[] = {
    {"/three.js", "/usr/share/javascript/three/three.min.js", kScript, "libjs-three"},
    {"/orbit.js", "/usr/share/javascript/three/examples/js/controls/OrbitControls.js", kScript,
     "libjs-three"},
    {"/dygraph.js", "/usr/share/javascript/dygraphs/dygraph.min.js", kScript, "libjs-dygraphs"},
    {"/dygraph.css", "/usr/share/javascript/dygraphs/dygraph.min.css", "text/css; charset=utf-8",
     "libjs-dygraphs"},
};

const char* mime_of(const fs::path& file) {
  if (file.extension() == ".html")
    return "text/html; charset=utf-8";
  return file.extension() == ".css" ? "text/css; charset=utf-8" : kScript;
}

}  // namespace

std::map<std::string, PageFile> find_page_files() {
  std::map<std::string, PageFile> files;
  for (const char* name : kOwn) {
    const fs::path file = own_folder() / name;
    if (!fs::exists(file))
      throw std::runtime_error(
          fmt::format("{} is missing: build or install voxtouch again", file.string()));
    files["/" + std::string(name)] = {file.string(), mime_of(file)};
  }
  files["/"] = files.extract("/index.html").mapped();
  for (const Library& library : kLibraries) {
    if (!fs::exists(library.path))
      throw std::runtime_error(fmt::format("{} is missing: install {} (deploy/setup does)",
                                           library.path, library.package));
    files[library.url] = {library.path, library.mime};
  }
  return files;
}

}  // namespace voxtouch::view
