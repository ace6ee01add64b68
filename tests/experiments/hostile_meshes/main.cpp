/// hostile_meshes: every file of a folder of meshes, including broken ones, is touched or refused
/// with a sentence. Exit status 1 if a file crashes, hangs, is refused without a reason or causes
/// NaN or infinity.
#include <fmt/core.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <fstream>

#include "tests/experiments/hostile_meshes/attempt.hpp"

namespace {

using namespace voxtouch::hostile;

struct Arguments {
  std::vector<std::string> places{"/usr/share/assimp/models"};
  std::string markdown, csv;
  Limits limits;
};

void parse(CLI::App& app, int argc, char** argv, Arguments& a) {
  app.add_option(
         "places", a.places,
         "folders or files; without any, the models of the Debian package assimp-testmodels")
      ->capture_default_str();
  app.add_option("--poses", a.limits.poses,
                 "of a ball on each mesh, and as many of the mesh on a block")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--seed", a.limits.seed, "of the poses")->capture_default_str();
  app.add_option("--cpu", a.limits.cpu_s, "seconds of CPU time a file may take")
      ->check(CLI::Range(1U, 36000U))
      ->capture_default_str();
  app.add_option("--memory", a.limits.memory_mib, "MiB of address space a file may take")
      ->check(CLI::Range(64U, 1U << 20))
      ->capture_default_str();
  app.add_option("--markdown", a.markdown, "writes the table to this file, too");
  app.add_option("--csv", a.csv, "writes one row a file to this file");
  app.parse(argc, argv);
}

std::vector<std::filesystem::path> all_files(const Arguments& a) {
  std::vector<std::filesystem::path> files;
  for (const std::string& place : a.places) {
    const std::vector<std::filesystem::path> found =
        std::filesystem::is_directory(place) ? files_below(place)
                                             : std::vector<std::filesystem::path>{place};
    if (found.empty() || !std::filesystem::exists(place))
      throw std::runtime_error(
          place +
          " holds no files: install the package assimp-testmodels (apt-get install "
          "assimp-testmodels), or name a folder of meshes");
    files.insert(files.end(), found.begin(), found.end());
  }
  return files;
}

void write(const std::string& file, const std::string& text) {
  if (file.empty())
    return;
  std::ofstream out(file, std::ios::binary);
  if (!(out << text))
    throw std::runtime_error(file + " cannot be written: check the folder and its rights");
}

int run(const Arguments& a) {
  const std::vector<std::filesystem::path> files = all_files(a);
  const bool screen = ::isatty(2) != 0;
  std::vector<Verdict> verdicts;
  bool good = true;
  for (const std::filesystem::path& file : files) {
    verdicts.push_back(attempt(file, a.limits));
    const Verdict& v = verdicts.back();
    good = good && v.good();
    if (!v.good())
      fmt::print(stderr, "{}{}: {}: {}\n", screen ? "\r\x1b[K" : "", file.string(),
                 name_of(v.outcome), v.sentence);
    if (screen)
      fmt::print(stderr, "\r\x1b[K{} of {}: {}", verdicts.size(), files.size(),
                 file.filename().string());
    else if (verdicts.size() % 50 == 0)
      fmt::print(stderr, "{} of {}\n", verdicts.size(), files.size());
    std::fflush(stderr);
  }
  if (screen)
    fmt::print(stderr, "\r\x1b[K");
  fmt::print(
      "{} files, {} poses each way, seed {}, at most {} s of CPU time and {} MiB a file\n\n{}",
      files.size(), a.limits.poses, a.limits.seed, a.limits.cpu_s, a.limits.memory_mib,
      as_markdown(verdicts));
  write(a.markdown, as_markdown(verdicts));
  write(a.csv, as_csv(verdicts));
  return good ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Touches every mesh of a collection, broken ones included, or receives why not."};
  try {
    Arguments arguments;
    parse(app, argc, argv, arguments);
    return run(arguments);
  } catch (const CLI::ParseError& e) {
    return app.exit(e);
  } catch (const std::exception& e) {
    fmt::print(stderr, "hostile_meshes: {}\n", e.what());
    return 2;
  }
}
