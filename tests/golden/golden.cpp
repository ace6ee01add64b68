#include "tests/golden/golden.hpp"

#include <fstream>
#include <sstream>
#include <stdexcept>

#include "core/types/number.hpp"

namespace voxtouch::test {
namespace {

const std::string kProgram = VOXTOUCH_BIN "/voxtouch";

/// Cells of a line; an empty last cell counts.
std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells;
  for (std::size_t begin = 0; begin <= line.size();) {
    const std::size_t end = std::min(line.find(',', begin), line.size());
    cells.push_back(line.substr(begin, end - begin));
    begin = end + 1;
  }
  return cells;
}

}  // namespace

std::string file_text(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in)
    throw std::runtime_error("cannot read " + file.string());
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

Table Table::read(const std::filesystem::path& file) { return parse(file_text(file)); }

Table Table::parse(const std::string& text) {
  Table table;
  std::istringstream in(text);
  std::string line;
  std::getline(in, line);
  table.header_ = cells_of(line);
  for (std::size_t c = 0; c < table.header_.size(); ++c)
    table.column_[table.header_[c]] = c;
  while (std::getline(in, line)) {
    table.rows_.push_back(cells_of(line));
    if (table.rows_.back().size() != table.header_.size())
      throw std::runtime_error("a row of another length: " + line);
  }
  return table;
}

const std::string& Table::text(std::size_t row, const std::string& column) const {
  return rows_.at(row).at(column_.at(column));
}

double Table::number(std::size_t row, const std::string& column) const {
  const std::string& cell = text(row, column);
  const auto value = parse_number<double>(cell);
  if (!value)
    throw std::runtime_error("no number: '" + cell + "'");
  return *value;
}

const nlohmann::json& vector_index() {
  static const nlohmann::json index = nlohmann::json::parse(file_text(kVectors / "index.json"));
  return index;
}

Finished voxtouch(const std::vector<std::string>& arguments) {
  std::vector<std::string> all{kProgram};
  all.insert(all.end(), arguments.begin(), arguments.end());
  return Process(all).wait();
}

Finished shell(const std::string& line) {
  return Process({"/bin/sh", "-c", line}, {{"VOXTOUCH", kProgram}}).wait();
}

}  // namespace voxtouch::test
