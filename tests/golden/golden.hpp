#pragma once
/// The vectors as text, and the command line as a child process.
#include <filesystem>
#include <istream>
#include <map>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "tests/support/process/process.hpp"

namespace voxtouch::test {

inline const std::filesystem::path kData = VOXTOUCH_TEST_DATA;
inline const std::filesystem::path kVectors = kData / "vectors";

/// A CSV file with a header; cells as text.
class Table {
 public:
  static Table read(const std::filesystem::path& file);  ///< throws if the file cannot be read
  static Table parse(const std::string& text);

  const std::vector<std::string>& header() const noexcept { return header_; }
  std::size_t size() const noexcept { return rows_.size(); }
  const std::string& text(std::size_t row, const std::string& column) const;
  double number(std::size_t row, const std::string& column) const;

 private:
  std::vector<std::string> header_;
  std::map<std::string, std::size_t> column_;
  std::vector<std::vector<std::string>> rows_;
};

std::string file_text(const std::filesystem::path& file);
const nlohmann::json& vector_index();

/// Runs `voxtouch <arguments>` and waits for it.
Finished voxtouch(const std::vector<std::string>& arguments);
/// Runs a line of /bin/sh; `$VOXTOUCH` is the program.
Finished shell(const std::string& line);

}  // namespace voxtouch::test
