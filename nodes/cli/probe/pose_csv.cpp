#include "nodes/cli/probe/pose_csv.hpp"

#include <algorithm>
#include <array>
#include <fstream>
#include <iostream>
#include <stdexcept>
#include <string_view>

#include <fmt/format.h>

#include "core/types/number.hpp"

namespace voxtouch::cli {
namespace {

constexpr std::array<std::string_view, 7> kColumns = {"qw", "qx", "qy", "qz", "tx", "ty", "tz"};

std::vector<std::string_view> split(std::string_view line) {
  std::vector<std::string_view> fields;
  for (std::size_t begin = 0; begin <= line.size();) {
    const std::size_t end = std::min(line.find(',', begin), line.size());
    std::string_view field = line.substr(begin, end - begin);
    const auto trim = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
    while (!field.empty() && trim(field.front()))
      field.remove_prefix(1);
    while (!field.empty() && trim(field.back()))
      field.remove_suffix(1);
    fields.push_back(field);
    begin = end + 1;
  }
  return fields;
}

std::array<std::size_t, 7> find_columns(std::string_view header, const std::string& name) {
  const auto fields = split(header);
  std::array<std::size_t, 7> columns{};
  for (std::size_t c = 0; c < kColumns.size(); ++c) {
    const auto found = std::find(fields.begin(), fields.end(), kColumns[c]);
    if (found == fields.end())
      throw std::runtime_error(
          fmt::format("{}:1: column '{}' is missing; required columns: qw,qx,qy,qz,tx,ty,tz", name,
                      kColumns[c]));
    columns[c] = static_cast<std::size_t>(found - fields.begin());
  }
  return columns;
}

Pose parse_row(const std::vector<std::string_view>& fields,
               const std::array<std::size_t, 7>& columns, const std::string& where) {
  std::array<double, 7> v{};
  for (std::size_t c = 0; c < kColumns.size(); ++c) {
    if (columns[c] >= fields.size())
      throw std::runtime_error(
          fmt::format("{}: the row ends before column '{}'", where, kColumns[c]));
    const std::string_view f = fields[columns[c]];
    const auto value = parse_finite(f);
    if (!value)
      throw std::runtime_error(
          fmt::format("{}: column '{}' is '{}', not a finite number", where, kColumns[c], f));
    v[c] = *value;
  }
  Pose pose{Vec3(v[4], v[5], v[6]), Quat(v[0], v[1], v[2], v[3])};
  if (!normalise_within(pose.orientation, 1e-3, 1e3))
    throw std::runtime_error(fmt::format("{}: the quaternion's norm is {}, limits 1e-3 to 1e3",
                                         where, pose.orientation.norm()));
  return pose;
}

}  // namespace

std::vector<Pose> read_poses(std::istream& in, const std::string& name) {
  std::string line;
  if (!std::getline(in, line))
    throw std::runtime_error(name + ": the file is empty; required columns: qw,qx,qy,qz,tx,ty,tz");
  if (line.starts_with("\xEF\xBB\xBF"))
    line.erase(0, 3);  // the mark that spreadsheets put in front
  const auto columns = find_columns(line, name);
  std::vector<Pose> poses;
  for (std::size_t number = 2; std::getline(in, line); ++number)
    if (line.find_first_not_of(" \t\r") != std::string::npos)
      poses.push_back(parse_row(split(line), columns, fmt::format("{}:{}", name, number)));
  return poses;
}

std::vector<Pose> read_poses(const std::filesystem::path& file) {
  if (file == "-")
    return read_poses(std::cin, "standard input");
  if (std::filesystem::is_directory(file))
    throw std::runtime_error(file.string() + ": is a folder, not a CSV file of poses");
  std::ifstream in(file);
  if (!in)
    throw std::runtime_error(file.string() + ": cannot be read; check the file name");
  return read_poses(in, file.string());
}

}  // namespace voxtouch::cli
